"""Claims about linearised loops: blocks are asked, and what they answer is what theory says of them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from waxstudy.conformance.declaration import documentation
from waxstudy.conformance.stage import Subject
from waxstudy.loop.response import Emitter, NotLinear, Response, controller_response, sensor_response
from waxstudy.plugin import Choice, Controller, Parameters, Tunable, parameter
from waxstudy.plugin.registry import installed

STEP_S = 5.0
PERIOD_S = np.array([1800.0, 5400.0, 14400.0])  # of swings, in the range of rooms
OMEGA = 2.0 * np.pi / PERIOD_S
Z = np.exp(1j * OMEGA * STEP_S)


def block(kind: str, name: str, **values: float) -> Choice:
    given: Mapping[str, float] = values
    return Choice.of(installed().get(kind, name), given)


def flow(fraction: np.ndarray) -> np.ndarray:
    return fraction


def test_a_pi_controller_answers_as_its_equation_says() -> None:
    pi = block("controller", "pi", gain=2.0, integration_time_s=3000.0)
    expected = 2.0 * (1.0 + STEP_S / 3000.0 / Z / (1.0 - 1.0 / Z))
    assert controller_response(pi, 0.3, STEP_S).at(Z) == pytest.approx(expected, rel=1e-6)


def test_a_delay_turns_the_phase_and_keeps_the_size() -> None:
    found = sensor_response(block("sensor", "delay", delay_s=120.0), STEP_S).at(Z)
    assert found == pytest.approx(np.exp(-1j * OMEGA * 120.0), rel=1e-6)


def test_a_lag_is_a_lag() -> None:
    found = sensor_response(block("sensor", "lag", time_constant_s=600.0), STEP_S).at(Z)
    keeps = np.exp(-STEP_S / 600.0)
    assert found == pytest.approx((1.0 - keeps) / (1.0 - keeps / Z), rel=1e-6)


def test_pulses_answer_after_their_duty_of_the_period() -> None:
    """A pulse begins with its period and ends after its duty: there it grows, and that is a delay of so much."""
    emitter = Emitter([block("modulator", "pwm", min_pulse_s=0.0)], 3600.0, STEP_S, flow)
    found = emitter.emission(0.25)
    assert found.output == pytest.approx(0.25, abs=2e-3)
    slow = found.response.at(Z[1:])
    assert np.abs(slow) == pytest.approx(1.0, abs=0.03)
    assert -np.angle(slow) / OMEGA[1:] == pytest.approx(0.25 * 3600.0, abs=60.0)


def test_what_switches_has_no_linear_form() -> None:
    with pytest.raises(NotLinear, match="'on-off'"):
        controller_response(block("controller", "on-off"), 0.3, STEP_S)
    with pytest.raises(NotLinear, match="switched signal"):
        Emitter([block("actuator", "variable-times")], 0.0, STEP_S, flow).emission(0.3)


def test_a_response_ends_in_its_slope() -> None:
    ramp = Response(np.arange(10.0), slope=1.0).at(Z)
    assert ramp == pytest.approx(1.0 / Z / (1.0 - 1.0 / Z), rel=1e-9)


class GainParameters(Parameters):
    gain: float = parameter(1.0, unit="1/K", ge=0.0, le=9.0, description="Gain.", source="chosen for a test")


def test_a_plugin_that_tunes_what_it_has_not_is_told() -> None:
    class Wrong(Controller):
        name = "wrong"
        Parameters = GainParameters
        gain = "gian"
        tuned = {"gain": Tunable(0.0, 5.0, is_log=True)}

    first, second = documentation(Subject(Wrong, {}))
    assert (
        first == "gian is said to be tuned, or set by rules: it is no parameter that is a float; did you mean 'gain'?"
    )
    assert second.startswith("gain is tuned from 0 to 5: low < high is needed")
