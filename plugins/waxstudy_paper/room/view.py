"""How much of the sphere around a point a rectangle fills."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan, sqrt


@dataclass(frozen=True)
class Rectangle:
    """A rectangle in a plane; its sides are measured from the foot of the perpendicular from the point [m]."""

    distance_m: float
    left_m: float
    right_m: float
    bottom_m: float
    top_m: float

    @property
    def solid_angle_sr(self) -> float:
        """Exact solid angle: sum over the corners of +-atan(a b / (d sqrt(a2 + b2 + d2)))."""
        return (
            self._corner(self.right_m, self.top_m)
            - self._corner(self.left_m, self.top_m)
            - self._corner(self.right_m, self.bottom_m)
            + self._corner(self.left_m, self.bottom_m)
        )

    def _corner(self, a: float, b: float) -> float:
        d = self.distance_m
        return atan(a * b / (d * sqrt(a * a + b * b + d * d)))
