"""Whether a room answers to each of its inputs as the input's role says."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from waxstudy.conformance.stage import Problems
from waxstudy.plugin import ROOM_OUTPUTS, FloatArray, LinearRoom, Role, WeatherRecord

AROUND = (Role.OUTDOOR, Role.SUPPLY_AIR, Role.NEIGHBOUR, Role.SKY)
STEP = 5.0  # K, by which outdoor air or sky are warmer
SUN_W_M2 = 100.0
SAME = 1e-6
LEAST_GAIN = 0.5  # of a watt: the rest leaves through what has no mass, as panes


def answer_problems(room: LinearRoom) -> Problems:
    """Yield what of a room's answers is not as the roles of its inputs say."""
    yield from _steady_problems(room)
    yield from _followed_problems(room)


def _steady_problems(room: LinearRoom) -> Problems:
    """Yield steady states that nothing around the room and in it can make."""
    heat_W = room.input_matrix.sum(axis=0)
    steady = room.output_matrix @ np.linalg.solve(room.conductance_W_K, room.input_matrix) + room.feedthrough
    air = steady[ROOM_OUTPUTS.index("air_C")]  # what a unit of each input does to it
    around = [place for role in AROUND for place in room.places(role)]
    for place in around:
        if air[place] < 0.0 or (heat_W[place] and air[place] < SAME):
            yield f"input {_named(room, place)}: 1 K more changes the air by {air[place]:.3g} K; it must warm it"
    if not air[room.places(Role.OUTDOOR)].sum() > SAME:
        yield f"the inputs with the role {Role.OUTDOOR} do not reach the air"
    if air[around].sum() > 1.0 + SAME:
        yield f"1 K more of all around it warms the air by {air[around].sum():.3g} K; it cannot be more than 1 K"
    for place in room.places(Role.GAINS):
        if not LEAST_GAIN <= heat_W[place] <= 1.0 + SAME:
            yield f"input {_named(room, place)}: of 1 W the room gets {heat_W[place]:.3g} W; gains are in W"
    for place in room.places(Role.SUN):
        if heat_W[place] < 0.0:
            yield f"input {_named(room, place)}: the sun cools the room"


def _followed_problems(room: LinearRoom) -> Problems:
    """Yield inputs that follow the weather otherwise than their role says."""
    weather = _weather(room)
    warmer, clear = weather.outdoor_C + STEP, weather.sky_C
    assert clear is not None
    sunny = {name: values + SUN_W_M2 for name, values in weather.irradiance_W_m2.items()}
    by_air = dict(_changes(room, weather, replace(weather, outdoor_C=warmer)))
    by_sky = dict(_changes(room, weather, replace(weather, sky_C=clear + STEP)))
    by_sun = dict(_changes(room, weather, replace(weather, irradiance_W_m2=sunny)))
    own, _ = room.drive(weather)
    for place, each in enumerate(room.inputs):
        for role, change in ((Role.OUTDOOR, by_air[place]), (Role.SKY, by_sky[place])):
            if each.role is role and not np.allclose(change, STEP):
                yield f"input {_named(room, place)}: drive does not give it the temperature of the {role.value}"
        if each.role is not Role.SUN and by_sun[place].any():
            yield f"input {_named(room, place)} changes with the sun: give that an input of its own, {Role.SUN}"
        if each.role is Role.OWN and np.array_equal(own[:, place], weather.outdoor_C):
            yield f"input {_named(room, place)} is the outdoor air's temperature: its role is {Role.OUTDOOR}"
    if room.facades and not any(by_sun[place].any() for place in room.places(Role.SUN)):
        yield f"it asks for the sun on {', '.join(room.facades)}, which changes no input with the role {Role.SUN}"


def _changes(room: LinearRoom, one: WeatherRecord, other: WeatherRecord) -> Iterator[tuple[int, FloatArray]]:
    yield from enumerate((room.drive(other)[0] - room.drive(one)[0]).T)


def _weather(room: LinearRoom) -> WeatherRecord:
    """Return a day without sun in which all else changes."""
    day = np.sin(2.0 * np.pi * np.arange(24) / 24.0)
    dark = {name: np.zeros(24) for name in room.facades}
    return WeatherRecord(3600.0, "2023-01-01", -5.0 + 3.0 * day, dark, sky_C=-15.0 + 2.0 * day)


def _named(room: LinearRoom, place: int) -> str:
    return f"'{room.inputs[place].name}', {room.inputs[place].role}"
