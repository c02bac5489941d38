"""A linear room driven by recorded inputs instead of by weather, and by a recorded flow instead of by a chain."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from numba import njit, types

from waxstudy.plugin import ROOM_OUTPUTS, FloatArray, Inputs, LinearRoom, Role, RoomInput, WeatherRecord
from waxstudy.plugin.shapes import lost_problems, role_problems
from waxstudy.simulation.cache import cached
from waxstudy.simulation.lanes import free_step
from waxstudy.simulation.modes import DrivenRoom, drive, main_modes

SUN, EXTRA = RoomInput("solar_W", Role.SUN), RoomInput("extra_W", Role.OWN)  # the last two of a recorded room
# a role -> the field of `Inputs` that tells what was recorded of it; the sun's is a heat of its own
RECORDED = {
    Role.OUTDOOR: "outdoor_C",
    Role.GAINS: "gains_W",
    Role.SUPPLY_AIR: "ventilation_C",
    Role.NEIGHBOUR: "neighbour_C",
}
DAY_S = 86400.0
REPEATS = 7  # of the first day, before a record
LAYER = ROOM_OUTPUTS.index("layer_C")
TOLERANCE_K = 0.002  # of the modes: less than what a slope of a fit is taken from
EDGES = 100  # ways in which a valve may have closed in an interval, and places that are looked at
LONGEST_STEP_S = 150.0  # of the explicit exchange between water and floor


def recorded_room(room: LinearRoom, inputs: Inputs) -> LinearRoom:
    """Return the room with its inputs as recorded, one for each role that a record has; they are told by their roles.

    A recorded temperature holds at all inputs of its role. Gains are shared out among theirs as the means of the
    room's own are, the sun, as one heat, as the room shares the sun's. Extra heat goes to where an ensemble member's
    air is, by capacity. What the room asks for and no record has stays as its own `drive` gives it. Raises
    `ValueError` where something that was recorded would be lost.
    """
    heat_W = {Role.SUN: inputs.solar_W, Role.GAINS: inputs.gains_W}
    for problem in chain(role_problems(room.inputs), lost_problems(room, heat_W)):
        raise ValueError(problem)
    columns = list(_columns(room, inputs))
    sun, air = room.places(Role.SUN), _air_share(room)
    heat, direct = room.input_matrix[:, sun].sum(axis=1), room.feedthrough[:, sun].sum(axis=1)
    whole = heat.sum() or 1.0
    still = np.zeros(len(ROOM_OUTPUTS))
    return replace(
        room,
        inputs=[*(column.input for column in columns), SUN, EXTRA],
        input_matrix=np.column_stack((*(room.input_matrix @ column.shares for column in columns), heat / whole, air)),
        feedthrough=np.column_stack((*(room.feedthrough @ column.shares for column in columns), direct / whole, still)),
        facades={},
        drive=lambda weather: _driven(room, columns, inputs, weather),
    )


@dataclass(frozen=True)
class Moving:
    """A valve that opens and closes within intervals; one that is switched is open or closed but for its strokes."""

    stroke_s: float
    is_switched: bool = False


@dataclass(frozen=True)
class _Column:
    """An input of a recorded room."""

    input: RoomInput
    shares: FloatArray  # (m,) of each of the room's inputs in it
    recorded: FloatArray | None  # (n,); None where the room's own drive gives it


def _columns(room: LinearRoom, inputs: Inputs) -> Iterator[_Column]:
    own = np.eye(len(room.inputs))
    for place, each in enumerate(room.inputs):
        alike = room.places(each.role)
        recorded = getattr(inputs, RECORDED[each.role]) if each.role in RECORDED else None
        if recorded is None and each.role is not Role.SUN:
            yield _Column(each, own[place], None)
        elif recorded is not None and place == alike[0]:
            whole = each.role is not Role.GAINS or len(alike) == 1
            shares = own[alike].sum(axis=0) if whole else _gain_shares(room, inputs)
            yield _Column(RoomInput(RECORDED[each.role], each.role), shares, recorded)


def _gain_shares(room: LinearRoom, inputs: Inputs) -> FloatArray:
    """Return the share of each input (m,) in recorded gains, by the means of the room's own."""
    places, shares = room.places(Role.GAINS), np.zeros(len(room.inputs))
    shares[places] = shared_by(_own_inputs(room, inputs, weather_of(inputs)).mean(axis=0)[places])
    return shares


