"""Standby heating: short pulses in the off-time that keep the wax warm without opening the valve.

    python -m waxstudy_enthalpy.standby [--figure FILE.svg]

The paper proposes this without testing it (section 4.1, conclusions), to open a valve within the 300 s of the reserve
market after any pause. Here the fitted motors are simulated; no real motor was measured.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from typing import Any

import numpy as np

from waxstudy_enthalpy.bench import parameters
from waxstudy_enthalpy.pulses import (
    AMBIENT_C,
    FIRST_S,
    LIMIT_S,
    NONE,
    PAUSES_MIN,
    PERIOD_MIN,
    PERIODS_MIN,
    Pattern,
    after_pause_s,
    largest,
    motors,
    moving_C,
    opens_from_C,
    smallest,
    standby,
)

PRODUCTS_ONLY = ("product A", "product B")
WIDTH = 20
HOURS = 24.0


def both(p: Any, period_min: float) -> dict[str, Pattern]:
    """Return the shortest pulses that are quick enough, and the longest that never move the piston."""
    return {"smallest": smallest(p, 60.0 * period_min), "largest": largest(p, 60.0 * period_min)}


def robust(values: Mapping[str, Any]) -> Pattern:
    """Return the shortest pulses that are quick enough in the coldest ambient temperature too."""
    return smallest(parameters({**values, "ambient_C": AMBIENT_C[0]}), 60.0 * PERIOD_MIN)


def patterns(found: Mapping[str, dict[str, Any]]) -> None:
    """Print, per motor and period, the smallest pulse that keeps the limit and the largest that moves nothing."""
    print(f"Pulses every period, the first {FIRST_S / 60.0:.0f} min after switching off; settled, at 21 C ambient.")
    print(
        f"smallest: keeps full activation within {LIMIT_S:.0f} s; largest: never moves the piston; - if there is none."
    )
    print(f"robust: keeps the limit at {AMBIENT_C[0]:.0f} C ambient too.")
    print("Activation is from just before a pulse. Margin: core below the temperature at which the piston starts.")
    print(f"{'motor':{WIDTH}}{'period':>7} {'pattern':9}{'pulse':>6}{'duty':>7}{'opens in':>9}{'power':>8}", end="")
    print(f"{'energy':>11}{'margin':>8}{'moves from':>12}")
    print(f"{'':{WIDTH}}{'min':>7} {'':9}{'s':>6}{'%':>7}{'s':>9}{'W':>8}{'Wh/day':>11}{'K':>8}{'C ambient':>12}")
    for label, values in found.items():
        p = parameters(values)
        print(f"{label:{WIDTH}}{'-':>7} {'none':15}{0.0:7.1f}{standby(p, NONE).activation_s:9.0f}{0.0:8.2f}{0.0:11.1f}")
        for period_min in PERIODS_MIN if label in PRODUCTS_ONLY else (PERIOD_MIN,):
            found_here = both(p, period_min) | ({"robust": robust(values)} if period_min == PERIOD_MIN else {})
            for name, pattern in found_here.items():
                _print_pattern(label, values, name, pattern)


def _print_pattern(label: str, values: Mapping[str, Any], name: str, pattern: Pattern) -> None:
    start = f"{label:{WIDTH}}{pattern.period_s / 60.0:7.0f} {name:9}"
    it = standby(parameters(values), pattern) if np.isfinite(pattern.pulse_s) else None
    if it is None or it.opening > 0.0:
        print(f"{start}{'-':>6}  no pulse is quick enough without moving the piston")
        return
    duty = 100.0 * pattern.pulse_s / pattern.period_s
    moves_C = opens_from_C(values, pattern)
    print(f"{start}{pattern.pulse_s:6.0f}{duty:7.1f}{it.activation_s:9.0f}{it.power_W:8.2f}", end="")
    print(f"{HOURS * it.power_W:11.1f}{it.margin_K:8.1f}{moves_C:12.1f}")


def pauses(found: Mapping[str, dict[str, Any]]) -> None:
    """Print the activation time after pauses, without and with standby."""
    print(f"\nFull activation [s] after an hour of heating and a pause; pulses every {PERIOD_MIN} min")
    print(f"{'motor':{WIDTH}}{'pattern':10}" + "".join(f"{minutes:6} min" for minutes in PAUSES_MIN))
    for label in PRODUCTS_ONLY:
        p = parameters(found[label])
        for name, pattern in {"none": NONE, **both(p, PERIOD_MIN), "robust": robust(found[label])}.items():
            cells = "".join(f"{after_pause_s(p, pattern, 60.0 * minutes):10.0f}" for minutes in PAUSES_MIN)
            print(f"{label:{WIDTH}}{name:10}{cells}")


def ambients(found: Mapping[str, dict[str, Any]]) -> None:
    """Print what patterns that were chosen at 21 C do in other ambient temperatures."""
    print(f"\nThe same patterns in other ambient temperatures, pulses every {PERIOD_MIN} min:")
    print("activation [s] / margin [K], or the opening that is reached where the piston moves")
    print("first: activation just before the first pulse, which no pattern helps")
    print("robust, A (or B): the robust pattern of that product, on a motor that its times allow too")
    print(f"{'motor':{WIDTH}}{'pattern':10}" + "".join(f"{ambient_C:10.0f} C" for ambient_C in AMBIENT_C))
    for label, values in found.items():
        before = (after_pause_s(parameters({**values, "ambient_C": a}), NONE, FIRST_S) for a in AMBIENT_C)
        print(f"{label:{WIDTH}}{'first':10}" + "".join(f"{seconds:12.0f}" for seconds in before))
        rows = {"none": NONE, **both(parameters(values), PERIOD_MIN), "robust": robust(values)}
        if label not in PRODUCTS_ONLY:
            rows[f"robust, {label[0]}"] = robust({"product": label[0]})
        for name, pattern in rows.items():
            cells = []
            for ambient_C in AMBIENT_C:
                it = standby(parameters({**values, "ambient_C": ambient_C}), pattern)
                cells.append(
                    f"{it.activation_s:.0f}/{it.margin_K:.1f}" if it.opening <= 0.0 else f"opens {it.opening:.2f}"
                )
            print(f"{label:{WIDTH}}{name:10}" + "".join(f"{cell:>12}" for cell in cells))


def print_all() -> None:
    found = motors()
    moving = ", ".join(f"{label[-1]} {moving_C(parameters(found[label])):.1f} C" for label in PRODUCTS_ONLY)
    print(f"The closed piston starts at a core temperature of: {moving}")
    patterns(found)
    pauses(found)
    ambients(found)


def draw(path: str) -> None:
    """Draw activation over the pause, and the margin over ambient temperature."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    settings: Any = {"svg.hashsalt": "waxstudy", "svg.fonttype": "none", "font.size": 9, "font.family": "DejaVu Sans"}
    with plt.rc_context(settings):
        figure, (left, right) = plt.subplots(1, 2, figsize=(8.4, 3.6), layout="constrained")
        _draw_product(left, right, "A", {"color": "#0072B2", "linewidth": 1.2})
        _draw_product(left, right, "B", {"color": "#D55E00", "linewidth": 2.2})
        left.axhline(LIMIT_S, color="0.4", linewidth=0.8)
        left.annotate("limit of the reserve", (119, LIMIT_S - 5), ha="right", va="top", color="0.3")
        left.set(xlabel="pause since switching off [min]", ylabel="full activation [s]", xlim=(0, 120), ylim=(0, 420))
        right.axhline(0.0, color="0.4", linewidth=0.8)
        right.annotate("piston moves", (15.4, -3.0), ha="left", va="top", color="0.3")
        right.set(xlabel="ambient temperature [°C]", ylabel="margin before the piston moves [K]", xlim=(15, 35))
        handles, names = left.get_legend_handles_labels()
        by_row = [0, 3, 1, 4, 2, 5]  # a row per product: a legend fills its columns first
        figure.legend(
            [handles[i] for i in by_row], [names[i] for i in by_row], loc="outside lower center", ncols=3, frameon=False
        )
        figure.savefig(path, metadata={"Date": None})


