"""The piston over the wax's temperature, as the paper's Figure 2: `python -m waxstudy_enthalpy.piston FILE.svg`."""

from __future__ import annotations

import sys
from typing import Any

import numpy as np

from waxstudy_enthalpy.bench import parameters
from waxstudy_enthalpy.motor import Enthalpy, core_temperature_C

STEP_S = 1.0
ON_S, OFF_S = 1800.0, 5400.0  # long enough to open fully, and to close
LOOKS: dict[str, dict[str, Any]] = {
    "A": {"color": "#0072B2", "linewidth": 1.2, "marker": "o", "markersize": 4},
    "B": {"color": "#D55E00", "linewidth": 2.2, "marker": "s", "markersize": 4},
}


def loop(product: str) -> tuple[np.ndarray, np.ndarray, int]:
    """Return the core's temperature [C] and the opening over one heating and cooling, and how many steps heat."""
    p = parameters({"product": product})
    state = Enthalpy.start(p, STEP_S)
    rows, heating = [], round(ON_S / STEP_S)
    for n in range(heating + round(OFF_S / STEP_S)):
        opening = Enthalpy.step(p, state, float(n < heating), n * STEP_S, STEP_S)
        rows.append((core_temperature_C(p, state.core_J), opening))
    core_C, openings = np.array(rows).T
    return core_C, openings, heating


def draw(path: str) -> None:
    """Draw the loops of both products."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    settings: Any = {"svg.hashsalt": "waxstudy", "svg.fonttype": "none", "font.size": 9, "font.family": "DejaVu Sans"}
    with plt.rc_context(settings):
        figure, axes = plt.subplots(figsize=(6.4, 3.6), layout="constrained")
        for product, look in LOOKS.items():
            core_C, opening, heating = loop(product)
            for part, style, name in ((slice(heating), "-", "heating"), (slice(heating, None), "--", "cooling")):
                moving = np.abs(core_C[part] - 74.5) < 7.5
                x, y = core_C[part][moving], opening[part][moving]
                axes.plot(x, y, style, **look, markevery=max(1, len(x) // 8), label=f"{product}, {name}")
        axes.set(xlabel="temperature of the wax [°C]", ylabel="opening [-]", xlim=(67.0, 82.0), ylim=(-0.03, 1.03))
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
        figure.savefig(path, metadata={"Date": None})


if __name__ == "__main__":
    draw(sys.argv[1])
