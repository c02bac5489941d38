"""The tables of a tuning: settings beside each other, on the weather tuned on and on that which took no part."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import pandas as pd

from waxstudy.report.table import Column, Table, text
from waxstudy.report.words import with_spread
from waxstudy.tuning.objectives import OBJECTIVES
from waxstudy.tuning.space import Axis
from waxstudy.tuning.tune import STANDS, Setting, Tuned

HEADINGS = {"tracking": "MAE", "comfort": "below at equal heat", "switches": "switches", "travel": "strokes"}


def tables(found: Tuned) -> list[Table[Setting]]:
    """Settings on the weather tuned on, then on that which took no part."""
    parts = [_table(found, f"on {found.split.tuned_words}, which was tuned on", lambda s: s.tuned, lambda s: s.score)]
    if found.chosen.tested is not None:
        title = f"on {found.split.tested_words}, which took no part"
        parts.append(_table(found, title, lambda s: s.tested, lambda s: s.tested_score))
    return parts


def _table(
    found: Tuned,
    title: str,
    figures: Callable[[Setting], pd.DataFrame | None],
    score: Callable[[Setting], float],
) -> Table[Setting]:
    columns: list[Column[Setting]] = [text("settings", lambda setting: setting.name)]
    columns += [_parameter(axis) for axis in found.axes]
    columns.append(Column("score", score, ".3f"))
    columns += [_objective(name, figures) for name in OBJECTIVES]
    columns.append(Column("heat", lambda setting: _heat(figures(setting)), ".3f", "corrected heat", "kWh/m²"))
    return Table(title, columns, [setting for setting in found.settings if figures(setting) is not None])


def _parameter(axis: Axis) -> Column[Setting]:
    return Column(axis.name, lambda setting: setting.values[axis.key], "g", unit=unit_beside(axis))


def _objective(name: str, figures: Callable[[Setting], pd.DataFrame | None]) -> Column[Setting]:
    unit = OBJECTIVES[name].unit
    return Column(name, lambda setting: _told(figures(setting), name), heading=HEADINGS[name], unit=unit)


def unit_beside(axis: Axis) -> str:
    """Return a parameter's unit, as far as its name does not tell it."""
    return "" if axis.unit == "1" or axis.name.endswith(f"_{axis.unit}") else axis.unit


def _told(figures: pd.DataFrame | None, name: str) -> str:
    """Mean over weeks and members, ± the spread of single runs within a week."""
    if figures is None:
        return ""
    values = figures.groupby("week")[OBJECTIVES[name].column]
    return with_spread(float(values.mean().mean()), float(values.std().mean()), OBJECTIVES[name].form)


def _heat(figures: pd.DataFrame | None) -> float:
    return math.nan if figures is None else float(figures["heat_corrected_kWh_m2_week"].mean())


def notes(found: Tuned) -> list[str]:
    """What a reader must know besides the warnings, which were told when they came."""
    return [*_told_of_test(found), *_at_bounds(found), *_left_out(found)]


def verdict(found: Tuned) -> str:
    """What was found, in one sentence."""
    values = ", ".join(
        f"{axis.name} {found.chosen.values[axis.key]:g} {unit_beside(axis)}".rstrip() for axis in found.axes
    )
    gained = f"{_less(found.chosen.score)} of {found.goal.words} than the case {STANDS}"
    if found.chosen.tested is None:
        return f"{values}: {gained} on {found.split.tuned_words}; not tested, as no other weather is left."
    tested = f"{_less(found.chosen.tested_score)} on {found.split.tested_words}"
    return f"{values}: {gained} on {found.split.tuned_words}, {tested}, which took no part."


def _less(score: float) -> str:
    """Return what a score is against that of the case as it stands, which is 1."""
    return f"{abs(100.0 * (1.0 - score)):.0f} % {'more' if score > 1.0 else 'less'}"


def _told_of_test(found: Tuned) -> Iterator[str]:
    if found.chosen.tested is not None and found.chosen.tested_score >= 1.0:
        yield "on the weather that took no part the tuned settings are no better than the case as it stands"
    own = found.chosen.tested_score
    better = [f"{each.name} ({each.tested_score:.2f})" for each in found.settings[2:] if each.tested_score < own]
    if better:
        yield f"on the weather that took no part {', '.join(better)} is better than the tuned settings ({own:.2f})"


def _at_bounds(found: Tuned) -> Iterator[str]:
    for axis in found.axes:
        value = found.chosen.values[axis.key]
        if value in (axis.low, axis.high):
            wider = f"wider bounds may hold a better one (--vary {axis.key}=LOW..HIGH)"
            yield f"{axis.key} ends at its bound of {value:g}: {wider}"


def _left_out(found: Tuned) -> Iterator[str]:
    reasons = [each.reason for each in found.seen if each.reason]
    if reasons:
        yield f"{len(reasons)} of {len(found.seen)} settings do not count; the first: {reasons[0]}"
