"""The key: what draws a blind test, names its records, and seals their truth."""

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
BOX_BYTES = 16_384  # of every box, so that its size tells nothing


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

    # --- boxes: the truth of a record, which nobody reads without the key ---

    def closed(self, name: str, truth: Any) -> bytes:
        """Return a truth enciphered, in boxes of equal size: XOR with a keystream of HMAC-SHA-256 blocks."""
        text = canonical(truth)
        text += b" " * (-len(text) % BOX_BYTES)
        body = self._mixed(name, text)
        return self._tag(name, body) + body

    def opened(self, name: str, box: bytes) -> Any:
        """Return the truth in a box; raise `KeyProblem` if this key does not fit or the box was changed."""
        tag, body = box[:32], box[32:]
        if not hmac.compare_digest(tag, self._tag(name, body)):
            raise KeyProblem(f"the sealed truth of {name} does not open: another key's, or changed since")
        return json.loads(self._mixed(name, body))

    def _tag(self, name: str, body: bytes) -> bytes:
        return hmac.new(self.digest("tag", name), body, hashlib.sha256).digest()

    def _mixed(self, name: str, text: bytes) -> bytes:
        blocks = (self.digest("stream", name, number) for number in range(len(text) // 32 + 1))
        stream = np.frombuffer(b"".join(blocks), dtype=np.uint8)[: len(text)]
        return (np.frombuffer(text, dtype=np.uint8) ^ stream).tobytes()


def canonical(value: Any) -> bytes:
    """Return a value as JSON of one spelling."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False).encode()
