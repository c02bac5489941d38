"""Characteristic times are those that the motor had, at any sampling, and lost cycles say why."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.fit.conftest import QUIET, STEADY, Read, medians, table_of
from waxstudy.dataset.notes import Notes
from waxstudy.identification.description import Described
from waxstudy.identification.records import Record, record_of, samples_of
from waxstudy.identification.times import RISES_PER_5S, TIMES, cycles_of, movements
from waxstudy.rig.instruments import Bench
from waxstudy.rig.programme import Trial


def trapezoids(
    times_s: dict[str, float], cycles: int, interval_s: float, noise: float, seed: int, drift: float = 0.0
) -> Record:
    """A record of ideal trapezoids, as in Figure 3, whose times are known; `drift` is of the stroke in a day."""
    lengths = np.tile([times_s[name] for name in TIMES], cycles)
    start_s = 47.3
    edges = start_s + np.concatenate(([0.0], np.cumsum(lengths)))
    levels = [0.0, *np.tile([0.0, 1.0, 1.0, 1.0, 0.0, 0.0], cycles)]
    time_s = np.arange(interval_s, edges[-1], interval_s)
    draw = np.random.default_rng(seed)
    opening = np.interp(time_s, edges, levels) + noise * draw.normal(size=len(time_s))
    ons, offs = edges[:-1:6], edges[3::6]
    on = (np.searchsorted(ons, time_s) > np.searchsorted(offs, time_s)).astype(float)
    notes = Notes("trapezoids")
    samples = samples_of(time_s, on, 3.0 - 2.0 * (opening + drift * time_s / 86_400.0), "mm", notes)
    assert samples is not None
    record = record_of(samples, Described(path=Path("t.csv"), name="t"), "B", notes)
    assert record is not None, notes.problems
    return replace(record, warnings=tuple(notes.warnings))


@settings(max_examples=25)
@given(
    dead=st.floats(20.0, 240.0),
    rise=st.floats(60.0, 240.0),
    overheat=st.floats(30.0, 900.0),
    hold=st.floats(20.0, 250.0),
    fall=st.floats(60.0, 200.0),
    undercool=st.floats(30.0, 900.0),
    interval_s=st.sampled_from([0.2, 0.5, 1.0, 2.0, 5.0, 10.0]),
    noise=st.floats(0.0, 0.001),
)
def test_ideal_trapezoids_give_their_own_times(interval_s: float, noise: float, **times: float) -> None:
    times_s = {f"{name}_s": value for name, value in times.items()}
    cycles = cycles_of(trapezoids(times_s, 4, interval_s, noise, 1))
    assert (cycles["lost"] == "").all()
    for name in TIMES:
        found = cycles[name].dropna()
        # half a sample at each end for the switch; what noise of the slope does to the edges of a ramp
        tolerance_s = 0.3 + 0.55 * interval_s + 8.0 * noise * max(times["rise"], times["fall"])
        assert found.to_numpy() == pytest.approx(times_s[name], abs=tolerance_s), name


def test_times_of_the_bench_have_no_bias_against_table_2() -> None:
    bench = Bench(
        exemplar_scatter=0.0, record_scatter=0.0, cycle_scatter=0.0, slack_mm=0.0, friction_mm=0.0, spikes_per_day=0.0
    )
    record = recorded(table_of(STEADY, bench))
    found = medians(record)
    before = float(cycles_of(record)["undercool_s"].median())
    table_2 = {
        "dead_s": 232.0 - 192.0 * np.exp(-before / 780.0),
        "rise_s": 163.0 - 30.0 * np.exp(-before / 1140.0),
        "hold_s": 58.0 + 82.0 * (1.0 - np.exp(-found["overheat_s"] / 600.0)),
        "fall_s": 123.0,
    }
    assert {name: found[name] for name in table_2} == pytest.approx(table_2, abs=0.35)


def recorded(frame: pd.DataFrame) -> Record:
    notes = Notes("record")
    samples = samples_of(*(frame[name].to_numpy() for name in ("time_s", "signal_V", "displacement_mm")), "mm", notes)
    assert samples is not None
    record = record_of(samples, Described(path=Path("r.csv"), name="r"), "B", notes)
    assert record is not None, notes.problems
    return record


@pytest.mark.parametrize(
    ("on_min", "off_min", "reason"),
    [(5.0, 5.0, "does not close fully"), (3.5, 30.0, "does not open fully")],
    ids=["heated too often", "heated too shortly"],
)
def test_cycles_that_do_not_open_or_close_are_left_out_and_say_so(on_min: float, off_min: float, reason: str) -> None:
    trial = Trial("A1", "A", "1", False, (on_min, on_min), (off_min, off_min), 300.0, "displacement")
    lost = cycles_of(recorded(table_of(trial)))["lost"]
    assert (lost != "").all()
    assert lost.value_counts().index[0] == reason


def test_the_first_cycle_has_no_past_and_the_last_may_be_cut_off(steady: pd.DataFrame, read: Read) -> None:
    cycles = cycles_of(read(steady.iloc[: 2 * 1800 + 1200]))
    assert np.isnan(cycles["before_s"].iloc[0])
    assert cycles["lost"].iloc[-1] == "cut off by the end"
    assert (cycles["lost"].iloc[:-1] == "").all()


def test_noise_drift_play_and_friction_of_the_bench_hardly_move_the_times() -> None:
    rough = Bench(noise_mm=0.006, drift_mm_day=0.05, slack_mm=0.005, friction_mm=0.008, resolution_mm=0.005)
    assert medians(recorded(table_of(STEADY, rough))) == pytest.approx(
        medians(recorded(table_of(STEADY, QUIET))), abs=1.0
    )


@pytest.mark.parametrize("drift", [0.03, -0.03])
def test_a_zero_that_wanders_for_days_moves_no_time_and_is_told(drift: float) -> None:
    """After eight days the sensor is off by a quarter of the stroke, at which no cycle would close."""
    times_s = {
        "dead_s": 90.0,
        "rise_s": 120.0,
        "overheat_s": 600.0,
        "hold_s": 60.0,
        "fall_s": 130.0,
        "undercool_s": 900.0,
    }
    wandering, steady = (trapezoids(times_s, 364, 10.0, 0.0005, 1, each) for each in (drift, 0.0))
    cycles = cycles_of(wandering)
    assert (cycles["lost"] == "").sum() >= (cycles_of(steady)["lost"] == "").sum() - 2
    for name in TIMES:
        assert cycles[name].median() == pytest.approx(times_s[name], abs=6.0), name
    assert "drifts" in " ".join(wandering.warnings)
    assert not steady.warnings


@pytest.mark.parametrize("interval_s", [0.5, 10.0])
def test_only_a_gap_in_a_fall_or_beside_it_hides_when_the_next_cycle_s_pause_began(interval_s: float) -> None:
    lengths_s = (90.0, 120.0, 600.0, 60.0, 130.0, 900.0)
    whole = trapezoids(dict(zip(TIMES, lengths_s, strict=True)), 4, interval_s, 0.0, 1)
    fall_s = cycles_of(whole)[["off_at_s", "hold_s"]].sum(axis=1).to_numpy()
    assert np.isfinite(cycles_of(whole)["before_s"]).tolist() == [False, True, True, True]
    of_second = {"within": fall_s[1] + 60.0, "long before": fall_s[1] - 300.0, "long after": fall_s[1] + 130.0 + 400.0}
    for place, at_s in of_second.items():
        missing = np.zeros_like(whole.missing)
        missing[round(at_s / interval_s) + np.arange(-1, 2)] = 1
        known = np.isfinite(cycles_of(replace(whole, missing=missing))["before_s"])
        assert known.tolist() == [False, True, place != "within", True], place


def test_what_is_left_of_a_spike_is_no_movement_and_a_ramp_is() -> None:
    opening = np.interp(np.arange(1000.0), [700.0, 820.0], [0.0, 1.0])
    opening[[300, 500]] += 0.5
    found = movements(opening, 1.0, RISES_PER_5S)
    assert (found.begins_s, found.ends_s) == (pytest.approx([700.0]), pytest.approx([820.0]))
