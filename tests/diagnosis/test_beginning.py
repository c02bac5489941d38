"""A controller's record begins in a state that nobody recorded, and that its first output tells."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.diagnosis.realities import SETPOINT_C, dataset
from waxstudy.diagnosis.diagnose import diagnose
from waxstudy.diagnosis.model.beginning import begun
from waxstudy.plugin import Choice, FloatArray
from waxstudy.plugin.registry import installed
from waxstudy.simulation.chain import Chain
from waxstudy.simulation.replay import replay

PI = installed().components["controller", "pi"].component
STEP_S, INTERVAL_S = 15.0, 60.0


def pi(gain: float = 0.8) -> Choice:
    return Choice.of(PI, {"gain": gain, "integration_time_s": 8000.0})


def output(block: Choice, reading_C: FloatArray, integral: float) -> FloatArray:
    """What a controller makes of readings (n,) that begins with an integral."""
    chain = Chain({"controller": block}, STEP_S, {"controller": {"integral": integral}})
    setpoint_C = np.full(len(reading_C), SETPOINT_C)
    return replay(chain, "controller", reading_C, setpoint_C, interval_s=INTERVAL_S, start_s=0.0)[0]["controller"]


def begins(block: Choice, reading_C: FloatArray, seen: FloatArray) -> dict[str, float]:
    about = {"controller": block}, "controller", reading_C, np.full(len(reading_C), SETPOINT_C)
    return dict(begun(*about, seen, INTERVAL_S, 0.0, STEP_S).get("controller", {}))


@given(st.floats(0.2, 5.0), st.floats(0.2, 0.8), st.integers(0, 99))
@settings(max_examples=30, deadline=None)
def test_a_replay_goes_on_from_the_integral_that_its_output_tells(gain: float, integral: float, seed: int) -> None:
    reading_C = SETPOINT_C + 0.01 * np.random.default_rng(seed).normal(size=120).cumsum() / gain
    found = begins(pi(gain), reading_C, output(pi(gain), reading_C, integral))
    assert found["integral"] == pytest.approx(integral, abs=0.01)


def test_an_output_at_an_end_tells_nothing() -> None:
    assert begins(pi(), np.full(120, 15.0), np.ones(120)) == {}


def test_a_healthy_loop_that_was_at_work_before_its_record_shows_nothing() -> None:
    """Its gain is so low that nothing brings the output to an end, by which an integral is forgotten."""
    minutes, random = np.arange(5 * 1440), np.random.default_rng(2)
    reading_C = SETPOINT_C + 0.15 * np.sin(2.0 * np.pi * minutes / 300.0)
    seen = output(pi(), reading_C, 0.6)
    assert 0.05 < seen.min() < seen.max() < 0.95
    noisy_C = reading_C + random.normal(0.0, 0.005, len(minutes))
    time = pd.date_range("2023-01-02 00:01", periods=len(minutes), freq="min").astype(str)
    table = pd.DataFrame({"time": time, "sensor_temperature_C": noisy_C, "control_output": seen})
    made = dataset(table, "PI")
    nominal = {"controller": pi()}
    diagnosis = diagnose(replace(made, nominal=nominal, room=None, assumed=()), quick=True)
    (stage,) = (each for each in diagnosis.stages if each.channel == "control_output")
    assert diagnosis.verdict == "none"
    assert stage.gap < 0.01
