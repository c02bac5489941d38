"""Each effect of the chain does to its own block what its name says."""

from __future__ import annotations

import numpy as np
import pytest

from tests.effects.believed import CONTINUOUS, EFFECTS, IDEAL, MODULATED, REAL, Words, belief, output, with_effect
from waxstudy.plugin import Belief, FloatArray
from waxstudy_effects.actuator import longest_times
from waxstudy_effects.modulator import _period_s, _together

STEP_S = 5.0


def pulses(*lengths_s: float) -> FloatArray:
    """Off, on, off and so on, each for so long."""
    return np.concatenate([np.full(round(length / STEP_S), n % 2.0) for n, length in enumerate(lengths_s)])


def first_s(outputs: FloatArray, level: float, since_s: float) -> float:
    """Time from a moment until an output first reaches a level."""
    after = outputs[round(since_s / STEP_S) :]
    return STEP_S * (int(np.argmax(after >= level)) + 1)


def cycles(outputs: FloatArray) -> int:
    return int(np.sum(np.diff(outputs) > 0.5))


# --- sensor ------------------------------------------------------------------------------------------

RISING_C = 20.0 + 0.01 * np.arange(200)


@pytest.mark.parametrize("chain", [IDEAL, REAL, MODULATED])
def test_a_sensor_delay_is_the_whole_delay_whatever_sensor_was_believed(chain: Words) -> None:
    late = output(with_effect("sensor-delay", belief(chain), delay_s=300.0), "sensor", RISING_C)
    assert late[100:] == pytest.approx(RISING_C[40:-60])


def test_a_sensor_lag_comes_on_top_of_the_believed_delay() -> None:
    jump_C = np.concatenate((np.full(10, 20.0), np.full(500, 21.0)))
    lagging = with_effect("sensor-lag", belief(REAL), time_constant_s=600.0)
    reading_C = output(lagging, "sensor", jump_C)
    arrived = 10 + round(120.0 / STEP_S)
    assert (reading_C[:arrived] == 20.0).all()
    assert reading_C[arrived + round(600.0 / STEP_S) - 1] == pytest.approx(21.0 - np.exp(-1.0), abs=1e-9)


def test_a_positive_bias_makes_the_sensor_read_too_warm_also_after_a_lag() -> None:
    believed, off = belief(MODULATED), with_effect("sensor-bias", belief(MODULATED), bias_K=0.7)
    assert output(off, "sensor", RISING_C) - output(believed, "sensor", RISING_C) == pytest.approx(0.7)


def test_a_reading_stays_a_possible_reading_at_any_bias() -> None:
    off = with_effect("sensor-bias", belief(), bias_K=10.0)
    assert list(output(off, "sensor", [-100.0, 145.0, 150.0])) == [-90.0, 150.0, 150.0]


# --- controller and modulator --------------------------------------------------------------------------

ERROR_K = 0.8 * np.sin(np.arange(4000) / 100.0)


def test_a_wider_dead_band_switches_later() -> None:
    narrow, wide = (with_effect("dead-band", belief(), dead_band_K=width_K) for width_K in (0.2, 1.4))
    assert cycles(output(narrow, "controller", ERROR_K)) == cycles(output(wide, "controller", ERROR_K)) >= 5
    assert first_s(output(wide, "controller", ERROR_K), 1.0, 0.0) > first_s(
        output(narrow, "controller", ERROR_K), 1.0, 0.0
    )


def test_beyond_the_swing_of_the_error_a_dead_band_switches_never() -> None:
    assert not output(with_effect("dead-band", belief(), dead_band_K=1.7), "controller", ERROR_K).any()


def test_pi_tuning_multiplies_the_output_by_the_gain() -> None:
    weak, strong = (with_effect("pi-tuning", belief(CONTINUOUS), gain=gain, integration_time_s=1e5) for gain in (1, 4))
    error_K = np.full(10, 0.1)
    assert output(strong, "controller", error_K) == pytest.approx(4.0 * output(weak, "controller", error_K), rel=1e-6)


DAY_S = 86_400.0
STILL = np.zeros(round(DAY_S / STEP_S))  # a day in which the room is where it should be


def heats(of: Belief) -> list[float]:
    """Hours of a day at which an on-off controller heats a room that is where it should be."""
    on = output(of, "controller", STILL) > 0.0
    edges = np.flatnonzero(np.diff(on, prepend=False, append=False))
    return [float(each) for each in edges * STEP_S / 3600.0]


@pytest.mark.parametrize("chain", [IDEAL, MODULATED, CONTINUOUS])
def test_a_setpoint_offset_is_an_error_of_as_much_whatever_the_controller(chain: Words) -> None:
    warmer = with_effect("setpoint-offset", belief(chain), offset_K=0.4)
    assert output(warmer, "controller", ERROR_K) == pytest.approx(output(belief(chain), "controller", ERROR_K + 0.4))


