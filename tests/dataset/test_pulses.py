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
from waxstudy.dataset.pulses import Pulses, opening_channel
from waxstudy.plugin import FloatArray

FULL_L_H = 120.0


def counted(flow_L_h: FloatArray, pulse_L: float, interval_s: float = 60.0) -> FloatArray:
    """What a logger writes that counts the pulses of each sample."""
    pulses = np.floor(np.cumsum(flow_L_h) * interval_s / 3600.0 / pulse_L + 1e-9)
    return np.diff(pulses, prepend=0.0) * pulse_L * 3600.0 / interval_s


def heated(on_min: int, pause_min: int, cycles: int = 40) -> FloatArray:
    """A valve that is open for so long, and then closed, sample by sample (n,)."""
    return np.tile(np.repeat([1.0, 0.0], [on_min, pause_min]), cycles)


@given(st.floats(2.1, 20.0), st.integers(12, 40), st.integers(5, 60), st.floats(60.0, 180.0), st.integers(0, 60))
@settings(max_examples=80)
def test_nothing_that_was_counted_is_lost_and_means_are_as_true_as_they_say(
    pulse_L: float, on_min: int, pause_min: int, full_L_h: float, cut: int
) -> None:
    opening = heated(on_min, pause_min)[: 40 * (on_min + pause_min) - cut]
    true_L_h = full_L_h * opening
    seen = counted(true_L_h, pulse_L)
    pulses = Pulses.of(seen, opening)
    if pulses is None:  # pulses come nearly as evenly as flow does, or once each time that the valve opens
        per_sample = full_L_h / 60.0 / pulse_L
        assert abs(per_sample - round(per_sample)) < 0.07 or abs(per_sample * on_min - 1.0) < 0.1
        return
    read = pulses.spread(seen, opening)
    one_L_h = pulse_L * 60.0
    assert abs(float(read.sum() - true_L_h.sum())) <= 1.5 * one_L_h
    whole = (pulses.span > 0) & (pulses.span < pulses.span[-1])
    assert read[whole].sum() == pytest.approx(seen[whole].sum())
    assert read.max() <= 1.8 * full_L_h
    off = np.abs(pulses.means(read) - pulses.means(true_L_h))[pulses.ends]
    assert np.all(off <= full_L_h / pulses.samples[pulses.ends] + 1e-6)
    assert pulses.usual_L_h == pytest.approx(full_L_h, rel=0.1)
    assert np.all(pulses.noise <= 0.46 * full_L_h / pulses.samples)


@pytest.mark.parametrize("interval_s", [60.0, 300.0])
def test_pulses_are_told_from_water_that_flows(interval_s: float) -> None:
    minutes = round(interval_s / 60.0)
    opening = heated(20, 40)[::minutes]
    flowing, noise = FULL_L_H * opening, np.random.default_rng(1).normal(0.0, 1.0, len(opening))
    assert Pulses.of(counted(flowing, 7.0, interval_s), opening) is not None
    assert Pulses.of(flowing, opening) is None  # a valve without noise
    delayed = np.concatenate(([0.0], flowing[:-1]))
    assert Pulses.of(delayed, opening) is None  # and its motor, a sample late
    assert Pulses.of(np.round(flowing + noise * opening, 1), opening) is None
    assert Pulses.of(counted(flowing, 0.1, interval_s), opening) is None  # so fine that a sample tells it
    assert Pulses.of(np.zeros(len(opening)), opening) is None


@pytest.mark.parametrize(("pulse_L", "interval_s"), [(3.0, 60.0), (1.6, 60.0), (0.9, 60.0), (6.7, 120.0)])
def test_pulses_are_told_through_noise_that_a_logger_adds(pulse_L: float, interval_s: float) -> None:
    opening = heated(20, 40)
    one_L_h = pulse_L * 3600.0 / interval_s
    seen = counted(FULL_L_H * opening, pulse_L, interval_s)
    noise = np.random.default_rng(3).normal(0.0, 1.2, len(seen))
    pulses = Pulses.of(np.where(seen > 0.0, seen + noise, 0.0), opening)
    assert pulses
    assert pulses.pulse_L_h == pytest.approx(one_L_h, rel=0.005)
    assert pulses.usual_L_h == pytest.approx(FULL_L_H, rel=0.03)


def test_a_lost_sample_loses_its_span_for_the_valve_and_nothing_for_the_room() -> None:
    opening = heated(20, 40)
    seen = counted(FULL_L_H * opening, 7.0)
    seen[605] = np.nan
    pulses = Pulses.of(seen, opening)
    assert pulses
    of_span = pulses.span == pulses.span[605]
    assert not pulses.ends[of_span].any()
    assert int(pulses.ends.sum()) > 30
    read = pulses.spread(seen, opening)
    assert np.flatnonzero(np.isnan(read)).tolist() == [605]


def test_what_a_pulse_is_written_as_is_no_unusual_flow() -> None:
    opening = heated(20, 40)
    pulsed, notes = counted(FULL_L_H * opening, 10.0), {}
    for name, flow in (("counted", pulsed), ("flows", pulsed.max() * opening)):
        values = pd.DataFrame({"displacement": opening, "flow_L_h": flow})
        notes[name] = Notes("data.csv")
        run([units.flow], Record(values, 60.0, full_flow_L_h=FULL_L_H), notes[name])
    assert not notes["counted"].warnings
    assert "unusual" in notes["flows"].warnings[0]


def test_rare_pulses_and_a_few_odd_values_are_pulses_still() -> None:
    opening = heated(50, 10)
    assert Pulses.of(counted(FULL_L_H * opening, 60.0), opening) is not None  # one in half an hour
    odd = counted(FULL_L_H * opening, 7.0)
    odd[np.flatnonzero(odd)[::100]] *= 1.25  # a mean of the samples that a lost one left
    assert Pulses.of(odd, opening) is not None


def test_a_leak_that_is_counted_is_no_peak_when_the_valve_opens() -> None:
    opening = heated(30, 90)
    leaking = np.where(opening > 0.0, FULL_L_H, 6.0)
    pulses = Pulses.of(counted(leaking, 10.0), opening)
    assert pulses
    read = pulses.spread(counted(leaking, 10.0), opening)
    assert read.max() < 2.0 * FULL_L_H
    assert 2.0 < read[opening == 0.0].mean() < 7.0


def test_an_output_that_switches_tells_when_water_may_flow_and_one_that_runs_on_does_not() -> None:
    switched = {"control_output": heated(20, 40)}
    assert opening_channel(switched) == "control_output"
    assert opening_channel({"control_output": 0.5 * heated(20, 40)}) == ""
    assert opening_channel({**switched, "displacement": np.zeros(2400)}) == "control_output"
    assert opening_channel({"displacement": np.full(10, np.nan)}) == ""