def shared_by(weights: FloatArray) -> FloatArray:
    """Return shares that sum to 1, by weights, or equal ones where these are all 0."""
    whole = weights.sum()
    return weights / whole if whole else np.full(len(weights), 1.0 / len(weights))


def _air_share(room: LinearRoom) -> FloatArray:
    """Return the share of each node in heat given to the air: where the row of the air temperature looks."""
    row = np.clip(room.output_matrix[ROOM_OUTPUTS.index("air_C")], 0.0, None)
    return np.asarray(row / row.sum())


def _driven(
    room: LinearRoom, columns: Sequence[_Column], inputs: Inputs, weather: WeatherRecord
) -> tuple[FloatArray, FloatArray]:
    own = _own_inputs(room, inputs, weather)
    values = [own @ column.shares if column.recorded is None else column.recorded for column in columns]
    extra = np.zeros(len(own)) if inputs.extra_W is None else inputs.extra_W
    return np.column_stack((*values, inputs.solar_W, extra)), inputs.supply_C


def _own_inputs(room: LinearRoom, inputs: Inputs, weather: WeatherRecord) -> FloatArray:
    """Return what the room's own drive makes of weather without sun (n, m)."""
    return room.drive(_dark(room, inputs, weather))[0]


def _dark(room: LinearRoom, inputs: Inputs, weather: WeatherRecord) -> WeatherRecord:
    return replace(weather, irradiance_W_m2={name: np.zeros(len(inputs.outdoor_C)) for name in room.facades})


def sun_W(room: LinearRoom, weather: WeatherRecord) -> FloatArray:
    """Return all heat that the sun gives to a room's nodes (n,): what the input matrix makes of the irradiance."""
    dark = {name: np.zeros_like(values) for name, values in weather.irradiance_W_m2.items()}
    own, without = room.drive(weather)[0], room.drive(replace(weather, irradiance_W_m2=dark))[0]
    return np.asarray((own - without) @ room.input_matrix.sum(axis=0))


def believed_supply_C(room: LinearRoom, inputs: Inputs) -> FloatArray:
    """Return the supply temperature that the room's own heating curve would give (n,)."""
    return room.drive(_dark(room, inputs, weather_of(inputs)))[1]


def weather_of(inputs: Inputs) -> WeatherRecord:
    """Return the weather record that stands for recorded inputs."""
    return WeatherRecord(inputs.interval_s, "2000-01-01", inputs.outdoor_C, {}, sky_C=inputs.outdoor_C)


def driven_by(room: LinearRoom, inputs: Inputs, step_s: float | None = None) -> DrivenRoom:
    """Return a room in modal form under recorded inputs; the step is the interval, at most the one given or 150 s."""
    water_step_s = _water_step_s(inputs, step_s or LONGEST_STEP_S)
    return drive(recorded_room(room, inputs), weather_of(inputs), water_step_s, TOLERANCE_K, main_modes)


def respond(
    driven: DrivenRoom, inputs: Inputs, flow_L_h: FloatArray, moving: Moving | None = None
) -> dict[str, FloatArray]:
    """Return what a room does with a recorded flow (n,): `ROOM_OUTPUTS` at the end of each interval, and the heat.

    `water_heat_W` is the mean over the interval, `return_C` its mean, NaN without flow. The first day is repeated for a
    week before, then the room is `inputs.start_K` warmer, its floor by `inputs.start_floor_K` more. Where a valve is
    `moving` flows are means over intervals in which it opened or closed; else it stood still in each.
    """
    room, conductance_W_K = driven.room, _exchange_W_K(driven.room, inputs, flow_L_h, moving)
    shift_K = inputs.start_K + inputs.start_floor_K * (1.0 - room.air_nodes)
    found = _run(
        driven,
        conductance_W_K,
        driven.to_modes @ np.full(len(room.nodes), float(np.mean(inputs.air_C))),
        driven.to_modes @ shift_K,
        min(len(driven.supply_C), round(DAY_S / driven.weather.interval_s)),
    )
    stream_W_K = np.asarray(flow_L_h) / 3600.0 * room.water_J_L_K
    with np.errstate(divide="ignore", invalid="ignore"):
        found["return_C"] = np.where(stream_W_K > 0.0, driven.supply_C - found["water_heat_W"] / stream_W_K, np.nan)
    return found