def test_a_setpoint_offset_acts_between_its_hours_over_midnight_too() -> None:
    def between(from_h: float, to_h: float) -> Belief:
        return with_effect("setpoint-offset", belief(), offset_K=1.0, from_h=from_h, to_h=to_h)

    # an on-off controller stays as it was within its dead band: what heats goes on
    assert heats(between(5.0, 9.0))[0] == 5.0
    colder = [1.0 - hour for hour in heats(between(22.0, 6.0))[:1]]
    assert colder == [1.0]
    assert heats(between(0.0, 24.0)) == [0.0, 24.0]


def test_a_setback_on_top_of_a_dial_that_is_off_keeps_both() -> None:
    off = with_effect("setpoint-offset", belief(CONTINUOUS), offset_K=-0.3)
    both = with_effect("setpoint-offset", off, offset_K=-2.0, from_h=22.0, to_h=6.0)
    hour = np.arange(len(STILL)) * STEP_S / 3600.0
    error_K = 0.2 - 0.3 - np.where((hour >= 22.0) | (hour < 6.0), 2.0, 0.0)
    expected = output(belief(CONTINUOUS), "controller", error_K)
    assert output(both, "controller", STILL + 0.2) == pytest.approx(expected)
    assert output(with_effect("setpoint-offset", off, offset_K=0.3), "controller", ERROR_K) == pytest.approx(
        output(belief(CONTINUOUS), "controller", ERROR_K)
    )
    with pytest.raises(ValueError, match="between other hours already"):
        with_effect("setpoint-offset", both, offset_K=1.0, from_h=5.0, to_h=9.0)


def test_modulation_makes_pulses_of_the_same_mean() -> None:
    pulsed = with_effect("modulation", belief(CONTINUOUS), period_s=900.0, min_pulse_s=0.0)
    outputs = output(pulsed, "modulator", np.full(7200, 0.3))
    assert set(outputs) == {0.0, 1.0}
    assert outputs.mean() == pytest.approx(0.3, abs=0.003)
    assert cycles(outputs) == 7200 * STEP_S / 900.0 - 1


def test_a_pwm_period_is_the_time_from_pulse_to_pulse() -> None:
    pulsed = with_effect("pwm-period", belief(MODULATED), period_s=1200.0)
    assert cycles(output(pulsed, "modulator", np.full(7200, 0.5))) == 7200 * STEP_S / 1200.0 - 1


def test_a_min_pulse_leaves_out_what_is_shorter() -> None:
    patient = with_effect("min-pulse", belief(MODULATED), min_pulse_s=600.0)
    assert not output(patient, "modulator", np.full(3000, 0.16)).any()
    assert output(patient, "modulator", np.full(3000, 0.17)).any()


# --- actuator ------------------------------------------------------------------------------------------


def test_a_wax_motor_waits_and_then_opens_in_its_times() -> None:
    times = {"dead_time_s": 200.0, "rise_time_s": 100.0, "hold_time_s": 50.0, "fall_time_s": 80.0}
    opening = output(with_effect("wax-motor", belief(), **times), "actuator", pulses(600.0, 1200.0, 600.0))
    assert first_s(opening, 1e-9, 600.0) == 205.0
    assert first_s(opening, 1.0 - 1e-9, 600.0) == 300.0
    assert first_s(1.0 - opening, 1e-9, 1800.0) == 55.0
    assert first_s(1.0 - opening, 1.0 - 1e-9, 1800.0) == 130.0


def test_a_wax_motor_without_past_has_constant_times_and_with_all_of_it_those_of_table_2() -> None:
    signal = pulses(60.0, 1800.0, 300.0, 240.0, 900.0, 120.0, 600.0, 1800.0, 7200.0, 1800.0)
    times = {"dead_time_s": 200.0, "rise_time_s": 100.0, "hold_time_s": 50.0, "fall_time_s": 80.0}
    motors = {
        "constant-times": output(with_effect("constant-times", belief(REAL), **times), "actuator", signal),
        "variable-times": output(belief(REAL), "actuator", signal),  # product B
        "without": output(with_effect("wax-motor", belief(), **times), "actuator", signal),
        "with": output(with_effect("wax-motor", belief(), **longest_times("B"), past=1.0), "actuator", signal),
    }
    assert motors["without"] == pytest.approx(motors["constant-times"], abs=1e-9)
    assert motors["with"] == pytest.approx(motors["variable-times"], abs=1e-9)
    assert np.abs(motors["with"] - motors["without"]).max() > 0.5


