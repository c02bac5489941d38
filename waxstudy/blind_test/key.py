"""The key: what draws a blind test, names its records, and seals their truth in boxes."""

from __future__ import annotations

import hashlib
import hmac
import json
import re
import secrets
from dataclasses import dataclass
from typing import Any

import numpy as np

SALT_BYTES = 16
WRITTEN = re.compile(r"(\d{1,18})-([0-9a-f]{32})")


class KeyProblem(ValueError):
    """A key that is none, or not the one of these records."""


@dataclass(frozen=True)
class Key:
    """Seed and salt. The seed alone draws nothing: a seed can be guessed, the salt cannot."""

    seed: int
    salt: str  # hexadecimal

    @classmethod
    def new(cls, seed: int) -> Key:
        return cls(seed, secrets.token_hex(SALT_BYTES))

    @classmethod
    def read(cls, text: str) -> Key:
        """Return the key that `str` wrote; raise `KeyProblem`.

        >>> Key.read("7-" + 32 * "a").seed
        7
        """
        found = WRITTEN.fullmatch(text.strip())
        if not found:
            raise KeyProblem("this is no key: a key is a seed, '-' and 32 hexadecimal digits")
        return cls(int(found[1]), found[2])

    def __str__(self) -> str:
        return f"{self.seed}-{self.salt}"

    def digest(self, *purpose: object) -> bytes:
        """Return 32 bytes that only this key gives for this purpose."""
        return hmac.new(str(self).encode(), "/".join(map(str, purpose)).encode(), hashlib.sha256).digest()

    def random(self, *purpose: object) -> np.random.Generator:
        """Return random numbers of their own for each purpose."""
        return np.random.default_rng(list(np.frombuffer(self.digest("random", *purpose), dtype=np.uint32)))

    @property
    def fingerprint(self) -> str:
        """What tells a wrong key from the right one, and nothing else."""
        return self.digest("fingerprint").hex()

    def record_name(self, index: int) -> str:
        return self.digest("name", index).hex()[:12]

    def seal_of(self, name: str, truth: Any) -> str:
        """Return the salted hash of a truth."""
        return hmac.new(self.digest("seal", name), canonical(truth), hashlib.sha256).hexdigest()


def canonical(value: Any) -> bytes:
    """Return a value as JSON of one spelling."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False).encode()
