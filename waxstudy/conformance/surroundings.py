"""What a room, weather and published figures must give."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from waxstudy.conformance.roles import answer_problems
from waxstudy.conformance.stage import Problems, Stage, Subject
from waxstudy.plugin import Facade, Reference, Room, Weather, WeatherRecord
from waxstudy.plugin.registry import PluginError, told
from waxstudy.plugin.shapes import (
    driving_problems,
    model_error_problems,
    physics_problems,
    room_problems,
    rows_problems,
    weather_problems,
)

DAY_S = 86400.0
MATRICES = ("capacity_J_K", "conductance_W_K", "input_matrix", "output_matrix", "floor_heat_share", "full_flow_L_h")
FACADES = {"south": Facade(180.0), "roof": Facade(0.0, 0.0)}


def _made(subject: Subject, make: Callable[[Any], Any]) -> Iterator[tuple[str, Any, str]]:
    """What each example gives, or what it raised."""
    for label, parameters in subject.models.items():
        made, wrong = None, ""
        try:
            with told(f"example '{label}'"):
                made = make(parameters)
        except PluginError as error:
            wrong = str(error)
        yield label, made, wrong


# --- room ------------------------------------------------------------------------------------------


def _rooms(subject: Subject) -> Iterator[tuple[str, Any, str]]:
    assert issubclass(subject.component, Room)
    yield from _made(subject, subject.component.build)


def room_builds(subject: Subject) -> Problems:
    """`build` gives a LinearRoom whose arrays fit each other and hold numbers."""
    for label, room, wrong in _rooms(subject):
        yield from [wrong] if wrong else (f"example '{label}': {problem}" for problem in room_problems(room))


def room_physics(subject: Subject) -> Problems:
    """Capacities are positive, conductances symmetric and positive definite, heat is neither made nor lost."""
    for label, room, _ in _rooms(subject):
        yield from (f"example '{label}': {problem}" for problem in physics_problems(room))


def room_drive(subject: Subject) -> Problems:
    """`drive` turns weather into inputs and a supply temperature for each interval; the same again each time."""
    for label, room, _ in _rooms(subject):
        dark = {name: np.zeros(24) for name in room.facades}
        weather = WeatherRecord(3600.0, "2023-01-01", np.full(24, -5.0), dark, sky_C=np.full(24, -15.0))
        wrong = list(driving_problems(room, weather))
        yield from (f"example '{label}': {problem}" for problem in wrong)
        if not wrong and not np.array_equal(room.drive(weather)[0], room.drive(weather)[0]):
            yield f"example '{label}': drive gives other inputs a second time"


def room_roles(subject: Subject) -> Problems:
    """What a record gives for an input's role reaches the room as such a thing does."""
    for label, room, _ in _rooms(subject):
        yield from (f"example '{label}': {problem}" for problem in answer_problems(room))


def room_errors(subject: Subject) -> Problems:
    """What it states of its model's error, if anything, is of outputs that are judged, in kelvins, with its source."""
    assert issubclass(subject.component, Room)
    for label, stated, wrong in _made(subject, subject.component.model_errors):
        found = [wrong] if wrong else (f"example '{label}': {problem}" for problem in model_error_problems(stated))
        yield from found


def room_description(subject: Subject) -> Problems:
    """A room that can be described is the same room when it is made of its own description."""
    component = subject.component
    assert issubclass(component, Room)
    for label, described, wrong in _made(subject, component.description):
        if wrong:
            yield wrong
        elif described is not None:
            p = subject.models[label]
            yield from (f"example '{label}': {problem}" for problem in _return_problems(component, p, described))


def _return_problems(component: type[Room], p: Any, described: Any) -> Problems:
    """Yield how a room that is made of its own description differs from itself."""
    try:
        with told("of_description, given the room's own description"):
            again: Any = component.of_description(p, described)
            one, other = component.build(p), again.component.build(again.parameters)
    except PluginError as error:
        yield str(error)
        return
    same = [name for name in MATRICES if np.shape(getattr(one, name)) == np.shape(getattr(other, name))]
    differ = [
        name for name in MATRICES if name not in same or not np.allclose(getattr(one, name), getattr(other, name))
    ]
    if differ:
        yield f"of_description, given the room's own description, makes another room: {', '.join(differ)} differ"


# --- weather ---------------------------------------------------------------------------------------


def _records(subject: Subject) -> Iterator[tuple[str, Any, str]]:
    component = subject.component
    assert issubclass(component, Weather)
    yield from _made(subject, lambda p: component.load(p, FACADES))


def weather_loads(subject: Subject) -> Problems:
    """`load` gives a day at least, in equal intervals that divide it, with numbers for every facade."""
    for label, record, failed in _records(subject):
        wrong = [failed] if failed else [f"example '{label}': {problem}" for problem in _weather_wrong(record)]
        yield from wrong


def _weather_wrong(record: Any) -> Problems:
    if wrong := list(weather_problems(record, FACADES)):
        yield from wrong
        return
    for name, values in record.irradiance_W_m2.items():
        if (values < 0.0).any():
            yield f"the irradiance {name} is negative"
    if DAY_S % record.interval_s != 0.0 or record.duration_s < DAY_S:
        what = f"{len(record.outdoor_C)} intervals of {record.interval_s:g} s"
        yield f"{what}: give intervals that divide the day, for a day at least"


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
        with told("rows failed"):
            rows = list(subject.component.rows())
    except PluginError as error:
        yield str(error)
        return
    yield from rows_problems(rows)


ROOM_STAGES = (
    Stage("build", "a room whose arrays fit each other", room_builds, needed=True),
    Stage("physics", "stable, and heat is neither made nor lost", room_physics, needed=True),
    Stage("drive", "inputs and supply temperature from weather", room_drive, needed=True),
    Stage("roles", "each input drives the room as its role says", room_roles),
    Stage("model-errors", "in kelvins of what is judged, with their source", room_errors),
    Stage("description", "the same room when it is made of its own description", room_description),
)
WEATHER_STAGES = (
    Stage("load", "numbers in equal intervals for a day at least", weather_loads, needed=True),
    Stage("reproducible", "the same again", weather_again),
)
REFERENCE_STAGES = (Stage("rows", "each case and week once, with numbers", reference_rows),)
