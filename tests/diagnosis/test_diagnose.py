"""Whole diagnoses: of records of another engine with their truth, and of records that hold too little."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache

import numpy as np
import pandas as pd
import pytest

from tests.conftest import DATA
from tests.diagnosis.realities import dataset, rows
from waxstudy.dataset.read import read_dataset
from waxstudy.diagnosis.assembly import Work, _parts
from waxstudy.diagnosis.diagnose import diagnose, installed_effects, record_of
from waxstudy.diagnosis.estimate.parameter_space import Space
from waxstudy.diagnosis.result import Diagnosis, FoundEffect
from waxstudy.plugin import Belief

REALITIES = DATA / "realities"
needs_realities = pytest.mark.skipif(not REALITIES.is_dir(), reason=f"no records with their truth in {REALITIES}")


ALIKE = {
    "r02": ("sensor-lag",),  # of nearly as many seconds
    "r03": ("stuck-open",),  # without a displacement what leaks and what stays open a little move the same water
}
TIMES = {"sensor-delay": "delay_s", "sensor-lag": "time_constant_s"}


@cache
def of(record: str) -> Diagnosis:
    return diagnose(read_dataset(REALITIES / record), quick=True)


def only(record: str) -> FoundEffect:
    (effect,) = of(record).effects
    return effect


@needs_realities
@pytest.mark.slow
@pytest.mark.parametrize("record", ["r08"])
def test_nothing_is_claimed_where_nothing_was_put_in(record: str):
    assert (of(record).verdict, list(of(record).effects)) == ("none", [])


@needs_realities
@pytest.mark.slow
@pytest.mark.parametrize(
    ("record", "name", "parameter", "truth"),
    [
        ("r02", "sensor-delay", "delay_s", 600.0),
        ("r03", "let-by", "fraction", 0.015),
        ("r04", "gain-shift", "shift_h", 8.0),
    ],
)
def test_what_was_put_in_is_named_and_measured(record: str, name: str, parameter: str, truth: float):
    effect = only(record)
    assert name in effect.group
    assert set(effect.group) <= {name, *ALIKE.get(record, ())}
    assert effect.name == name or record == "r02"
    found = effect.parameters[TIMES.get(effect.name, parameter)]
    assert abs(found.value / truth - 1.0) < 0.2 or found.low <= truth <= found.high


@needs_realities
@pytest.mark.slow
@pytest.mark.parametrize("record", ["r02", "r03"])
def test_the_gap_shrinks_by_four_fifths_on_days_that_took_no_part(record: str):
    assert only(record).shrink.value >= 0.8


def test_midnight_ends_the_last_day_of_a_part():
    times = pd.date_range("2021-01-01 00:01", periods=7 * 1440, freq="min")
    made = dataset(pd.DataFrame({"time": times, "air_temperature_C": 21.0}), "WAX")
    work = Work(made, record_of(made), Belief(made.nominal, made.room), [], 1, 1.0)
    parts = _parts(work, [])
    assert (parts["fit"][0], parts["shrinkage"][1]) == ("2021-01-01", "2021-01-07")


# --- records that hold too little --------------------------------------------------------------------


def one_channel(data: pd.DataFrame) -> pd.DataFrame:
    return data[["time", "air_temperature_C"]]


def one_day(data: pd.DataFrame) -> pd.DataFrame:
    return data.iloc[:1440]


def constant_signals(data: pd.DataFrame) -> pd.DataFrame:
    return data.assign(control_output=0.0, heating_signal=0.0, displacement=0.0, flow_L_h=0.0)


def mostly_missing(data: pd.DataFrame) -> pd.DataFrame:
    lost = np.random.default_rng(1).random((len(data), len(data.columns) - 1)) < 0.95
    return pd.concat([data[["time"]], data.drop(columns="time").mask(lost)], axis=1)


@pytest.mark.parametrize("poor", [one_channel, one_day, constant_signals, mostly_missing])
def test_a_record_that_holds_too_little_is_said_to_be_untestable(poor: Callable[[pd.DataFrame], pd.DataFrame]):
    diagnosis = diagnose(dataset(poor(rows("REAL", days=4)), "WAX"), quick=True)
    assert (diagnosis.verdict, list(diagnosis.effects)) == ("untestable", [])
    assert all(each.reason for each in diagnosis.untestable)
    assert diagnosis.untestable


def test_of_a_long_record_the_days_that_tell_most_are_judged_and_it_is_said():
    time = pd.date_range("2021-01-01 01:00", periods=40 * 24, freq="h")
    diagnosis = diagnose(dataset(pd.DataFrame({"time": time, "air_temperature_C": 21.0}), "WAX"), quick=True)
    said = "Of the record's 40 days the 28 from 2021-01-13 to 2021-02-09 are judged, which tell most"
    assert [warning for warning in diagnosis.warnings if warning.startswith(said)]


@pytest.mark.slow
def test_an_effect_is_not_joined_by_those_that_only_it_makes_possible():
    """A modulation that nobody believes in has a period and a shortest pulse of its own."""
    diagnosis = diagnose(dataset(rows("PWM", days=6), "PI"), quick=True)
    assert [effect.name for effect in diagnosis.effects] == ["modulation"]


@pytest.mark.slow
def test_the_same_seed_gives_the_same_bytes():
    data = rows("LATE", days=3)
    texts = [json.dumps(diagnose(dataset(data, "IDEAL"), quick=True).described(), default=float) for _ in range(2)]
    assert texts[0] == texts[1]


@pytest.mark.parametrize(
    ("name", "parameter", "value", "is_end"),
    [
        ("slow-actuator", "factor", 0.3, True),
        ("slow-actuator", "factor", 0.303, False),
        ("infiltration", "factor", 0.12, False),  # of a range that is told by its logarithm
        ("limited-travel", "opening", 1.0, False),  # more there cannot be
        ("window-opening", "from_h", 0.0, False),
    ],
)
def test_an_end_of_what_is_tried_is_one_unless_nothing_lies_beyond(
    name: str, parameter: str, value: float, is_end: bool
) -> None:
    effect = next(each for each in installed_effects() if each.name == name)
    middle = {each: 0.5 * (prior.low + prior.high) for each, prior in effect.priors.items()}
    assert Space(effect).at_end({**middle, parameter: value}) == [parameter] * is_end