def respond_to_heat(
    room: LinearRoom,
    inputs: Inputs,
    flow_L_h: FloatArray,
    heats_W: Iterable[Mapping[str, FloatArray]],
    moving: Moving | None = None,
    repeats_first_day: bool = False,
) -> Iterator[dict[str, FloatArray]]:
    """Yield by how much a room is changed by each course of heat [W], by field of its inputs (n,), as `respond` has it.

    A room with a given flow is linear in heat: each course is run alone, with nothing else that drives the room. As in
    `respond` the first day is repeated for a week before, or else nothing is changed before a course begins.
    """
    whole = recorded_room(room, inputs)
    places = {each.name: place for place, each in enumerate(whole.inputs)}
    units: dict[str, DrivenRoom] = {}
    conductance_W_K = _exchange_W_K(room, inputs, flow_L_h, moving)
    stream_W_K = np.asarray(flow_L_h) / 3600.0 * room.water_J_L_K
    day = min(len(flow_L_h), round(DAY_S / inputs.interval_s))
    for heat_W in heats_W:
        for name in heat_W.keys() - units.keys():
            alone = _driven_alone(whole, places[name])
            units[name] = drive(alone, weather_of(inputs), _water_step_s(inputs, LONGEST_STEP_S), 0.0)
        first = min(int(np.argmax(each != 0.0)) for each in heat_W.values())
        repeated = day if repeats_first_day and first < day else 0
        first = 0 if repeated else first
        pairs = [(each[first:, None], units[name]) for name, each in heat_W.items()]
        course = replace(
            pairs[0][1],
            forcing=sum(later_W * unit.forcing[0] for later_W, unit in pairs),
            offsets=sum(later_W * unit.offsets[0] for later_W, unit in pairs),
            supply_C=np.zeros(len(flow_L_h) - first),
        )
        still = np.zeros(len(course.decay))
        since = _run(course, conductance_W_K[first:], still.copy(), still, repeated)
        found = {name: np.concatenate((np.zeros(first), each)) for name, each in since.items()}
        with np.errstate(divide="ignore", invalid="ignore"):
            found["return_C"] = np.where(stream_W_K > 0.0, -found["water_heat_W"] / stream_W_K, np.nan)
        yield found


def _water_step_s(inputs: Inputs, longest_s: float) -> float:
    return inputs.interval_s / max(1, int(np.ceil(inputs.interval_s / longest_s)))


def _driven_alone(room: LinearRoom, place: int) -> LinearRoom:
    """Return a room that one of its inputs drives, always by 1, and cold water that flows through it."""
    one = slice(place, place + 1)
    return replace(
        room,
        inputs=room.inputs[one],
        input_matrix=room.input_matrix[:, one],
        feedthrough=room.feedthrough[:, one],
        drive=lambda weather: (np.ones((len(weather.outdoor_C), 1)), np.zeros(len(weather.outdoor_C))),
    )


def _exchange_W_K(room: LinearRoom, inputs: Inputs, flow_L_h: FloatArray, moving: Moving | None) -> FloatArray:
    """Return the exchange between water and floor (n,) at a flow; of `moving` see `respond`."""
    fraction = np.clip(np.asarray(flow_L_h, dtype=float) / room.full_flow_L_h, 0.0, None)
    conductance_W_K = np.array(room.floor_conductance_W_K(fraction), dtype=float)
    return _moved(room, fraction, conductance_W_K, moving, inputs.interval_s) if moving else conductance_W_K


