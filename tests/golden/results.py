"""The golden tables, computed from the paper's study and small ones like it."""

from __future__ import annotations

import io
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import replace
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from tests.paper.test_weather import row, write
from waxstudy.api.activating import activate
from waxstudy.api.running import Results
from waxstudy.api.running import run as of_mapping
from waxstudy.api.sweeping import sweep
from waxstudy.loop.loops import loops
from waxstudy.plugin.registry import installed
from waxstudy.report.content import gather
from waxstudy.report.render import as_csv
from waxstudy.results.run import Run
from waxstudy.simulation import kernel
from waxstudy.simulation.chain import Chain
from waxstudy.simulation.engine import Loop
from waxstudy.simulation.run import Progress, prepare, run
from waxstudy.study.model import Study
from waxstudy.study.read import read_study, study_of
from waxstudy.study.source import source_of
from waxstudy.tuning.objectives import Goal
from waxstudy.tuning.space import axes_of
from waxstudy.tuning.tune import tune

ROOT = Path(__file__).parents[2]
GOLDEN = ROOT / "results" / "golden"
TRACE_HOURS = 12
EVERY_STEPS = 120  # ten minutes
KEYS = ("case", "week")
LOOPS = 40  # of the fleet: enough to be a fleet, in two seconds
SWEEP_MEMBERS = 4
LOOPED = ("P_CP", "P_MC", "P_WM", "O_WM")
TUNED_CASE, TUNED_BUDGET = "P_MC", 30
SEASON_MEMBERS = 4
SEASON = (
    "setpoint_shift_K",
    "hours_below_per_week",
    "in_category_I_share",
    "heat_2019-03_kWh_m2",
    "heat_2019-04_kWh_m2",
)
SWEPT = ("setpoint_shift_K", "mae_K", "heat_kWh_m2_week", "heat_corrected_kWh_m2_week")


def study(name: str = "table5") -> Study:
    return read_study(ROOT / "studies" / f"{name}.toml", installed())


def traces() -> pd.DataFrame:
    """The first hours of every case and week from a room at its setpoint: too short for a rounding error to grow."""
    plan, frames = prepare(study()), []
    for case in plan.study.cases.values():
        for week, driven in plan.driven.items():
            loop = Loop(Chain(case.blocks, driven.step_s), driven, plan.study.comfort.operative_limit_C)
            intervals = np.arange(TRACE_HOURS)
            _, trace = loop.advance(loop.start(21.0), intervals, 0.0, 21.0, trace=True)
            rows = trace[EVERY_STEPS - 1 :: EVERY_STEPS]
            frame = pd.DataFrame(rows, columns=list(kernel.TRACE)).round(9)
            minutes = (np.arange(len(rows)) + 1) * EVERY_STEPS * driven.step_s / 60.0
            frames.append(frame.assign(case=case.id, week=week, minute=minutes))
    return pd.concat(frames, ignore_index=True)


def small(members: int, week: str = "january", **tables: Any) -> dict[str, Any]:
    """The paper's study in coarse steps, in one week."""
    stated = tomllib.loads((ROOT / "studies" / "table5.toml").read_text(encoding="utf-8"))
    stated["study"] = {"name": "golden", "step_s": 20}
    stated["weather"] = {week: stated["weather"][week]}
    stated["ensemble"]["members"] = members
    return {**stated, **tables}


def swept(folder: Path) -> pd.DataFrame:
    """A small sweep: two cases of the study in rooms of three windows and two shadings; mean and spread of members."""
    stated = small(SWEEP_MEMBERS, "february")
    stated["ladder"].pop("pi")
    stated["ladder"]["on-off"]["steps"] = stated["ladder"]["on-off"]["steps"][:1]
    stated["ladder"]["on-off"]["reference"] = "O_CP"
    rows = [(u, passes) for u in (0.6, 0.8, 1.0) for passes in (0.2, 1.0)]
    points = pd.DataFrame(rows, columns=["room.window_U_W_m2K", "room.shading.passes"])
    return _by_members(sweep(stated, points, folder).frame, ["point", "case"], SWEPT)


def season(folder: Path) -> pd.DataFrame:
    """Two weeks at the turn of spring, in which four mild days do not count."""
    weather = {"use": "epw", "path": write(folder / "year.epw", list(_spring())), "start": "03-25", "days": 14}
    stated = small(SEASON_MEMBERS, weather={"spring": weather}, season={"limit_C": 5.0})
    stated["ladder"].pop("pi")
    found = of_mapping(stated, folder / "run")
    assert isinstance(found, Results)
    return _by_members(found.kpis, ["case"], SEASON)


def _spring() -> Iterator[str]:
    for hour in range(24 * 120):
        parts = row(datetime(2019, 1, 1) + timedelta(hours=hour), 0).split(",")
        is_mild = 24 * 90 <= hour < 24 * 94
        parts[6] = "16.0" if is_mild else "-3.0"
        parts[13:16] = ("400", "300", "200") if is_mild and 8 <= hour % 24 < 18 else ("0", "0", "0")
        yield ",".join(parts)


def looped() -> pd.DataFrame:
    """Margins, limits and wear of four loops."""
    rows = loops(study_of(source_of(small(4)), installed()), LOOPED, ["january"], Progress())
    return pd.DataFrame([vars(each) for each in rows]).drop(columns=["loop", "why", "week"]).round(6)


def tuned(folder: Path) -> pd.DataFrame:
    """What a short search finds for a modulated PI loop, beside the case as it stands and the rules of textbooks."""
    whole = study_of(source_of(small(2)), installed())
    axes = axes_of(whole, whole.cases[TUNED_CASE], {})
    options: dict[str, Any] = {"weeks": ["january"], "budget": TUNED_BUDGET, "seed": 1, "workers": 1}
    found = tune(whole, TUNED_CASE, Goal({"tracking": 1.0}), axes, folder, told=Progress(), **options)
    rows = [{"setting": each.name, **each.values, "score": each.score} for each in found.settings]
    return pd.DataFrame(rows).round(6)


def _by_members(frame: pd.DataFrame, keys: list[str], columns: Sequence[str]) -> pd.DataFrame:
    """Mean and spread of members."""
    groups = frame.groupby(keys, sort=False)[list(columns)]
    return groups.mean().join(groups.std().add_suffix("_sd")).reset_index()


def table(folder: Path) -> pd.DataFrame:
    """The comparison of the whole study, as `waxstudy report --format csv` gives it, with the number of members."""
    run(study(), folder)
    content = gather(Run(folder), study())
    return pd.read_csv(io.StringIO(as_csv(content))).assign(members=content.members)


def fleet(folder: Path) -> pd.DataFrame:
    """The table of the study of a fleet, with fewer loops."""
    whole = study("activation")
    assert whole.activation
    call = whole.activation.call.model_copy(update={"loops": LOOPS})
    return activate(replace(whole, activation=replace(whole.activation, call=call)), folder).table.round(6)
