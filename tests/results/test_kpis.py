"""Claims about key figures, on traces whose answer is known."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from waxstudy.results.kpis import (
    HEAT_OF_MONTH,
    IN_CATEGORY,
    TRACE_CHANNELS,
    Figures,
    MemberWeek,
    Valve,
    count_cycles,
    key_figures,
    thinned,
)

STEPS = 17280 * 7


def week(**channels: np.ndarray) -> MemberWeek:
    """A week of constant 21 C without heat, but for the given channels."""
    constant = {name: np.zeros(STEPS) for name in TRACE_CHANNELS} | {
        name: np.full(STEPS, 21.0) for name in TRACE_CHANNELS if name.endswith("_C")
    }
    return MemberWeek(constant | channels, 5.0, 21.0, 120.0, 21.0, 21.0)


def test_heat_of_a_constant_flow_is_its_power_times_a_week() -> None:
    figures = key_figures(week(water_heat_W_m2=np.full(STEPS, 15.0)))
    assert figures["heat_kWh_m2_week"] == pytest.approx(15.0 * 168 / 1000)


def test_hours_below_count_only_what_is_strictly_below() -> None:
    operative = np.full(STEPS, 21.0)
    operative[: 720 * 10] = 20.999
    assert key_figures(week(operative_C=operative))["hours_below_per_week"] == pytest.approx(10.0)


def test_mae_is_against_the_shifted_setpoint() -> None:
    shifted = MemberWeek(week().channels, 5.0, 20.9, 120.0, 21.0, 21.0)
    assert key_figures(shifted)["mae_K"] == pytest.approx(0.1)


@pytest.mark.parametrize("shift_K", [-0.5, 0.5])
def test_warm_hours_are_over_the_setpoint_that_people_asked_for_not_the_shifted_one(shift_K: float) -> None:
    """With the shifted one 21.8 C would be too warm where the shift is -0.5 K, and 22.2 C not where it is 0.5 K."""
    for operative_C, share in ((21.8, 0.0), (22.2, 1.0), (22.0, 0.0)):
        channels = week(operative_C=np.full(STEPS, operative_C)).channels
        figures = key_figures(MemberWeek(channels, 5.0, 21.0 + shift_K, 120.0, 21.0, 21.0))
        assert figures["over_setpoint_1K_share"] == share


@pytest.mark.parametrize(("steps", "too_slow"), [(59, 0.0), (60, 0.0), (61, 1.0)])
def test_a_start_is_too_slow_beyond_the_reserve_market_s_limit_and_not_at_it(steps: int, too_slow: float) -> None:
    signal, opening = np.zeros(STEPS), np.zeros(STEPS)
    signal[100:1000] = 1.0
    opening[100 + steps - 1 : 1000] = 1.0
    figures = key_figures(week(signal=signal, opening=opening))
    assert (figures["starts"], figures["starts_over_300_s"]) == (1.0, too_slow)


def test_a_flow_that_trembles_in_the_middle_is_no_cycle() -> None:
    assert count_cycles(np.array([0.0, 0.6, 0.4, 0.6, 0.4, 1.0])) == 1
    assert count_cycles(np.array([0.0, 1.0, 0.05, 1.0, 0.0])) == 2
    assert count_cycles(np.full(5, 0.3)) == 0


def opening_times_s(signal: np.ndarray, opening: np.ndarray) -> np.ndarray:
    valve = Valve()
    valve.add(signal, opening)
    return valve.opening_times_s(5.0)


def test_opening_times_run_from_the_signal_to_full_opening() -> None:
    signal = np.array([0, 1, 1, 1, 1, 0, 0, 0, 1, 1, 0, 0, 1, 1, 1.0])
    opening = np.array([0, 0, 0.5, 1, 1, 1, 0.5, 0, 0, 0.5, 0.2, 0, 0, 1, 1.0])
    # the second start ends before the valve is open, and does not count
    assert opening_times_s(signal, opening).tolist() == [15.0, 10.0]
    assert opening_times_s(np.full(4, 0.5), np.ones(4)).tolist() == []


def test_a_start_right_after_a_part_of_one_step_counts() -> None:
    valve = Valve()
    valve.add(np.zeros(1), np.zeros(1))
    valve.add(np.ones(3), np.array([0.0, 0.5, 1.0]))
    assert valve.opening_times_s(5.0).tolist() == [15.0]


def test_flow_counts_as_a_share_of_the_full_flow() -> None:
    """At a twentieth the valve is open, and yet the flow is low: what follows at full flow is a cycle."""
    flow = np.full(STEPS, 6.0)
    flow[720:1440] = 120.0
    figures = key_figures(week(flow_L_h=flow))
    assert (figures["cycles_per_week"], figures["valve_open_h"]) == (1.0, 168.0)


def test_durations_are_percentiles_and_the_return_counts_only_with_flow() -> None:
    flow = np.zeros(STEPS)
    flow[: STEPS // 2] = 60.0
    back = np.where(flow > 0, 25.0, 99.0)
    figures = Figures()
    figures.add(week(flow_L_h=flow, return_C=back))
    table = figures.durations()
    assert len(table) == 101
    assert table["return_C"].max() == 25.0
    assert table["flow_L_h"].iloc[[0, 100]].tolist() == [0.0, 60.0]
    assert table["flow_L_h"].is_monotonic_increasing


def test_thinned_traces_keep_means_of_flows_and_last_values_of_temperatures() -> None:
    ramp = np.arange(STEPS, dtype=float)
    table = thinned(week(air_C=ramp, flow_L_h=ramp), 60.0, "2023-01-22")
    assert table["time_s"].iloc[[0, -1]].tolist() == [60.0, 604800.0]
    assert table["time"].iloc[[0, -1]].tolist() == [pd.Timestamp("2023-01-22T00:01"), pd.Timestamp("2023-01-29")]
    assert table["air_C"].iloc[0] == 11.0
    assert table["flow_L_h"].iloc[0] == 5.5


@given(cuts=st.lists(st.integers(1, 599), max_size=5, unique=True), seed=st.integers(0, 2**32 - 1))
def test_a_record_in_parts_has_the_key_figures_of_the_whole(cuts: list[int], seed: int) -> None:
    random = np.random.default_rng(seed)
    on = np.repeat(random.integers(0, 2, 60), 10).astype(float)
    opening = np.clip(np.convolve(on, np.full(5, 0.2))[:600], 0.0, 1.0).round(6)
    channels = {name: random.normal(21.0, 1.0, 600) for name in TRACE_CHANNELS}
    channels |= {"signal": on, "opening": opening, "flow_L_h": 120.0 * opening}

    def part(first: int, last: int) -> MemberWeek:
        return MemberWeek({n: c[first:last] for n, c in channels.items()}, 7.5, 20.9, 120.0, 21.0, 21.0)

    whole, parts = Figures(), Figures()
    whole.add(part(0, 600))
    edges = [0, *sorted(cuts), 600]
    for first, last in pairwise(edges):
        parts.add(part(first, last))
    one, other = whole.key_figures(), parts.key_figures()
    assert other == pytest.approx(one, rel=1e-12, nan_ok=True)
    assert one["starts"] > 0
    assert parts.durations().equals(whole.durations())


def test_a_trace_in_parts_is_the_trace_of_the_whole() -> None:
    ramp = np.arange(STEPS, dtype=float)
    whole = week(air_C=ramp, flow_L_h=ramp)
    half = [
        replace(whole, channels={n: c[at] for n, c in whole.channels.items()})
        for at in (slice(0, 6000), slice(6000, None))
    ]
    first = thinned(half[0], 60.0, "2023-01-22")
    both = pd.concat([first, thinned(half[1], 60.0, "2023-01-22", len(first))], ignore_index=True)
    assert both.equals(thinned(whole, 60.0, "2023-01-22"))


def test_a_mean_temperature_is_over_all_steps() -> None:
    ramp = np.linspace(20.0, 22.0, STEPS)
    figures = key_figures(week(operative_C=ramp, air_C=ramp + 1.0))
    assert (figures["operative_mean_C"], figures["air_mean_C"]) == pytest.approx((21.0, 22.0))


def test_heat_of_each_month_adds_up_to_that_of_all() -> None:
    months = {"1": slice(0, STEPS // 4), "2": slice(STEPS // 4, None)}
    figures = key_figures(replace(week(water_heat_W_m2=np.full(STEPS, 15.0)), months=months))
    heat = [figures[HEAT_OF_MONTH.format(month=month)] for month in months]
    assert heat == pytest.approx([15.0 * 42 / 1000, 15.0 * 126 / 1000])


def test_a_season_tells_the_days_that_count_and_their_share_in_each_category() -> None:
    counts = np.arange(STEPS) < 3 * STEPS // 7
    figures = key_figures(replace(week(operative_C=np.where(counts, 21.0, 10.0)), counts=counts))
    assert figures["counted_days"] == pytest.approx(3.0)
    assert {figures[name] for name in IN_CATEGORY.values()} == {1.0}


def test_the_highest_temperature_may_be_below_zero() -> None:
    assert key_figures(week(operative_C=np.full(STEPS, -3.0)))["operative_max_C"] == -3.0


def test_durations_take_a_sample_about_every_minute() -> None:
    values = np.arange(STEPS) % 2  # of steps of 40 s every other one: 60 s are 1.5 of them
    figures = Figures()
    figures.add(replace(week(air_C=values.astype(float)), step_s=40.0))
    assert figures.durations()["air_C"].max() == 0.0
