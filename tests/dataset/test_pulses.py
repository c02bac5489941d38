"""Claims about a flow that was counted in pulses: what flowed between them is read, and nothing of it is lost."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from waxstudy.dataset.checks import units
from waxstudy.dataset.checks.check import Record, run
from waxstudy.dataset.notes import Notes
from waxstudy.dataset.pulses import Pulses
from waxstudy.plugin import FloatArray

FULL_L_H = 120.0


def counted(flow_L_h: FloatArray, pulse_L: float, interval_s: float = 60.0) -> FloatArray:
    """What a logger writes that counts the pulses of each sample."""
    pulses = np.floor(np.cumsum(flow_L_h) * interval_s / 3600.0 / pulse_L + 1e-9)
    return np.diff(pulses, prepend=0.0) * pulse_L * 3600.0 / interval_s


def heated(on_min: int, pause_min: int, cycles: int = 40) -> FloatArray:
    """A valve that is open for so long, and then closed, sample by sample (n,)."""
    return np.tile(np.repeat([1.0, 0.0], [on_min, pause_min]), cycles)


@given(st.floats(2.1, 20.0), st.integers(12, 40), st.integers(5, 60), st.floats(60.0, 180.0))
@settings(max_examples=60)
def test_nothing_that_was_counted_is_lost_and_means_are_as_true_as_they_say(
    pulse_L: float, on_min: int, pause_min: int, full_L_h: float
) -> None:
    is_open = heated(on_min, pause_min)
    true_L_h = full_L_h * is_open
    seen = counted(true_L_h, pulse_L)
    pulses = Pulses.of(seen, is_open)
    if pulses is None:  # pulses come as evenly as flow does
        per_sample = full_L_h / 60.0 / pulse_L
        assert abs(per_sample - round(per_sample)) < 0.1
        return
    read = pulses.spread(seen, is_open)
    whole = (pulses.span > 0) & (pulses.span < pulses.span[-1])
    assert read[whole].sum() == pytest.approx(seen[whole].sum())
    assert not read[whole & (is_open == 0.0)].any()
    off = (pulses.means(read) - pulses.means(true_L_h))[pulses.ends]
    assert np.abs(off).max() <= (pulses.noise(full_L_h)[pulses.ends] * 6.0**0.5).max() + 1e-6


@pytest.mark.parametrize("interval_s", [60.0, 300.0])
def test_pulses_are_told_from_water_that_flows(interval_s: float) -> None:
    minutes = round(interval_s / 60.0)
    is_open = heated(20, 40)[::minutes]
    flowing, noise = FULL_L_H * is_open, np.random.default_rng(1).normal(0.0, 1.0, len(is_open))
    assert Pulses.of(counted(flowing, 7.0, interval_s), is_open) is not None
    assert Pulses.of(flowing, is_open) is None  # a valve without noise
    assert Pulses.of(np.round(flowing + noise * is_open, 1), is_open) is None
    assert Pulses.of(counted(flowing, 0.1, interval_s), is_open) is None  # so fine that a sample tells it
    assert Pulses.of(np.zeros(len(is_open)), is_open) is None


def test_a_lost_sample_loses_its_span_for_the_valve_and_nothing_for_the_room() -> None:
    is_open = heated(20, 40)
    seen = counted(FULL_L_H * is_open, 7.0)
    seen[605] = np.nan
    pulses = Pulses.of(seen, is_open)
    assert pulses
    of_span = pulses.span == pulses.span[605]
    assert not pulses.ends[of_span].any()
    assert int(pulses.ends.sum()) > 30
    read = pulses.spread(seen, is_open)
    assert np.flatnonzero(np.isnan(read)).tolist() == [605]


def test_what_a_pulse_is_written_as_is_no_unusual_flow() -> None:
    is_open = heated(20, 40)
    steady_L_h, notes = 5.0 * FULL_L_H * is_open, {}
    for name, flow in (("counted", counted(FULL_L_H * is_open, 10.0)), ("flows", steady_L_h)):
        values = pd.DataFrame({"displacement": is_open, "flow_L_h": flow})
        notes[name] = Notes("data.csv")
        run([units.flow], Record(values, 60.0, full_flow_L_h=FULL_L_H), notes[name])
    assert values["flow_L_h"].max() == counted(FULL_L_H * is_open, 10.0).max()
    assert not notes["counted"].warnings
    assert "unusual" in notes["flows"].warnings[0]
