"""Characteristic times are those that the motor had, at any sampling, and lost cycles say why."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.fit.conftest import QUIET, STEADY, Read, medians, table_of
from waxstudy.dataset.notes import Notes
from waxstudy.identification.description import Described
from waxstudy.identification.records import Record, record_of, samples_of
from waxstudy.identification.times import RISES_PER_5S, TIMES, Movements, cycles_of, movements, within
from waxstudy.rig.instruments import Bench
from waxstudy.rig.programme import Trial


def trapezoids(
    times_s: dict[str, float],
    cycles: int,
    interval_s: float,
    noise: float,
    seed: int,
    drift: float = 0.0,
    start_s: float = 47.3,
) -> Record:
    """A record of ideal trapezoids, as in Figure 3, whose times are known; `drift` is of the stroke in a day."""
    lengths = np.tile([times_s[name] for name in TIMES], cycles)
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


LENGTHS_S = dict(zip(TIMES, (90.0, 120.0, 600.0, 60.0, 130.0, 900.0), strict=True))


@pytest.mark.parametrize("start_s", [50.0, 49.1, 42.0])
@pytest.mark.parametrize("interval_s", [1.0, 2.0, 5.0, 10.0])
def test_times_are_exact_where_nothing_is_noisy(interval_s: float, start_s: float) -> None:
    """A switch is taken to come halfway between two samples; the last pause is cut off, the first one not seen."""
    cycles = cycles_of(trapezoids(LENGTHS_S, 4, interval_s, 0.0, 1, start_s=start_s))
    late_s = (start_s // interval_s + 0.5) * interval_s - start_s
    late = dict(zip(TIMES, (-late_s, 0.0, late_s, -late_s, 0.0, late_s), strict=True))
    exact = {name: LENGTHS_S[name] + late[name] for name in TIMES}
    for name in TIMES:
        assert cycles[name].tolist() == pytest.approx(
            [exact[name]] * 3 + [np.nan if name == "undercool_s" else exact[name]], nan_ok=True
        )
    assert cycles["before_s"].tolist() == pytest.approx([np.nan, *[exact["undercool_s"]] * 3], nan_ok=True)
    ons_s = start_s + late_s - interval_s + 1900.0 * np.arange(4)
    assert cycles["on_at_s"].tolist() == pytest.approx(ons_s)
    assert cycles["off_at_s"].tolist() == pytest.approx(ons_s + 810.0)
    assert cycles["cycle"].tolist() == [1, 2, 3, 4]
    assert set(cycles["lost"]) == {""}


def of_second(record: Record, at_s: slice, opening: float | None = None, is_on: bool | None = None) -> Record:
    """A record with another opening or signal in a part of its second cycle, in seconds from its switching on."""
    part = slice(1950 + int(at_s.start), 1950 + int(at_s.stop))
    changed = {"opening": record.opening.copy(), "on": record.on.copy()}
    if opening is not None:
        changed["opening"][part] = opening
    if is_on is not None:
        changed["on"][part] = is_on
    return replace(record, **changed)


@pytest.mark.parametrize(
    ("change", "second", "third"),
    [
        ({"at_s": slice(0, 1900), "opening": 0.0}, "does not move", ""),
        ({"at_s": slice(160, 940), "opening": 0.89}, "does not open fully", ""),
        ({"at_s": slice(160, 940), "opening": 0.91}, "", ""),
        ({"at_s": slice(1000, 1950), "opening": 0.06}, "does not close fully", "not closed before"),
        ({"at_s": slice(1000, 1950), "opening": 0.04}, "", ""),
        ({"at_s": slice(220, 1950), "opening": 1.0}, "does not close fully", "not closed before"),
        ({"at_s": slice(0, 93), "is_on": False}, "a time is zero", ""),  # it rises before it is heated
        ({"at_s": slice(999, 1900), "is_on": True}, "a time is zero", ""),  # and is heated before it is closed
        ({"at_s": slice(1000, 1900), "is_on": True}, "", ""),  # or half a second later
    ],
)
def test_a_cycle_is_left_out_for_what_it_lacks_and_the_next_one_only_if_it_began_open(
    change: dict[str, Any], second: str, third: str
) -> None:
    whole = trapezoids(LENGTHS_S, 4, 1.0, 0.0, 1, start_s=50.0)
    assert cycles_of(of_second(whole, **change))["lost"].tolist() == ["", second, third, ""]


@pytest.mark.parametrize(("at_s", "lost"), [(-2, [0]), (-1, [0, 1]), (0, [1]), (1898, [1]), (1899, [1, 2])])
def test_a_gap_is_of_the_cycle_that_it_lies_in_and_at_a_switch_of_both(at_s: int, lost: list[int]) -> None:
    whole = trapezoids(LENGTHS_S, 4, 1.0, 0.0, 1, start_s=50.0)
    missing = np.arange(len(whole.missing)) == 1950 + at_s
    assert np.flatnonzero(cycles_of(replace(whole, missing=missing))["lost"] == "gap").tolist() == lost


def test_a_motor_that_moves_more_slowly_than_any_that_is_driven_does_not_open_or_close() -> None:
    for name, reason in (("rise_s", "does not open fully"), ("fall_s", "does not close fully")):
        slow = trapezoids({**LENGTHS_S, name: 700.0}, 4, 1.0, 0.0, 1)
        assert cycles_of(slow)["lost"].tolist()[:3] == [reason] * 3


def test_a_cycle_is_from_switching_on_to_switching_on_if_its_heating_ends() -> None:
    whole = trapezoids(LENGTHS_S, 4, 1.0, 0.0, 1, start_s=50.0)

    def cut(begin_s: int, end_s: int) -> pd.DataFrame:
        part = {name: getattr(whole, name)[begin_s:end_s] for name in ("on", "opening", "missing")}
        return cycles_of(replace(whole, **part))

    within_heating = cut(300, 5850 + 300)
    assert within_heating["on_at_s"].tolist() == [1649.5, 3549.5]  # nobody knows when the first heating began
    assert within_heating["undercool_s"].tolist() == pytest.approx([900.5, 900.5])  # the last is to the third one's
    within_fall = cut(0, 5750 + 900)
    assert within_fall["lost"].tolist() == ["", "", "", "cut off by the end"]


@pytest.mark.parametrize(("spoilt", "is_kept"), [(2, True), (3, False)])
def test_a_record_most_of_whose_cycles_are_lost_is_left_out_as_a_whole(spoilt: int, is_kept: bool) -> None:
    whole = trapezoids(LENGTHS_S, 4, 1.0, 0.0, 1, start_s=50.0)
    missing = np.isin(np.arange(len(whole.missing)), 100 + 1900 * np.arange(spoilt))
    lost = cycles_of(replace(whole, missing=missing))["lost"].tolist()
    assert lost == ["gap"] * spoilt + ["" if is_kept else "most others are lost"] * (4 - spoilt)


def test_a_span_has_the_first_begin_and_the_last_end_of_what_begins_in_it_or_five_seconds_before() -> None:
    moves = Movements(np.array([10.0, 50.0, 200.0]), np.array([20.0, 60.0, 230.0]))
    begin, end = within(
        moves, np.array([5.0, 100.0, 204.0, 206.0, 300.0]), np.array([90.0, 150.0, 290.0, 290.0, 400.0])
    )
    assert begin.tolist() == pytest.approx([10.0, np.nan, 200.0, np.nan, np.nan], nan_ok=True)
    assert end.tolist() == pytest.approx([60.0, np.nan, 230.0, np.nan, np.nan], nan_ok=True)
    for each in within(Movements(np.zeros(0), np.zeros(0)), np.zeros(2), np.ones(2)):
        assert np.isnan(each).tolist() == [True, True]


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
    wandering, steady = (trapezoids(LENGTHS_S, 364, 10.0, 0.0005, 1, each) for each in (drift, 0.0))
    cycles = cycles_of(wandering)
    assert (cycles["lost"] == "").sum() >= (cycles_of(steady)["lost"] == "").sum() - 2
    for name in TIMES:
        assert cycles[name].median() == pytest.approx(LENGTHS_S[name], abs=6.0), name
    assert "drifts" in " ".join(wandering.warnings)
    assert not steady.warnings


@pytest.mark.parametrize("interval_s", [0.5, 10.0])
def test_only_a_gap_in_a_fall_or_beside_it_hides_when_the_next_cycle_s_pause_began(interval_s: float) -> None:
    whole, to_fall = trapezoids(LENGTHS_S, 4, interval_s, 0.0, 1), ["off_at_s", "hold_s"]
    cycles = cycles_of(whole)
    assert np.isfinite(cycles["before_s"]).tolist() == [False, True, True, True]
    begin_s, end_s = (float(cycles[names].sum(axis=1)[1]) for names in (to_fall, [*to_fall, "fall_s"]))
    first, last = int((begin_s - 5.0) // interval_s), int(-((-end_s - 5.0) // interval_s))  # a slope is of five seconds
    hides, shows = (first, first + 9, last), (first - 1, last + 1, first - 30, last + 40)
    for place in (*hides, *shows):
        missing = np.arange(len(whole.missing)) == place
        known = np.isfinite(cycles_of(replace(whole, missing=missing))["before_s"])
        assert known.tolist() == [False, True, place in shows, True], place


def test_what_is_left_of_a_spike_is_no_movement_and_a_ramp_is() -> None:
    opening = np.interp(np.arange(1000.0), [700.0, 820.0], [0.0, 1.0])
    opening[[300, 500]] += 0.5
    opening[[600, 605]] += -0.2, 0.2  # and of two, five seconds apart
    found = movements(opening, 1.0, RISES_PER_5S)
    assert (found.begins_s, found.ends_s) == (pytest.approx([700.0]), pytest.approx([820.0]))
    at_once = movements(np.where(np.arange(1000) < 700, 0.0, 1.0), 1.0, RISES_PER_5S)
    assert (at_once.begins_s, at_once.ends_s) == (pytest.approx([699.5], abs=5.0), pytest.approx([699.5], abs=5.0))


def test_samples_faster_than_one_a_second_are_averaged_over_one() -> None:
    """Noise of 0.003 of the stroke then moves an edge by a third of a second; by more than half of one without that."""
    at_s = np.arange(0.0, 300.0, 0.2)
    true, random = np.interp(at_s, [100.0, 220.0], [0.0, 1.0]), np.random.default_rng(1)
    found = [movements(true + 0.003 * random.normal(size=len(at_s)), 0.2, RISES_PER_5S) for _ in range(30)]
    off_s = np.array([(*each.begins_s, *each.ends_s) for each in found]) - [100.0, 220.0]
    assert np.sqrt(np.mean(off_s**2)) < 0.35
