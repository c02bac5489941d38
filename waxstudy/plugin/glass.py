"""What panes of clear glass let through at an angle of incidence."""

from __future__ import annotations

import numpy as np

from waxstudy.plugin.contracts import FloatArray

GLASS_REFRACTION = 1.526
PANE_ABSORPTION = 0.09  # exponent of 3 mm of clear float glass at normal incidence


def through_glass(panes: int, angle_deg: FloatArray) -> FloatArray:
    """Return what panes of clear glass let through at an angle of incidence, relative to normal incidence.

    tau = exp(-0.09 N / cos(theta')) mean((1 - r) / (1 + (2 N - 1) r))   over both polarisations

    with the reflectances r of a surface by Fresnel and theta' the angle in the glass (n = 1.526). It is used for g
    as a whole. Source: Duffie and Beckman, Solar Engineering of Thermal Processes, chapter 5. 0 behind the glass.
    """
    if panes == 0:
        return np.ones_like(angle_deg)
    angle = np.radians(np.clip(angle_deg, 0.01, 89.99))
    relative: FloatArray = _transmittance(panes, angle) / _transmittance(panes, np.radians(0.01))
    return np.where(np.asarray(angle_deg) < 90.0, relative, 0.0)


def _transmittance(panes: int, angle: FloatArray | float) -> FloatArray:
    inside = np.arcsin(np.sin(angle) / GLASS_REFRACTION)
    across = (np.sin(inside - angle) / np.sin(inside + angle)) ** 2
    along = (np.tan(inside - angle) / np.tan(inside + angle)) ** 2
    passed = sum((1.0 - r) / (1.0 + (2 * panes - 1) * r) for r in (across, along)) / 2.0
    return np.asarray(passed * np.exp(-PANE_ABSORPTION * panes / np.cos(inside)))


def diffuse_through_glass(panes: int) -> float:
    """Return the mean of `through_glass` over light that comes evenly from the hemisphere."""
    angle_deg = np.arange(0.5, 90.0)
    weight = np.sin(2.0 * np.radians(angle_deg))
    return float(np.average(through_glass(panes, angle_deg), weights=weight))
