"""What a house is like where nothing is wrong with it: its kind of chain, and the scatter of its numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from waxstudy.plugin.trial import Unmakeable
from waxstudy_trials.energyplus.blocks import STEP_S
from waxstudy_trials.energyplus.causes import NEEDS
from waxstudy_trials.energyplus.description import House


def drawn(random: np.random.Generator, names: Sequence[str]) -> dict[str, Any]:
    """Return the numbers of a house that are not the usual ones; raise `Unmakeable`."""
    chain, scatter = _chain(random, _kinds(random, names)), _scatter(random)
    usual = House()._asdict()
    return {name: value for name, value in (chain | scatter).items() if value != usual[name]}


def _kinds(random: np.random.Generator, names: Sequence[str]) -> dict[str, bool]:
    """Return what the chain is like, so that all causes apply to it; raise `Unmakeable`."""
    kinds = {
        "is_pi": bool(random.random() < 0.5),
        "is_motor": bool(random.random() < 2.0 / 3.0),
        "is_curved": bool(random.random() < 0.7),
        "is_late": bool(random.random() < 0.5),
    }
    wanted: dict[str, bool] = {}
    for name in names:
        for kind, value in NEEDS.get(name, {}).items():
            if wanted.setdefault(kind, value) != value:
                raise Unmakeable(f"no chain that {' and '.join(names)} apply to together")
    return kinds | wanted


def _chain(random: np.random.Generator, kinds: Mapping[str, bool]) -> dict[str, Any]:
    """Return the numbers of a chain of a kind; each is drawn, whatever the kind is."""
    late_s = STEP_S * float(random.integers(6, 25))
    lag_s = round(150.0 * float(np.exp(random.normal(0.0, 0.3))), 1)
    product, curve = str(random.choice(["A", "B"])), float(random.uniform(1.1, 2.2))
    lift, authority = float(random.uniform(0.05, 0.2)), float(random.uniform(0.1, 0.4))
    curved = {"lift": lift, "curve": curve, "authority": authority} if kinds["is_curved"] else {}
    return {
        "delay_s": late_s if kinds["is_late"] else 0.0,
        "lag_s": 0.0 if kinds["is_late"] else lag_s,
        "is_pi": kinds["is_pi"],
        "band_K": float(random.choice([0.4, 0.5, 0.6, 1.0])),
        "gain_1_K": round(float(np.exp(random.uniform(np.log(6.0), np.log(20.0)))), 1),
        "integration_s": round(float(random.uniform(2000.0, 6000.0)), -2),
        "period_s": float(random.choice([1200.0, 1800.0, 2400.0, 3600.0])),
        "min_pulse_s": float(random.choice([60.0, 120.0, 180.0, 300.0])),
        "product": product if kinds["is_motor"] else "",
        **{name: round(value, 4) for name, value in curved.items()},
    }


def _scatter(random: np.random.Generator) -> dict[str, float]:
    """Return the numbers in which one house is not another, and none as it is believed."""
    scattered = {
        "box_C": float(random.uniform(19.0, 24.0)),
        "power": float(np.exp(random.normal(0.0, 0.04))),
        "latent": float(np.exp(random.normal(0.0, 0.05))),
        "coupling": float(random.uniform(0.0, 0.1)),
        "full_flow_L_h": 150.0 * float(random.uniform(0.85, 1.15)),
        "furniture": float(np.exp(random.normal(0.0, 0.2))),
        "exchange": float(np.exp(random.normal(0.0, 0.03))),
        "leaks": float(np.exp(random.normal(0.0, 0.1))),
        "gains": float(random.normal(1.0, 0.07)),
        "sun": float(random.normal(1.0, 0.06)),
    }
    return {name: float(f"{value:.4g}") for name, value in scattered.items()}
