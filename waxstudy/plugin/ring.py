"""A delay line that blocks keep in their state.

In the interpreter a `Ring` is this class; compiled, it is a small record that points to its samples by an offset
from itself, so that one compilation serves every length.
"""

from __future__ import annotations


class Ring:
    """The last `length` inputs of a block; empty until the first call of `delayed`."""

    __slots__ = ("head", "length", "values")

    def __init__(self, length: int) -> None:
        if length < 0:
            raise ValueError(f"a ring has a length of 0 or more, not {length}")
        self.length = length
        self.head = -1  # -1: nothing stored yet
        self.values = [0.0] * length


def delayed(ring: Ring, value: float) -> float:
    """Store `value` and return the one stored `length` calls ago (before that: the first one).

    >>> ring = Ring(2)
    >>> [delayed(ring, value) for value in (1.0, 2.0, 3.0, 4.0)]
    [1.0, 1.0, 1.0, 2.0]
    """
    if ring.length == 0:
        return value
    if ring.head < 0:
        for i in range(ring.length):
            ring.values[i] = value
        ring.head = 0
    oldest = ring.values[ring.head]
    ring.values[ring.head] = value
    ring.head = (ring.head + 1) % ring.length
    return oldest
