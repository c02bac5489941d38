"""The two golden tables, computed from the paper's study."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd

from waxstudy.api.activating import activate
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
