"""What rooms, weather and published figures must hold, told in sentences: the kit and every run ask the same."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence, Sized
from datetime import date
from math import inf, isfinite
from numbers import Real
from typing import Any

import numpy as np

from waxstudy.plugin.contracts import (
    ROOM_OUTPUTS,
    Facade,
    Finding,
    FloatArray,
    LinearRoom,
    PublishedRow,
    WeatherRecord,
)
from waxstudy.plugin.model_error import ASSUMED, ModelError
from waxstudy.plugin.registry import PluginError, told
from waxstudy.plugin.roles import Role, RoomInput

Problems = Iterator[str]

VERDICTS = ("held", "not held", "not resolved")


def _is_of(made: object, kind: type) -> Problems:
    if not isinstance(made, kind):
        yield f"it gives {'None' if made is None else f'a {type(made).__name__}'}, not a {kind.__name__}"


def array_problems(name: str, values: Any, shape: tuple[int, ...]) -> Problems:
    """Yield what keeps values from being an array of finite numbers in a shape."""
    if not isinstance(values, np.ndarray) or values.dtype.kind not in "biuf":
        yield f"{name} must be an array of numbers, not of {getattr(values, 'dtype', type(values).__name__)}"
    elif values.shape != shape:
        yield f"{name} has the shape {values.shape}, {shape} is needed"
    elif not np.isfinite(values).all():
        yield f"{name} holds values that are no numbers"


def _positive(made: object, *names: str) -> Problems:
    for name in names:
        value = getattr(made, name)
        if not (isinstance(value, Real) and 0.0 < float(value) < inf):
            yield f"{name} = {value!r:.60} must be a positive number"


# --- room ------------------------------------------------------------------------------------------


def room_problems(room: Any) -> Problems:
    """Yield what keeps a room's parts from fitting each other."""
    if wrong := list(_is_of(room, LinearRoom)):
        yield from wrong
        return
    if not (isinstance(room.nodes, Sized) and isinstance(room.inputs, Sequence)):
        yield "nodes must be a list of names, inputs one of RoomInput"
        return
    yield from role_problems(room.inputs)
    n, m, k = len(room.nodes), len(room.inputs), len(ROOM_OUTPUTS)
    shapes = {
        "capacity_J_K": (n,),
        "conductance_W_K": (n, n),
        "input_matrix": (n, m),
        "floor_heat_share": (n,),
        "output_matrix": (k, n),
        "feedthrough": (k, m),
        "air_nodes": (n,),
    }
    for name, shape in shapes.items():
        yield from array_problems(name, getattr(room, name), shape)
    yield from _positive(room, "floor_area_m2", "full_flow_L_h", "water_J_L_K")
    facades = room.facades
    if not (isinstance(facades, Mapping) and all(isinstance(facade, Facade) for facade in facades.values())):
        yield "facades must be a table of names and Facades"


def role_problems(inputs: Sequence[Any]) -> Problems:
    """Yield what keeps a record from being applied to a room's inputs."""
    for each in inputs:
        if not (isinstance(each, RoomInput) and isinstance(each.role, Role)):
            roles = ", ".join(str(role) for role in Role)
            yield f"input {each!r:.60} has no role: give RoomInput(name, role), where role is one of {roles}"
            return
    if all(each.role is not Role.OUTDOOR for each in inputs):
        yield f"no input has the role {Role.OUTDOOR}: give it to what the outdoor air drives the room through"


def lost_problems(room: LinearRoom, heat_W: Mapping[Role, FloatArray]) -> Problems:
    """Yield recorded heat that would be lost, as no input of its role brings a room anything; NaN is not known."""
    for role, watts in heat_W.items():
        if not room.takes(role) and watts[~np.isnan(watts)].any():
            mean_W = float(np.nanmean(watts))
            yield f"{role.value} are recorded, {mean_W:.3g} W on average, but no input with the role {role} takes them"


def physics_problems(room: LinearRoom) -> Problems:
    """Yield what makes a room whose parts fit unstable, or lose or make heat."""
    G, share = room.conductance_W_K, room.floor_heat_share
    if (room.capacity_J_K <= 0.0).any():
        yield "capacity_J_K must be positive everywhere: leave out nodes without mass"
    if not np.allclose(G, G.T, rtol=1e-9, atol=1e-9 * np.abs(G).max()):
        yield "conductance_W_K is not symmetric: heat that leaves a node must arrive at another"
    elif np.linalg.eigvalsh(G).min() <= 0.0:
        yield "conductance_W_K is not positive definite: the room must lose heat to somewhere"
    if abs(share.sum() - 1.0) > 1e-9 or (share < 0.0).any():
        yield f"floor_heat_share must be shares that sum to 1, not to {share.sum():g}"
    flow = np.linspace(0.0, 1.0, 21)
    try:
        with told("floor_conductance_W_K failed"):
            conductance = room.floor_conductance_W_K(flow)
    except PluginError as error:
        yield str(error)
        return
    wrong = list(array_problems("floor_conductance_W_K", conductance, flow.shape))
    yield from wrong
    if not wrong and (conductance[0] != 0.0 or (np.diff(conductance) < 0.0).any()):
        yield "floor_conductance_W_K must be 0 without flow and never fall with more flow"