@pytest.mark.parametrize(("past", "is_shorter"), [(0.0, False), (0.2, False), (0.8, True)])
def test_a_wax_motor_says_that_its_times_are_shorter_after_a_short_past(past: float, is_shorter: bool) -> None:
    motor = EFFECTS["wax-motor"]
    sentence = motor.sentence(motor.Parameters(**longest_times("B"), past=past))
    assert "232 s until it moves" in sentence
    assert ("the first three are shorter" in sentence) is is_shorter


def dead_times_s(name: str, chain: Words, **values: float) -> tuple[float, float]:
    """Dead time after a short pause, and after a long one."""
    signal = pulses(60.0, 1800.0, 900.0, 1800.0, 7200.0, 1800.0)
    opening = output(with_effect(name, belief(chain), **values), "actuator", signal)
    return first_s(opening, 1e-9, 2760.0), first_s(opening, 1e-9, 11760.0)


def test_constant_times_do_not_depend_on_the_pause_and_variable_times_do() -> None:
    short_s, long_s = dead_times_s("constant-times", REAL, dead_time_s=180.0)
    assert short_s == long_s == 185.0
    short_s, long_s = dead_times_s("variable-times", MODULATED)
    assert short_s < long_s - 60.0


@pytest.mark.parametrize("chain", [REAL, MODULATED, {**IDEAL, "actuator": {"use": "linear-ramp"}}])
def test_a_slow_actuator_takes_all_times_as_often_as_its_factor(chain: Words) -> None:
    usual, slow = belief(chain), with_effect("slow-actuator", belief(chain), factor=2.0)
    signal = pulses(60.0, 900.0, 500.0, 700.0)
    assert output(slow, "actuator", np.repeat(signal, 2), 10.0 / 2)[1::2] == pytest.approx(
        output(usual, "actuator", signal), abs=0.03
    )


def test_limited_travel_stops_the_opening_there() -> None:
    opening = output(with_effect("limited-travel", belief(REAL), opening=0.6), "actuator", pulses(60.0, 1800.0))
    assert opening.max() == 0.6


# --- valve ---------------------------------------------------------------------------------------------

OPENINGS = np.linspace(0.0, 1.0, 101)


def test_quick_opening_passes_more_than_a_linear_valve_once_it_opens() -> None:
    curve = {"h_min": 0.1, "h_mid": 0.4, "v_mid": 0.7, "authority": 0.5}
    quick = output(with_effect("quick-opening", belief(), **curve), "valve", OPENINGS)
    assert (quick[OPENINGS <= 0.1] == 0.0).all()
    assert (quick[30:100] > OPENINGS[30:100]).all()


def test_the_lower_the_authority_the_more_flows_half_open() -> None:
    flows = [
        output(with_effect("low-authority", belief(REAL), authority=authority), "valve", [0.4])[0]
        for authority in (1.0, 0.3, 0.05)
    ]
    assert flows == sorted(flows)


def test_a_let_by_of_0_015_passes_5_87_L_h_of_122_at_an_authority_of_0_097() -> None:
    closed = output(with_effect("let-by", belief(REAL), fraction=0.015), "valve", [0.0])
    assert closed[0] * 122.0 == pytest.approx(5.87, abs=0.005)


def test_without_an_authority_a_let_by_is_the_flow_fraction() -> None:
    flows = output(with_effect("let-by", belief(), fraction=0.02), "valve", OPENINGS)
    assert flows == pytest.approx(np.maximum(OPENINGS, 0.02))


def test_a_valve_that_sticks_open_passes_what_it_would_at_that_opening() -> None:
    usual = output(belief(REAL), "valve", OPENINGS)
    stuck = output(with_effect("stuck-open", belief(REAL), opening=0.3), "valve", OPENINGS)
    assert stuck == pytest.approx(np.maximum(usual, usual[30]))


# --- the period of a modulator ------------------------------------------------------------------------


def test_times_lie_together_as_the_sum_over_each_frequency_has_it() -> None:
    random = np.random.default_rng(3)
    times_s, often_Hz = np.sort(random.uniform(0.0, 1e6, 40)), np.arange(1e-4, 3e-3, 1.3e-6)
    alone = [abs(np.mean(np.exp(2j * np.pi * each * times_s))) for each in often_Hz]
    assert _together(times_s, often_Hz) == pytest.approx(alone, abs=1e-9)


@pytest.mark.parametrize("period_s", [612.5, 1800.0, 3607.0])
def test_a_period_is_found_of_which_many_have_no_switch(period_s: float) -> None:
    random = np.random.default_rng(4)
    starts = np.sort(random.choice(np.arange(14 * 86_400.0 / period_s), 100, replace=False)) * period_s
    found_s = _period_s(tuple((starts + random.uniform(-30.0, 30.0, 100)).tolist()))
    assert found_s == pytest.approx(period_s, rel=1e-4)
