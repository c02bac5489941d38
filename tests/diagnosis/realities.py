"""Small records for the diagnosis: cases of a small study measured in the paper's room, and what is believed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pandas as pd

from waxstudy.dataset.channels import CHANNELS
from waxstudy.dataset.read import Dataset
from waxstudy.diagnosis.calibration.healthy import AsBelieved
from waxstudy.diagnosis.diagnose import record_of
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.model.segments import Segment
from waxstudy.diagnosis.observations.partition import FIT
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.select.changed import changed
from waxstudy.diagnosis.select.search import Search, Selection
from waxstudy.diagnosis.select.weigh import Weighing
from waxstudy.plugin import Belief, Effect, FloatArray
from waxstudy.plugin.registry import installed
from waxstudy.study.model import Study
from waxstudy.study.read import read_study
from waxstudy.synthetic.instruments import Instruments, measure
from waxstudy.synthetic.simulate import Reality, reality_loop, simulate

SETPOINT_C = 21.0
Effects = tuple[tuple[str, tuple[tuple[str, float], ...]], ...]  # names and values, as a key
PERFECT: Mapping[str, Any] = {"noise": dict.fromkeys(CHANNELS, 0.0), "resolution": dict.fromkeys(CHANNELS, 0.0)}

EFFECTS: dict[str, type[Effect]] = {
    name: entry.component
    for (kind, name), entry in installed().components.items()
    if kind == "effect" and entry.package == "waxstudy" and issubclass(entry.component, Effect)
}


def effects(**named: Mapping[str, float]) -> Effects:
    """Effects by name, with _ for -, and their values."""
    return tuple((name.replace("_", "-"), tuple(values.items())) for name, values in named.items())


STUDY = """\
[study]
name = "gap"

[room]
use = "nzeb"

[weather.january]
use = "tallinn-week"
month = "january"

[ladder.on-off]
reference = "REAL"
start = { id = "IDEAL", controller = { use = "on-off", dead_band_K = 0.5 }, valve = { use = "linear" } }
steps = [
  { id = "LATE", sensor = { use = "delay", delay_s = 600.0 } },
  { id = "WAX", sensor = { delay_s = 120.0 }, actuator = { use = "variable-times" } },
  { id = "REAL", valve = { use = "quick-opening" } },
]

[ladder.pi]
reference = "PWM"
start = { id = "PI", controller = { use = "pi", gain = 18.0, integration_time_s = 2300.0 }, valve = { use = "linear" } }
steps = [
  { id = "PWM", modulator = { use = "pwm" } },
]
"""


@cache
def study() -> Study:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "gap.toml"
        path.write_text(STUDY)
        return read_study(path, installed())


def with_effects(believed: Belief, effects: Effects) -> Belief:
    for name, values in effects:
        believed = EFFECTS[name].apply(believed, EFFECTS[name].Parameters(**dict(values)))
    return believed


@cache
def reality(case: str, days: int = 4, effects: Effects = ()) -> Reality:
    """What happened in the first days of a case with effects of its chain, free of noise, every 5 s."""
    blocks = with_effects(Belief(study().cases[case].blocks, study().room), effects).blocks
    true = replace(study().cases[case], blocks=blocks)
    return simulate(reality_loop(study(), true, ["january"], days), study(), SETPOINT_C)


def rows(case: str, days: int = 4, effects: Effects = (), **measured: Any) -> pd.DataFrame:
    """What instruments show of a case with effects."""
    return measure(reality(case, days, effects), Instruments(**measured))


def dataset(data: pd.DataFrame, believed: str, **changes: Any) -> Dataset:
    """What is measured as a dataset of which a case is believed."""
    values = data.drop(columns="time")
    time = pd.DatetimeIndex(data["time"])
    interval_s = (time[1] - time[0]).total_seconds()
    values.index = time
    made = Dataset(
        name="made",
        folder=Path("made"),
        interval_s=interval_s,
        time=time,
        values=values,
        assumed=("solar_gain_W", "internal_gain_W"),
        nominal=study().cases[believed].blocks,
        setpoint_C=SETPOINT_C,
        room=study().room,
        room_tolerance=1.0,
        noise={},
        site=None,
        warnings=(),
        assumptions=(),
    )
    return replace(made, **changes)


def record(case: str, days: int = 4, without: Sequence[str] = (), effects: Effects = (), **measured: Any) -> Record:
    return record_of(dataset(rows(case, days, effects, without=tuple(without), **measured), case))


def belief(case: str, record: Record) -> Belief:
    return Belief(study().cases[case].blocks, study().room, record.inputs if record.has_inputs else None)


def estimator(
    segment: Segment, record: Record, believed: Belief, thorough: float = 1.0, **how: Any
) -> Estimator[SegmentProblem]:
    """Something that fits hypotheses to a segment of a record."""
    return Estimator(SegmentProblem(segment, record, believed, **how), thorough)


def as_believed(
    segment: Segment, record: Record, believed: Belief, names: Sequence[str], thorough: float = 1.0
) -> Weighing:
    """What weighs effects of a link of the chain without a healthy record."""
    whole = SegmentProblem(segment, record, believed, parts=np.full(len(record), FIT))
    healthy = AsBelieved.of(whole, Estimator(whole, thorough).base)
    return Weighing(whole, [EFFECTS[name] for name in names], healthy, thorough, lambda name: None)


def weighed(
    segment: Segment, record: Record, believed: Belief, names: Sequence[str] = (), thorough: float = 1.0
) -> Selection:
    """What is said of a link of the chain without a healthy record, of some effects."""
    weighing = as_believed(segment, record, believed, names, thorough)
    fitter = Estimator(SegmentProblem(segment, record, believed, alike=weighing.problem), thorough, keeps=True)
    search = Search(fitter, weighing.effects, np.random.default_rng(1), lambda name: None)
    return changed(search, weighing.healthy, weighing.problem, lambda name: None)


def plain(values: Mapping[str, FloatArray], interval_s: float = 60.0, **more: Any) -> Record:
    """A record of given channels from midnight on."""
    return Record(interval_s, 0.0, {name: np.asarray(each, dtype=float) for name, each in values.items()}, **more)


def planted(segment: Segment, record: Record, believed: Belief, true: Effects = (), seed: int = 1) -> Record:
    """A record in which a segment does what is believed with some effects, seen with each channel's noise."""
    random = np.random.default_rng(seed)
    values = dict(record.values)
    for channel, predicted in segment.predict(
        record, with_effects(believed, true), segment.conventions[0], is_fine=True
    ).items():
        whole = np.repeat(predicted, len(record) // len(predicted))
        noise = random.normal(0.0, record.noise[channel], len(record))
        noise[whole == 0.0] *= 0.0 if channel == "flow_L_h" else 1.0  # a meter that stands still
        seen = whole if channel in record.binary else whole + noise
        values[channel] = np.clip(seen, 0.0, 1.0) if channel == "displacement" else seen
    return replace(record, values=values)
