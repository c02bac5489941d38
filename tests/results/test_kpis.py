"""Claims about key figures, on traces whose answer is known."""

from __future__ import annotations

import numpy as np
import pytest

from waxstudy.results.kpis import (
    TRACE_CHANNELS,
    MemberWeek,
    count_cycles,
    durations,
    key_figures,
    opening_times_s,
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


def test_overheating_is_against_the_setpoint_before_the_shift() -> None:
    operative = np.full(STEPS, 21.5)  # over the shifted setpoint by more than a kelvin
    operative[: STEPS // 7] = 22.5
    operative[STEPS // 7 : STEPS // 2] = 22.0  # a kelvin, and not over it
    shifted = MemberWeek(week(operative_C=operative).channels, 5.0, 20.0, 120.0, 21.0, 21.0)
    assert key_figures(shifted)["over_setpoint_1K_share"] == pytest.approx(1.0 / 7.0)


def test_a_start_of_exactly_300_s_is_not_over_300_s() -> None:
    signal, opening = np.zeros(STEPS), np.zeros(STEPS)
    for begin, steps in ((100, 60), (1100, 61), (2100, 59)):  # of 5 s each
        signal[begin : begin + 200] = 1.0
        opening[begin + steps - 1 : begin + 200] = 1.0
    assert opening_times_s(signal, opening, 5.0).tolist() == [300.0, 305.0, 295.0]
    figures = key_figures(week(signal=signal, opening=opening))
    assert (figures["starts"], figures["starts_over_300_s"]) == (3.0, 1.0)


def test_a_flow_that_trembles_in_the_middle_is_no_cycle() -> None:
    assert count_cycles(np.array([0.0, 0.6, 0.4, 0.6, 0.4, 1.0])) == 1
    assert count_cycles(np.array([0.0, 1.0, 0.05, 1.0, 0.0])) == 2
    assert count_cycles(np.full(5, 0.3)) == 0


def test_opening_times_run_from_the_signal_to_full_opening() -> None:
    signal = np.array([0, 1, 1, 1, 1, 0, 0, 0, 1, 1, 0, 0, 1, 1, 1.0])
    opening = np.array([0, 0, 0.5, 1, 1, 1, 0.5, 0, 0, 0.5, 0.2, 0, 0, 1, 1.0])
    # the second start ends before the valve is open, and does not count
    assert opening_times_s(signal, opening, 5.0).tolist() == [15.0, 10.0]
    assert opening_times_s(np.full(4, 0.5), np.ones(4), 5.0).tolist() == []


def test_durations_are_percentiles_and_the_return_counts_only_with_flow() -> None:
    flow = np.zeros(STEPS)
    flow[: STEPS // 2] = 60.0
    back = np.where(flow > 0, 25.0, 99.0)
    table = durations(week(flow_L_h=flow, return_C=back))
    assert len(table) == 101
    assert table["return_C"].max() == 25.0
    assert table["flow_L_h"].iloc[[0, 100]].tolist() == [0.0, 60.0]
    assert table["flow_L_h"].is_monotonic_increasing


def test_thinned_traces_keep_means_of_flows_and_last_values_of_temperatures() -> None:
    ramp = np.arange(STEPS, dtype=float)
    table = thinned(week(air_C=ramp, flow_L_h=ramp), 60.0, "2023-01-22")
    assert table["time_s"].iloc[[0, -1]].tolist() == [60.0, 604800.0]
    assert table["air_C"].iloc[0] == 11.0
    assert table["flow_L_h"].iloc[0] == 5.5