def _run(
    driven: DrivenRoom, conductance_W_K: FloatArray, state: FloatArray, shift: FloatArray, first: int
) -> dict[str, FloatArray]:
    """Return `ROOM_OUTPUTS` and the water's heat of a room that begins at modes, shifted after so many intervals."""
    n = len(driven.supply_C)
    modes, last_W, mean_W = np.empty((n, len(driven.decay))), np.empty(n), np.empty(n)
    compiled()(
        driven.decay,
        driven.heat_gain,
        driven.forcing,
        driven.outputs,
        np.ascontiguousarray(driven.offsets[:, LAYER]),
        driven.heat_offset,
        np.array(driven.supply_C),
        conductance_W_K,
        state,
        shift,
        first,
        driven.steps_per_interval,
        modes,
        last_W,
        mean_W,
    )
    ends = driven.outputs @ modes.T  # (outputs, n), added to in place: new memory takes longer than the sums
    ends += driven.offsets.T
    ends += driven.heat_offset[:, None] * last_W
    return dict(zip(ROOM_OUTPUTS, ends, strict=True)) | {"water_heat_W": mean_W}


def _moved(
    room: LinearRoom, fraction: FloatArray, still_W_K: FloatArray, moving: Moving, interval_s: float
) -> FloatArray:
    """Return the mean exchange over intervals (n,) in which a valve moves.

    Water that flows fast for a part of an interval gives off less than as much that flows slowly all the time. How far
    a valve was on the move is told by how far an interval's mean is from those beside it, unless it only switches.
    """
    moves = interval_s / moving.stroke_s
    end, at = np.linspace(0.0, moves + 1.0, EDGES)[:, None], (np.arange(EDGES) + 0.5) * moves / EDGES
    edges = np.clip(end - at, 0.0, 1.0)  # (edges, places in the interval): closed, sooner or later
    exchange_W_K = np.reshape(room.floor_conductance_W_K(edges.ravel()), edges.shape).mean(axis=1)
    moved_W_K = np.interp(fraction, edges.mean(axis=1), exchange_W_K)
    if moving.is_switched:
        return np.where(fraction < 1.0, moved_W_K, still_W_K)
    change = np.diff(fraction, prepend=fraction[:1], append=fraction[-1:])
    steps = np.minimum(1.0, (np.abs(change[:-1]) + np.abs(change[1:])) / min(1.0, 2.0 * moves))
    return np.where(fraction < 1.0, still_W_K + steps * (moved_W_K - still_W_K), still_W_K)


def _response(
    decay: Any,
    heat_gain: Any,
    forcing: Any,  # (n, modes)
    outputs: Any,
    offset: Any,  # (n,) C, of the layer
    heat_offset: Any,
    supply: Any,  # (n,) C
    exchange: Any,  # (n,) W/K between supply and layer
    state: Any,  # (modes,) changed in place
    shift: Any,  # (modes,) added after the repeated first day
    first: int,  # intervals of that day
    parts: int,
    modes: Any,  # (n, modes) out: at the end of each interval
    last: Any,  # (n,) out: W in its last step
    mean: Any,  # (n,) out: W over it
) -> None:
    """Run a room in modal form with an exchange that is given for each interval."""
    by_layer = heat_offset[1]
    for i in range(len(decay)):
        by_layer += outputs[1, i] * heat_gain[i]
    for turn in range(REPEATS + 1):
        count = len(supply)
        if turn < REPEATS:
            count = first
        else:
            state += shift
        layer = offset[0]
        for i in range(len(decay)):
            layer += outputs[1, i] * state[i]
        heat = 0.0
        for n in range(count):
            total, force = 0.0, forcing[n]
            for _ in range(parts):
                heat = exchange[n] * (supply[n] - layer)
                total += heat
                _, free_layer, _ = free_step(decay, force, outputs, state)
                layer = offset[n] + free_layer + by_layer * heat
                for i in range(len(decay)):
                    state[i] += heat_gain[i] * heat
            if turn == REPEATS:
                modes[n] = state
                last[n] = heat
                mean[n] = total / parts


_NUMBERS, _TABLE = types.float64[::1], types.float64[:, ::1]
_SIGNATURE = types.void(
    _NUMBERS,
    _NUMBERS,
    _TABLE,
    _TABLE,
    *[_NUMBERS] * 6,
    types.int64,
    types.int64,
    _TABLE,
    _NUMBERS,
    _NUMBERS,
)


@cache
def compiled() -> Callable[..., None]:
    """Return the compiled response; it releases the interpreter lock."""

    def build(folder: Path | None) -> Any:
        return njit(_SIGNATURE, nogil=True, cache=folder is not None)(_response)

    function: Callable[..., None] = cached(build)
    return function
