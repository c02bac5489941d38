"""What a room, weather and published figures must give."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from datetime import date
from typing import Any

import numpy as np

from waxstudy.conformance.stage import Problems, Stage, Subject
from waxstudy.plugin import ROOM_OUTPUTS, Facade, LinearRoom, PublishedRow, Reference, Room, Weather, WeatherRecord
from waxstudy.plugin.registry import described

DAY_S = 86400.0
FACADES = {"south": Facade(180.0), "roof": Facade(0.0, 0.0)}


def _made(subject: Subject, make: Callable[[Any], Any], kind: type) -> Iterator[tuple[str, Any, str]]:
    """What each example gives, or what is wrong with it."""
    for label, parameters in subject.models.items():
        try:
            made = make(parameters)
        except Exception as error:
            yield label, None, f"example '{label}': {described(error)}"
            continue
        right = isinstance(made, kind)
        yield label, made, "" if right else f"example '{label}': gives {made!r:.60}, not a {kind.__name__}"


# --- room ------------------------------------------------------------------------------------------


def _rooms(subject: Subject) -> Iterator[tuple[str, LinearRoom, str]]:
    assert issubclass(subject.component, Room)
    yield from _made(subject, subject.component.build, LinearRoom)


def room_builds(subject: Subject) -> Problems:
    """`build` gives a LinearRoom whose arrays fit each other and hold numbers."""
    for label, room, wrong in _rooms(subject):
        if wrong:
            yield wrong
            continue
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
            array = np.asarray(getattr(room, name), dtype=float)
            if array.shape != shape:
                yield f"example '{label}': {name} has the shape {array.shape}, {shape} is needed"
            elif not np.isfinite(array).all():
                yield f"example '{label}': {name} holds values that are no numbers"
        for name in ("floor_area_m2", "full_flow_L_h", "water_J_L_K"):
            if not getattr(room, name) > 0.0:
                yield f"example '{label}': {name} = {getattr(room, name)!r} must be positive"


def room_physics(subject: Subject) -> Problems:
    """Capacities are positive, conductances symmetric and positive definite, heat is neither made nor lost."""
    for label, room, _ in _rooms(subject):
        G, share = np.asarray(room.conductance_W_K), np.asarray(room.floor_heat_share)
        if (np.asarray(room.capacity_J_K) <= 0.0).any():
            yield f"example '{label}': capacity_J_K must be positive everywhere: leave out nodes without mass"
        if not np.allclose(G, G.T, rtol=1e-9, atol=1e-9 * np.abs(G).max()):
            yield f"example '{label}': conductance_W_K is not symmetric: heat that leaves a node must arrive at another"
        elif np.linalg.eigvalsh(G).min() <= 0.0:
            yield f"example '{label}': conductance_W_K is not positive definite: the room must lose heat to somewhere"
        if abs(share.sum() - 1.0) > 1e-9 or (share < 0.0).any():
            yield f"example '{label}': floor_heat_share must be shares that sum to 1, not to {share.sum():g}"
        flow = np.linspace(0.0, 1.0, 21)
        conductance = np.asarray(room.floor_conductance_W_K(flow))
        if conductance.shape != flow.shape or conductance[0] != 0.0 or (np.diff(conductance) < 0.0).any():
            yield f"example '{label}': floor_conductance_W_K must be 0 without flow and never fall with more flow"


def room_drive(subject: Subject) -> Problems:
    """`drive` turns weather into inputs and a supply temperature for each interval; the same again each time."""
    for label, room, _ in _rooms(subject):
        weather = WeatherRecord(3600.0, "2023-01-01", np.full(24, -5.0), {name: np.zeros(24) for name in room.facades})
        try:
            inputs, supply_C = map(np.asarray, room.drive(weather))
        except Exception as error:
            yield f"example '{label}': drive failed: {described(error)}"
            continue
        if inputs.shape != (24, len(room.inputs)) or supply_C.shape != (24,):
            yield (
                f"example '{label}': drive gives shapes {inputs.shape} and {supply_C.shape} for 24 intervals; "
                f"(24, {len(room.inputs)}) and (24,) are needed"
            )
        elif not (np.isfinite(inputs).all() and np.isfinite(supply_C).all()):
            yield f"example '{label}': drive gives values that are no numbers"
        elif not np.array_equal(inputs, np.asarray(room.drive(weather)[0])):
            yield f"example '{label}': drive gives other inputs a second time"


# --- weather ---------------------------------------------------------------------------------------


def _records(subject: Subject) -> Iterator[tuple[str, WeatherRecord, str]]:
    component = subject.component
    assert issubclass(component, Weather)
    yield from _made(subject, lambda p: component.load(p, FACADES), WeatherRecord)


def weather_loads(subject: Subject) -> Problems:
    """`load` gives a day at least, in equal intervals that divide it, with numbers for every facade."""
    for label, record, wrong in _records(subject):
        if wrong:
            yield wrong
            continue
        series: Mapping[str, Any] = {"outdoor_C": record.outdoor_C, **record.irradiance_W_m2}
        if missing := set(FACADES) - set(record.irradiance_W_m2):
            yield f"example '{label}': no irradiance for {', '.join(sorted(missing))}: give one per facade asked for"
        for name, values in series.items():
            if np.shape(values) != np.shape(record.outdoor_C) or not np.isfinite(np.asarray(values, float)).all():
                yield f"example '{label}': {name} must hold {len(record.outdoor_C)} numbers, one per interval"
            elif name != "outdoor_C" and (np.asarray(values) < 0.0).any():
                yield f"example '{label}': the irradiance {name} is negative"
        if not (record.interval_s > 0.0 and DAY_S % record.interval_s == 0.0 and record.duration_s >= DAY_S):
            what = f"{len(record.outdoor_C)} intervals of {record.interval_s:g} s"
            yield f"example '{label}': {what}: give intervals that divide the day, for a day at least"
        try:
            date.fromisoformat(record.first_day)
        except (TypeError, ValueError):
            yield f"example '{label}': first_day is {record.first_day!r}: write it as 2023-01-31"


def weather_again(subject: Subject) -> Problems:
    """Loaded again, it is the same."""
    for (label, first, _), (_, second, _) in zip(_records(subject), _records(subject), strict=True):
        same = np.array_equal(first.outdoor_C, second.outdoor_C) and all(
            np.array_equal(values, second.irradiance_W_m2[name]) for name, values in first.irradiance_W_m2.items()
        )
        if not same:
            yield f"example '{label}': loaded a second time it differs: draw from a seed that is a parameter"


# --- published figures -----------------------------------------------------------------------------


def reference_rows(subject: Subject) -> Problems:
    """`rows` gives each case and week once, with numbers."""
    assert issubclass(subject.component, Reference)
    try:
        rows = list(subject.component.rows())
    except Exception as error:
        yield f"rows failed: {described(error)}"
        return
    if not rows or not all(isinstance(row, PublishedRow) for row in rows):
        yield "rows must give at least one PublishedRow, and nothing else"
        return
    names = [(row.case, row.week) for row in rows]
    yield from (f"case {case}, week {week} is given twice" for case, week in {n for n in names if names.count(n) > 1})
    for row in rows:
        if not np.isfinite([row.setpoint_shift_K, row.mae_K, row.heat_kWh_m2_week]).all():
            yield f"case {row.case}, week {row.week}: figures that are no numbers"


ROOM_STAGES = (
    Stage("build", "a room whose arrays fit each other", room_builds, needed=True),
    Stage("physics", "stable, and heat is neither made nor lost", room_physics),
    Stage("drive", "inputs and supply temperature from weather", room_drive),
)
WEATHER_STAGES = (
    Stage("load", "numbers in equal intervals for a day at least", weather_loads, needed=True),
    Stage("reproducible", "the same again", weather_again),
)
REFERENCE_STAGES = (Stage("rows", "each case and week once, with numbers", reference_rows),)
