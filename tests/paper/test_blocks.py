"""Claims about sensors, controllers, the modulator and valves."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from waxstudy.plugin.registry import installed
from waxstudy.simulation.records import plain_parameters
from waxstudy_paper.controllers import PI, OnOff
from waxstudy_paper.modulators import Pwm
from waxstudy_paper.sensors import DelaySensor, LagSensor
from waxstudy_paper.valves import LinearValve, QuickOpeningValve

BLOCKS = [
    (name, block)
    for (kind, name), entry in installed().components.items()
    if kind in ("sensor", "controller", "modulator", "actuator", "valve")
    for block in [entry.component]
]


def outputs(block, inputs, dt: float = 5.0, start_s: float = 0.0, **values) -> np.ndarray:
    p = plain_parameters(block.Parameters.model_validate(values))
    x = block.start(p, dt)
    return np.array([block.step(p, x, float(u), start_s + n * dt, dt) for n, u in enumerate(inputs)])


@pytest.mark.parametrize(("name", "block"), BLOCKS)
@given(data=st.data())
def test_every_block_keeps_its_output_range_for_any_input(name, block, data):
    low, high = block.input.low, block.input.high
    edge = st.sampled_from([low, high, 0.0, 0.5])
    inputs = data.draw(st.lists(st.floats(low, high) | edge, min_size=1, max_size=200))
    for values in block.examples.values():
        y = outputs(block, inputs, **values)
        assert np.all((y >= block.output.low) & (y <= block.output.high))


@given(st.lists(st.floats(-20, 40), min_size=30, max_size=60), st.integers(0, 20))
def test_the_delay_repeats_what_was_so_many_steps_before(inputs, n):
    y = outputs(DelaySensor, inputs, delay_s=5.0 * n)
    assert np.array_equal(y[n:], np.array(inputs)[: len(inputs) - n])
    assert np.all(y[:n] == inputs[0])


def test_the_lag_reaches_63_percent_after_its_time_constant():
    y = outputs(LagSensor, [0.0] + [1.0] * 100, time_constant_s=100.0)
    assert y[20] == pytest.approx(1.0 - math.exp(-1.0), rel=1e-12)


@given(st.floats(0.1, 4.0), st.lists(st.floats(-5, 5), min_size=1, max_size=100))
def test_on_off_switches_only_outside_its_dead_band(dead_band_K, errors):
    y = outputs(OnOff, errors, dead_band_K=dead_band_K)
    assert np.all(y[np.array(errors) > dead_band_K / 2] == 1.0)
    assert np.all(y[np.array(errors) < -dead_band_K / 2] == 0.0)
    inside = np.abs(errors) < dead_band_K / 2
    assert np.array_equal(y[1:][inside[1:]], y[:-1][inside[1:]])


@given(st.floats(0.1, 50.0), st.floats(60.0, 5000.0), st.lists(st.floats(-3, 3), min_size=2, max_size=300))
def test_pi_answers_monotonically_to_a_larger_error(gain, time_s, errors):
    values = {"gain": gain, "integration_time_s": time_s, "tracking_time_s": 30.0}
    smaller = outputs(PI, errors, **values)
    larger = outputs(PI, np.array(errors) + 0.1, **values)
    assert np.all(larger >= smaller - 1e-9)


def test_pi_does_not_wind_up():
    """After a day at full output it leaves the limit within some tracking times, not after hours."""
    errors = np.concatenate([np.full(17280, 2.0), np.full(720, -0.1)])
    y = outputs(PI, errors, gain=18.0, integration_time_s=2300.0, tracking_time_s=30.0)
    assert np.all(y[100:17280] == 1.0)
    assert y[17280 + 60] < 0.5


def test_pi_integrates_a_small_error_with_its_integration_time():
    y = outputs(PI, np.full(61, 0.1), gain=0.3, integration_time_s=300.0, tracking_time_s=30.0)
    assert y[60] - y[0] == pytest.approx(0.03 * 300.0 / 300.0, rel=1e-9)


@given(st.floats(0.0, 1.0), st.sampled_from([0.0, 300.0]))
def test_pwm_heats_for_the_output_share_of_each_hour(level, min_pulse_s):
    y = outputs(Pwm, np.full(1440, level), period_s=3600.0, min_pulse_s=min_pulse_s)
    assert set(y) <= {0.0, 1.0}
    for hour in (y[:720], y[720:]):
        on_s = 5.0 * hour.sum()
        if level * 3600 < min_pulse_s:
            assert on_s == 0.0
        elif level * 3600 > 3600 - min_pulse_s:
            assert on_s == 3600.0
        else:
            assert on_s == pytest.approx(level * 3600, abs=2.5 + 1e-6)
            assert np.all(np.diff(hour) <= 0.0)  # one pulse, from the hour's start


def test_pwm_decides_once_an_hour_and_on_the_hour():
    level = np.concatenate([np.full(360, 0.5), np.full(360, 1.0), np.full(720, 1.0)])
    y = outputs(Pwm, level, start_s=-7200.0)
    assert y[:360].all()
    assert not y[360:720].any()
    assert y[720:].all()


@given(st.floats(0, 1), st.floats(0, 1))
def test_valves_never_give_less_flow_for_more_opening(a, b):
    low, high = sorted((a, b))
    for valve in (LinearValve, QuickOpeningValve):
        less, more = outputs(valve, [low, high])
        assert 0.0 <= less <= more <= 1.0


def test_the_valve_follows_the_authority_equation_of_the_paper():
    h, n = 0.3, 2.9 / 30.0
    theoretical = 0.5 * (h - 0.17) / (0.41 - 0.17)
    expected = math.sqrt((1 / n) / (1 / n - 1 + 1 / theoretical**2))
    assert outputs(QuickOpeningValve, [h])[0] == pytest.approx(expected, rel=1e-12)


def test_the_valve_is_closed_up_to_h_min_and_nearly_open_at_the_half():
    assert outputs(QuickOpeningValve, [0.0, 0.17, 1.0]).tolist() == [0.0, 0.0, 1.0]
    assert outputs(QuickOpeningValve, [0.5])[0] > 0.9


def test_full_authority_leaves_the_theoretical_curve():
    y = outputs(QuickOpeningValve, [0.29, 0.41, 0.705], authority=1.0)
    assert y == pytest.approx([0.25, 0.5, 0.75])