def model_error_problems(stated: Any) -> Problems:
    """Yield what is wrong with what a room states of its model's error."""
    if not isinstance(stated, Mapping):
        yield "model_errors must give a table of outputs and ModelErrors"
        return
    for output, error in stated.items():
        if output not in ASSUMED:
            yield f"model_errors: {output!r:.60} is not judged; outputs are {', '.join(ASSUMED)}"
        elif not isinstance(error, ModelError):
            yield f"model_errors: that of {output} is {error!r:.60}, not a ModelError(typical_K, most_K, source)"
        elif not 0.0 < error.typical_K <= error.most_K < inf:
            yield f"model_errors: {output} needs 0 < typical_K <= most_K, not {error.typical_K:g} and {error.most_K:g}"
        elif not (isinstance(error.source, str) and error.source.strip()):
            yield f"model_errors: {output} has no source: say what the model was held against"


def driving_problems(room: LinearRoom, weather: WeatherRecord) -> Problems:
    """Yield what is wrong with the inputs and the supply temperature that a room makes of weather.

    Raises the room's own `ValueError` where it asks for what this weather does not hold.
    """
    try:
        with told("drive failed", ValueError):
            inputs, supply_C = room.drive(weather)
    except PluginError as error:
        yield str(error)
        return
    n = len(weather.outdoor_C)
    yield from array_problems("drive's table of inputs", inputs, (n, len(room.inputs)))
    yield from array_problems("drive's supply_C", supply_C, (n,))


# --- weather ---------------------------------------------------------------------------------------


def weather_problems(record: Any, facades: Mapping[str, Facade]) -> Problems:
    """Yield what keeps weather from being numbers for every interval and facade."""
    if wrong := list(_is_of(record, WeatherRecord)):
        yield from wrong
        return
    if not isinstance(record.irradiance_W_m2, Mapping):
        yield "irradiance_W_m2 must be a table of names of facades and arrays"
        return
    if missing := set(facades) - set(record.irradiance_W_m2):
        yield f"no irradiance for {', '.join(sorted(missing))}: give one per facade asked for"
    yield from _positive(record, "interval_s")
    n = np.size(record.outdoor_C)
    for name, values in {"outdoor_C": record.outdoor_C, **_sky(record), **record.irradiance_W_m2}.items():
        yield from array_problems(name, values, (n,))
    try:
        date.fromisoformat(record.first_day)
    except (TypeError, ValueError):
        yield f"first_day is {record.first_day!r:.60}: write it as 2023-01-31"


def _sky(record: WeatherRecord) -> dict[str, Any]:
    return {} if record.sky_C is None else {"sky_C": record.sky_C}


# --- published figures -----------------------------------------------------------------------------


def rows_problems(rows: Sequence[Any]) -> Problems:
    """Yield what keeps published rows from naming each case and week once, with numbers."""
    if not rows or not all(isinstance(row, PublishedRow) for row in rows):
        yield "rows must give at least one PublishedRow, and nothing else"
        return
    counted = Counter((row.case, row.week) for row in rows)
    yield from (f"case {case}, week {week} is given twice" for (case, week), count in counted.items() if count > 1)
    for row in rows:
        if not all(isinstance(value, Real) and isfinite(value) for value in list(vars(row).values())[2:]):
            yield f"case {row.case}, week {row.week}: figures that are no numbers"


def _is_told(field: tuple[str, Any]) -> bool:
    name, value = field
    if not name.endswith("_share"):
        return isinstance(value, str)
    return isinstance(value, float) and not (value < 0.0 or value > 1.0)


def findings_problems(findings: Sequence[Any]) -> Problems:
    """Yield what keeps findings from being statements with a verdict."""
    for finding in findings:
        if not isinstance(finding, Finding) or not all(map(_is_told, vars(finding).items())):
            yield "findings must give Finding objects of texts and shares of single runs, and nothing else"
            return
        if finding.verdict not in VERDICTS or finding.corrected_verdict not in ("", *VERDICTS):
            yield f"finding {finding.id}: its verdict is '{finding.verdict}', not one of {', '.join(VERDICTS)}"
