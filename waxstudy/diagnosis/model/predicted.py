"""What is predicted of channels."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from waxstudy.plugin import FloatArray


class Predicted(dict[str, FloatArray]):
    """What is predicted of channels, each (n,), of a room's (quarters,).

    `shifted` (shifts, n) has those that a switch drives, for each part of an interval in which it may have been thrown.
    """

    def __init__(
        self, values: Mapping[str, FloatArray] = MappingProxyType({}), shifted: Mapping[str, FloatArray] | None = None
    ) -> None:
        super().__init__(values)
        self.shifted = shifted or {}
