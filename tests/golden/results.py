"""The three golden tables, computed from the paper's study."""

from __future__ import annotations

import io
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd

from waxstudy.api.activating import activate
from waxstudy.api.sweeping import sweep
from waxstudy.plugin.registry import installed
from waxstudy.report.content import gather
from waxstudy.report.render import as_csv
from waxstudy.results.run import Run
from waxstudy.simulation import kernel
from waxstudy.simulation.chain import Chain
from waxstudy.simulation.engine import Loop
from waxstudy.simulation.run import prepare, run
from waxstudy.study.model import Study
from waxstudy.study.read import read_study

ROOT = Path(__file__).parents[2]
GOLDEN = ROOT / "results" / "golden"
TRACE_HOURS = 12
EVERY_STEPS = 120  # ten minutes
KEYS = ("case", "week")
LOOPS = 40  # of the fleet: enough to be a fleet, in two seconds
SWEEP_MEMBERS = 4
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


def swept(folder: Path) -> pd.DataFrame:
    """A small sweep: two cases of the study in rooms of three windows and two shadings; mean and spread of members."""
    stated = tomllib.loads((ROOT / "studies" / "table5.toml").read_text(encoding="utf-8"))
    stated["study"] = {"name": "golden", "step_s": 20}
    stated["weather"].pop("january")
    stated["ensemble"]["members"] = SWEEP_MEMBERS
    stated["ladder"].pop("pi")
    stated["ladder"]["on-off"]["steps"] = stated["ladder"]["on-off"]["steps"][:1]
    stated["ladder"]["on-off"]["reference"] = "O_CP"
    rows = [(u, passes) for u in (0.6, 0.8, 1.0) for passes in (0.2, 1.0)]
    points = pd.DataFrame(rows, columns=["room.window_U_W_m2K", "room.shading.passes"])
    frame = sweep(stated, points, folder).frame
    groups = frame.groupby(["point", "case"], sort=False)[list(SWEPT)]
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
