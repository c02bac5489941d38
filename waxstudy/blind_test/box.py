"""Boxes: the truth of a record, which nobody reads without the key, changes unseen, or gives to another record.

AES-256-GCM (NIST SP 800-38D) under a key for boxes alone, with a random nonce in every box; the format and the record's
name are its associated data. Boxes of format 1 are read still.
"""

from __future__ import annotations

import hashlib
import hmac
import json
import secrets
from typing import Any

import numpy as np

from waxstudy.blind_test.key import Key, KeyProblem, canonical

MAGIC = b"waxbox 2"
NONCE_BYTES = 12
BOX_BYTES = 16_384  # of every truth, filled up, so that its size tells nothing
OVERHEAD_BYTES = len(MAGIC) + NONCE_BYTES + 16  # with the tag of the cipher


def close_box(key: Key, name: str, truth: Any) -> bytes:
    """Return a truth in a box; two boxes of the same truth differ."""
    from cryptography.hazmat.primitives.ciphers.aead import AESGCM

    text = canonical(truth)
    text += b" " * (-len(text) % BOX_BYTES)
    nonce = secrets.token_bytes(NONCE_BYTES)
    return MAGIC + nonce + AESGCM(key.digest("box")).encrypt(nonce, text, _bound_to(name))


def open_box(key: Key, name: str, box: bytes) -> Any:
    """Return the truth in a box; raise `KeyProblem` if this key does not fit or the box was changed."""
    from cryptography.exceptions import InvalidTag
    from cryptography.hazmat.primitives.ciphers.aead import AESGCM

    if not box.startswith(MAGIC):
        return json.loads(_opened_1(key, name, box))
    nonce, body = box[len(MAGIC) :][:NONCE_BYTES], box[len(MAGIC) + NONCE_BYTES :]
    try:
        return json.loads(AESGCM(key.digest("box")).decrypt(nonce, body, _bound_to(name)))
    except (InvalidTag, ValueError):
        raise _unfit(name) from None


def _bound_to(name: str) -> bytes:
    return MAGIC + b" " + name.encode()


def _unfit(name: str) -> KeyProblem:
    return KeyProblem(f"the sealed truth of {name} does not open: another key's, or changed since")


def _opened_1(key: Key, name: str, box: bytes) -> bytes:
    """Return what a box of format 1 holds: a tag, then the text, XOR a keystream of HMAC-SHA-256 blocks."""
    tag, body = box[:32], box[32:]
    if not hmac.compare_digest(tag, hmac.new(key.digest("tag", name), body, hashlib.sha256).digest()):
        raise _unfit(name)
    stream = b"".join(key.digest("stream", name, number) for number in range(len(body) // 32 + 1))
    mixed = np.frombuffer(body, dtype=np.uint8) ^ np.frombuffer(stream, dtype=np.uint8)[: len(body)]
    return mixed.tobytes()
