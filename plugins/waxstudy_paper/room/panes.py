"""What panes let through of the sun, and what they give to the room besides."""

from __future__ import annotations

from collections.abc import Mapping


def transmitted_share(g: float, U_W_m2K: float) -> float:
    """Return the share of the sun on a window that its panes let through, of a simple window with this g and U.

    U <= 3.4: 0.41040 g below g = 0.15, else 0.939998 g^2 + 0.20332 g; U >= 4.5: 0.964 g below 0.7206, else
    1.039117 g^2 - 0.248933 g; straight between. The rest of g is absorbed and given to the room by the inner pane.
    Source: Arasteh, Kohler and Griffith (2009), LBNL-2804E, as in EnergyPlus' simple window.
    """
    good = 0.41040 * g if g < 0.15 else 0.939998 * g**2 + 0.20332 * g
    poor = 0.964 * g if g < 0.7206 else 1.039117 * g**2 - 0.248933 * g
    part = min(1.0, max(0.0, (U_W_m2K - 3.4) / (4.5 - 3.4)))
    return (1.0 - part) * good + part * poor


def solar_readings(g: float, U_W_m2K: float) -> Mapping[str, float]:
    """Return the ways to mean a recorded solar gain: a sentence, and the sun's heat over the recorded one."""
    readings = {"The solar gain is all heat that the sun gives to the room.": 1.0}
    if g > 0.0:
        factor = g / transmitted_share(g, U_W_m2K)
        readings["The solar gain is what the panes let through; what they absorb comes on top."] = factor
    return readings
