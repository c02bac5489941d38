"""The TOML fragment that a study takes the tuned blocks from, and what else a tuning leaves behind."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd
import tomli_w

from waxstudy.tuning.objectives import OBJECTIVES, means
from waxstudy.tuning.tune import Setting, Tuned
from waxstudy.version import __version__

FORMAT = 1  # of tuning.json


def fragment(found: Tuned) -> str:
    """Return the tuned blocks as a study names them, and `[tuning]`, which a study does not read."""
    kinds = list(dict.fromkeys(axis.kind for axis in found.axes))
    blocks = {kind: found.case.blocks[kind].changed(**_of(found, kind)).described() for kind in kinds}
    use = "".join(f'# In a study: {kind} = {{ from = "THIS FILE" }}\n' for kind in kinds)
    about = {
        "waxstudy": __version__,
        "study": found.study.name,
        "case": found.case.id,
        "objectives": dict(found.goal.weights),
        "tuned_on": found.split.tuned_words,
        "tested_on": found.split.tested_words,
        "score": _rounded(found.chosen.score),
        **({"tested_score": _rounded(found.chosen.tested_score)} if found.chosen.tested is not None else {}),
        "seed": found.seed,
        "evaluations": len(found.seen),
    }
    return f"{use}{tomli_w.dumps({**blocks, 'tuning': about})}"


def _of(found: Tuned, kind: str) -> dict[str, float]:
    return {axis.name: found.chosen.values[axis.key] for axis in found.axes if axis.kind == kind}


def _rounded(value: float) -> float:
    return float(f"{value:.4g}")


def as_json(found: Tuned) -> dict[str, Any]:
    """Return all figures of a tuning; scores are shares of the case as it stands."""
    return {
        "format": FORMAT,
        "study": found.study.name,
        "case": found.case.id,
        "objectives": dict(found.goal.weights),
        "parameters": {
            axis.key: {"low": axis.low, "high": axis.high, "unit": axis.unit, "log": axis.is_log} for axis in found.axes
        },
        "tuned_on": found.split.tuned_words,
        "tested_on": found.split.tested_words,
        "seed": found.seed,
        "settings": [_setting(each) for each in found.settings],
        "evaluations": [
            {"values": dict(each.values), "score": each.score, **({"reason": each.reason} if each.reason else {})}
            for each in found.seen
        ],
        "warnings": list(found.warnings),
    }


def _setting(setting: Setting) -> dict[str, Any]:
    tested = {} if setting.tested is None else {"tested_score": setting.tested_score, "tested": _means(setting.tested)}
    return {
        "name": setting.name,
        "values": dict(setting.values),
        "score": setting.score,
        "tuned": _means(setting.tuned),
        **tested,
    }


def _means(figures: pd.DataFrame) -> dict[str, dict[str, float]]:
    weeks = sorted(figures["week"].unique())
    return {week: dict(_of_week(figures[figures["week"] == week])) for week in weeks}


def _of_week(figures: pd.DataFrame) -> Iterator[tuple[str, float]]:
    for name, objective in OBJECTIVES.items():
        yield objective.column, means(figures, name)[0]
    for column in ("heat_corrected_kWh_m2_week", "heat_kWh_m2_week", "setpoint_shift_K", "hours_below_per_week"):
        yield column, float(np.mean(figures[column]))