def _draw_product(left: Any, right: Any, product: str, look: dict[str, Any]) -> None:
    values = {"product": product}
    p = parameters(values)
    minutes = np.array([5.0, 7.5, 10.0, 12.5, 15.0, *np.arange(20.0, 121.0, PERIOD_MIN)])
    styles = {"none": "-", "robust": "--", "largest": ":"}
    shown = {"none": NONE, "robust": robust(values), "largest": largest(p, 60.0 * PERIOD_MIN)}
    for name, pattern in shown.items():
        text = "without standby" if name == "none" else f"{pattern.pulse_s:.0f} s every {PERIOD_MIN} min"
        times = [after_pause_s(p, pattern, 60.0 * pause) for pause in minutes]
        left.plot(minutes, times, styles[name], **look, label=f"{product}, {text}")
        if name != "none":
            ambient = np.arange(15.0, 35.1, 1.0)
            motors_there = [parameters({**values, "ambient_C": float(a)}) for a in ambient]
            margin = [standby(there, pattern).margin_K for there in motors_there]
            right.plot(ambient, margin, styles[name], **look)


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m waxstudy_enthalpy.standby", description=__doc__.splitlines()[0])
    parser.add_argument("--figure", metavar="FILE.svg", help="also draw the figure")
    arguments = parser.parse_args()
    print_all()
    if arguments.figure:
        draw(arguments.figure)


if __name__ == "__main__":
    main()
