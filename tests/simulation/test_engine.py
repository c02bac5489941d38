"""Claims about the loop: compiled equals interpreted, errors are named, and energy is conserved."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from waxstudy.plugin import ROOM_OUTPUTS, Actuator, Controller, FloatArray, Parameters, SimulationError, Valve
from waxstudy.plugin.registry import PluginError, installed
from waxstudy.simulation import kernel
from waxstudy.simulation.chain import Chain
from waxstudy.simulation.engine import START, Loop, Start
from waxstudy.simulation.modes import DrivenRoom, Fewer, drive, few_modes, main_modes
from waxstudy.study.model import Choice
from waxstudy_paper import actuators, controllers, modulators, sensors, valves
from waxstudy_paper.room import NzebRoom
from waxstudy_paper.weather import TallinnWeek

STEP_S = 5.0


def choice(block: Any, **values: Any) -> Choice:
    return Choice(block, block.Parameters.model_validate(values))


ON_OFF = {
    "sensor": choice(sensors.DelaySensor),
    "controller": choice(controllers.OnOff, dead_band_K=0.5),
    "actuator": choice(actuators.VariableTimes),
    "valve": choice(valves.QuickOpeningValve),
}
CHAINS = {
    "O_0": {"controller": choice(controllers.OnOff), "valve": choice(valves.LinearValve)},
    "O_WM": ON_OFF,
    "O_lag": {**ON_OFF, "sensor": choice(sensors.LagSensor), "actuator": choice(actuators.ConstantTimes)},
    "O_literal": {**ON_OFF, "actuator": choice(actuators.VariableTimes, form="literal")},
    "P_0": {"controller": choice(controllers.PI), "valve": choice(valves.LinearValve)},
    "P_WM": {
        **ON_OFF,
        "controller": choice(controllers.PI, gain=18.0, integration_time_s=2300.0),
        "modulator": choice(modulators.Pwm),
    },
}


@pytest.fixture(scope="module")
def room() -> DrivenRoom:
    built = NzebRoom.build(NzebRoom.Parameters())
    weather = TallinnWeek.load(TallinnWeek.Parameters(month="february"), built.facades)
    return drive(built, weather, STEP_S)


def hours(loop: Loop, n: int, setpoint_C: float = 21.0) -> FloatArray:
    """The trace of the first hours from a room at its setpoint."""
    return loop.advance(loop.start(setpoint_C), np.arange(n), 0.0, setpoint_C, trace=True)[1]


@pytest.mark.parametrize("name", CHAINS)
def test_compiled_and_interpreted_runs_are_equal_to_the_bit(name: str, room: DrivenRoom) -> None:
    chain = Chain(CHAINS[name], STEP_S)
    compiled, interpreted = (hours(Loop(chain, room, 21.0, jit=jit), 72) for jit in (True, False))
    assert np.array_equal(compiled, interpreted)
    assert np.ptp(compiled[:, kernel.TRACE.index("flow_fraction")]) > 0.1


def test_a_whole_week_with_warm_up_is_equal_to_the_bit(room: DrivenRoom) -> None:
    chain = Chain(CHAINS["P_WM"], STEP_S)
    starts = [Start(0.3, -0.5), Start(0.0, 0.0)]
    both = [list(Loop(chain, room, 21.0, jit=jit).weeks(20.95, starts, trace=True)) for jit in (True, False)]
    for compiled, interpreted in zip(*both, strict=True):
        assert compiled.hours_below == interpreted.hours_below
        assert np.array_equal(compiled.trace, interpreted.trace)


def test_a_run_in_two_parts_is_the_run_in_one(room: DrivenRoom) -> None:
    loop = Loop(Chain(CHAINS["P_WM"], STEP_S), room, 21.0)
    whole = hours(loop, 48)
    state = loop.start(21.0)
    first = loop.advance(state, np.arange(20), 0.0, 21.0, trace=True)[1]
    second = loop.advance(state, np.arange(20, 48), 20 * 3600.0, 21.0, trace=True)[1]
    assert np.array_equal(whole, np.vstack((first, second)))


class Proportional(Controller):
    """Opens by 2 per kelvin around the half."""

    name = "proportional"

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        return min(1.0, max(0.0, 0.5 + 2.0 * u))


class Short(Actuator):
    """Moves nine tenths of its way, and in the second half hour eight."""

    name = "short"

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        return (0.9 if t < 1800.0 else 0.8) * u


class Square(Valve):
    """Lets the square of its opening through."""

    name = "square"

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        return u * u


def test_the_loop_is_the_equations_of_its_room_and_blocks(room: DrivenRoom) -> None:
    """Written a second time, in matrices: what acts on the room within a step is what its start was read as."""
    limit_C, setpoint_C, n = 21.2, 21.05, 3
    chain = Chain({kind.kind: choice(kind) for kind in (Proportional, Short, Square)}, STEP_S)
    loop = Loop(chain, room, limit_C, jit=False)
    state = loop.start(21.0)
    modes, (sensed, layer, _) = state.modes.copy(), state.readings
    table, expected = room.conductance_W_K, []
    for step in range(n * room.steps_per_interval):
        at = step // room.steps_per_interval
        output = min(1.0, max(0.0, 0.5 + 2.0 * (setpoint_C - sensed)))
        opening = (0.9 if step * STEP_S < 1800.0 else 0.8) * output
        per_K = np.interp(opening**2 * (len(table) - 1), np.arange(len(table)), table)
        heat = per_K * (room.supply_C[at] - layer)
        modes = room.decay * modes + room.forcing[at] + room.heat_gain * heat
        sensed, layer, operative, air, surface, floor = (
            room.outputs @ modes + room.offsets[at] + room.heat_offset * heat
        )
        expected.append([air, operative, surface, layer, floor, output, output, opening, opening**2, heat])
    cold, trace = loop.advance(state, np.arange(n), 0.0, setpoint_C, trace=True)
    np.testing.assert_allclose(trace, expected, rtol=1e-9)
    operative_C = np.array(expected)[:, 1]
    assert cold == np.sum(operative_C < limit_C)
    assert 0 < cold < len(operative_C)
    np.testing.assert_allclose(state.readings, [sensed, layer, operative], rtol=1e-9)


@pytest.mark.parametrize(("fewer", "share"), [(few_modes, 0.5), (main_modes, 0.8)])
def test_fewer_modes_stay_within_their_stated_error(room: DrivenRoom, fewer: Fewer, share: float) -> None:
    """Open loop: pulses of floor heat and the week's weather, all of the room's modes against fewer."""
    full = drive(room.room, room.weather, STEP_S, tolerance_K=0.0)
    some = drive(room.room, room.weather, STEP_S, fewer=fewer)
    pulses_W = np.where(np.arange(168) % 8 < 2, 700.0, 0.0)
    found, all_of_them = (_open_loop(d, pulses_W) for d in (some, full))
    assert len(some.decay) < share * len(full.decay)
    assert np.max(np.abs(found - all_of_them)) < some.dropped_error_K


def test_steady_states_are_those_of_the_full_room(room: DrivenRoom) -> None:
    full = drive(room.room, room.weather, STEP_S, tolerance_K=0.0)
    few, whole = ((d.outputs * d.heat_gain / (1.0 - d.decay)).sum(axis=1) + d.heat_offset for d in (room, full))
    assert few == pytest.approx(whole, rel=1e-9)
    held, all_of_them = (d.offsets + (d.forcing / (1.0 - d.decay)) @ d.outputs.T for d in (room, full))
    assert held == pytest.approx(all_of_them, rel=1e-9, abs=1e-8)


def _open_loop(driven: DrivenRoom, heat_W: FloatArray) -> FloatArray:
    """Temperatures (steps, 5) under a given heat, from the discretised modes alone."""
    modes, rows = driven.to_modes @ np.full(driven.to_modes.shape[1], 21.0), []
    for interval, heat in enumerate(heat_W):
        for _ in range(driven.steps_per_interval):
            modes = driven.decay * modes + driven.heat_gain * heat + driven.forcing[interval]
            rows.append((driven.outputs @ modes + driven.offsets[interval] + driven.heat_offset * heat)[:5])
    return np.array(rows[5 * 720 :])  # the start at one temperature excites modes that no weather does


def test_heat_of_the_water_is_stored_or_lost(room: DrivenRoom) -> None:
    """Energy balance over a week: water, gains, sun and ventilation against losses and storage, to 0.1 %.

    Losses are integrated from the node temperatures by trapezia of five minutes, independent of the model's own sums.
    """
    linear, interval_s = room.room, 300.0
    weather = TallinnWeek.load(TallinnWeek.Parameters(month="february", interval_s=interval_s), linear.facades)
    full = drive(linear, weather, STEP_S, tolerance_K=0.0)
    loop, to_nodes = Loop(Chain(CHAINS["O_WM"], STEP_S), full, 21.0), np.linalg.pinv(full.to_modes)
    state = loop.start(21.0)
    loop.advance(state, np.arange(288), -86400.0, 21.0)  # a day, so that nodes move slowly
    nodes, water_J = [to_nodes @ state.modes], 0.0
    for interval in range(len(weather.outdoor_C)):
        trace = loop.advance(state, np.array([interval]), interval * interval_s, 21.0, trace=True)[1]
        water_J += trace[:, kernel.TRACE.index("water_heat_W")].sum() * STEP_S
        nodes.append(to_nodes @ state.modes)
    temperatures = np.array(nodes)
    means = (temperatures[1:] + temperatures[:-1]) / 2.0
    lost_J = float(np.sum(means @ linear.conductance_W_K)) * interval_s
    supplied_J = float(np.sum(linear.drive(weather)[0] @ linear.input_matrix.T)) * interval_s + water_J
    stored_J = float(linear.capacity_J_K @ (temperatures[-1] - temperatures[0]))
    assert water_J > 50e6
    assert supplied_J == pytest.approx(lost_J + stored_J, rel=1e-3)


def test_halving_the_step_changes_a_day_of_temperatures_by_millikelvins(room: DrivenRoom) -> None:
    fine = drive(room.room, room.weather, STEP_S / 5.0)
    coarse = hours(Loop(Chain(CHAINS["P_0"], STEP_S), room, 21.0), 24)[:, 0]
    finer = hours(Loop(Chain(CHAINS["P_0"], STEP_S / 5.0), fine, 21.0), 24)[4::5, 0]
    assert np.max(np.abs(coarse - finer)) < 0.03


# --- blocks that fail ------------------------------------------------------------------------------------


@dataclass
class Counter:
    steps: int = 0


class Failing(Actuator):
    """Divides by zero after an hour."""

    name = "failing"
    State = Counter

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        x.steps += 1
        return 1.0 / (720 - x.steps) * 0.0 + u


class Growing(Actuator):
    """Leaves its range after an hour."""

    name = "growing"
    State = Counter

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        x.steps += 1
        return x.steps / 720.0


class NotANumber(Actuator):
    """Overflows to infinity, then to NaN."""

    name = "not-a-number"

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        return math.inf - math.inf if t > -600000.0 else u


class Misspelled(Actuator):
    """Reads a state that it does not have."""

    name = "misspelled"
    State = Counter
    Parameters = Parameters

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        return float(x.stepps)


@pytest.mark.parametrize("jit", [True, False])
@pytest.mark.parametrize(
    ("block", "words"),
    [
        (Failing, ["actuator 'failing' failed", "ZeroDivisionError", "test_engine.py", "state then: steps = 720"]),
        (Growing, ["actuator 'growing' failed", "it returned 1.00139, not a level from 0 to 1", "test_engine.py"]),
        (NotANumber, ["actuator 'not-a-number' failed", "it returned nan"]),
    ],
)
def test_a_failing_block_is_named_with_its_time(block: Any, words: list[str], jit: bool, room: DrivenRoom) -> None:
    loop = Loop(Chain({**ON_OFF, "actuator": choice(block)}, STEP_S), room, 21.0, jit=jit)
    with pytest.raises(SimulationError) as caught:
        list(loop.weeks(21.0, [Start(0.0, 0.0)]))
    for word in [*words, "warm-up"]:
        assert word in str(caught.value)


class Open(Actuator):
    """Opens up to a limit that may be left out."""

    name = "open"

    class Parameters(Parameters):
        limit: float | None = None

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        return min(u, p.limit) if p.limit == p.limit else u


@pytest.mark.parametrize(("given", "opening"), [({}, 1.0), ({"limit": 0.4}, 0.4)])
@pytest.mark.parametrize("jit", [True, False])
def test_an_optional_number_that_is_not_given_arrives_as_nan(
    given: dict[str, float], opening: float, jit: bool, room: DrivenRoom
) -> None:
    loop = Loop(Chain({**ON_OFF, "actuator": choice(Open, **given)}, STEP_S), room, 21.0, jit=jit)
    assert hours(loop, 24)[:, kernel.TRACE.index("opening")].max() == opening


class Silent(Actuator):
    """Forgets to return an opening when it is closed."""

    name = "silent"

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:  # type: ignore[return]
        if u > 0.5:
            return 1.0


@pytest.mark.parametrize("jit", [True, False])
def test_a_path_without_a_return_is_named(jit: bool, room: DrivenRoom) -> None:
    with pytest.raises((PluginError, SimulationError), match=r"actuator 'silent'.*return"):
        list(Loop(Chain({**ON_OFF, "actuator": choice(Silent)}, STEP_S), room, 21.0, jit=jit).weeks(21.0, [START]))


def test_a_misspelled_state_field_is_named_with_the_nearest(room: DrivenRoom) -> None:
    chain = Chain({**ON_OFF, "actuator": choice(Misspelled)}, STEP_S)
    with pytest.raises(PluginError, match=r"'misspelled': .* no field 'stepps'; did you mean 'steps'\?"):
        Loop(chain, room, 21.0)


def test_weather_that_is_not_a_number_ends_the_run(room: DrivenRoom) -> None:
    lost = replace(room, offsets=np.where(np.arange(len(room.offsets))[:, None] == 30, np.nan, room.offsets))
    with pytest.raises(SimulationError, match="the room's temperatures are lost by day 2, 07:00:00"):
        list(Loop(Chain({"controller": choice(controllers.PI)}, STEP_S), lost, 21.0).weeks(21.0, [Start(0.0, 0.0)]))


@pytest.mark.parametrize("jit", [True, False])
@pytest.mark.parametrize("value_C", [600.0, -300.0])
@pytest.mark.parametrize("output", ["layer_C", "operative_C"])
def test_a_temperature_that_no_room_has_ends_the_run(output: str, value_C: float, jit: bool, room: DrivenRoom) -> None:
    offsets = room.offsets.copy()
    offsets[30, ROOM_OUTPUTS.index(output)] = value_C
    with pytest.raises(SimulationError, match="the room's temperatures are lost by day 2, 07:00:00"):
        list(Loop(Chain(ON_OFF, STEP_S), replace(room, offsets=offsets), 21.0, jit=jit).weeks(21.0, [Start(0.0, 0.0)]))


def test_every_registered_block_has_its_own_name_and_kind() -> None:
    for (kind, name), entry in installed().components.items():
        assert (entry.component.kind, entry.component.name) == (kind, name)
