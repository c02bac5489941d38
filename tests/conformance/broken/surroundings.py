"""Broken weather, rooms, published figures and effects: source of their function, and what a run or report says."""

from __future__ import annotations

from collections.abc import Mapping

FINDINGS = "findings = classmethod(lambda cls, run: "
ABSORBS = "absorbs = "
SIGNATURES = {
    "Weather": "load(cls, p, facades)",
    "Room": "build(cls, p)",
    "Reference": "rows(cls)",
    "Effect": "apply(cls, belief, p)",
}
DAYS = "WeatherRecord(3600.0, '2023-01-01', np.zeros(48), {f: np.zeros(48) for f in facades})"
NZEB = (
    "from dataclasses import replace\n"
    "from waxstudy_paper.room import NzebRoom\n"
    "room = NzebRoom.build(NzebRoom.Parameters())\n"
)


OF_EFFECT = """
class Leak(Parameters):
    fraction: float = parameter(0.0, unit="1", ge=0, le=1, description="Leak.", source="chosen for a test")


"""
IN_EFFECT = """
    stage = "emitter"
    Parameters = Leak
    priors = {"fraction": Prior(0.0, 0.5, noticeable=0.01)}
    sentence = classmethod(lambda cls, p: "The valve leaks.")
"""


def placed(body: str) -> str:
    """Return a body where it stands in the class, further out what is no part of its method."""
    return "\n".join((4 if line.startswith((FINDINGS, ABSORBS)) else 8) * " " + line for line in body.splitlines())


def source(kind: str, body: str) -> str:
    """Source of a plugin of one component of this kind."""
    return f'''\
from dataclasses import replace

import numpy as np

from waxstudy.plugin import (
    Effect, Parameters, Prior, PublishedRow, Reference, Role, Room, RoomInput, Weather, WeatherRecord, hookimpl,
    parameter
)

{OF_EFFECT if kind == "Effect" else ""}
class Broken({kind}):
    """Made for a test."""

    name = "NAME"
    api_version = "1.0"
{IN_EFFECT if kind == "Effect" else ""}

    @classmethod
    def {SIGNATURES[kind]}:
{placed(body)}


@hookimpl
def waxstudy_register(register):
    register(Broken)
'''


WEATHER: Mapping[str, str] = {
    "weather-of-nothing": "return None",
    "weather-exits": "raise SystemExit('no such station')",
    "weather-without-facades": f"return {DAYS.replace('for f in facades', 'for f in ()')}",
    "weather-too-short": f"return {DAYS.replace('f: np.zeros(48)', 'f: np.zeros(24)')}",
    "weather-of-texts": "return " + DAYS.replace("np.zeros(48), {", "np.full(48, 'cold'), {"),
    "weather-with-a-text-interval": f"return {DAYS.replace('3600.0', repr('1 h'))}",
}
ROOMS: dict[str, str] = {
    "room-of-nothing": "return None",
    "room-exits": "raise SystemExit('no such house')",
    "room-cannot-drive": f"{NZEB}return replace(room, drive=lambda weather: {{}}['sun'])",
    "room-of-another-shape": f"{NZEB}return replace(room, output_matrix=room.output_matrix[:3])",
    "room-of-nan": f"{NZEB}return replace(room, capacity_J_K=room.capacity_J_K * np.nan)",
    "room-of-negative-mass": f"{NZEB}return replace(room, capacity_J_K=-room.capacity_J_K)",
    "room-of-one-conductance": f"{NZEB}return replace(room, floor_conductance_W_K=lambda flow: 3.0)",
    "room-of-one-supply": f"{NZEB}return replace(room, drive=lambda w: (room.drive(w)[0], np.full(1, 45.0)))",
}
ROLES = f"{NZEB}inputs = list(room.inputs)\n"
ROOMS |= {
    "room-of-names": f"{NZEB}return replace(room, inputs=[each.name for each in room.inputs])",
    "room-without-outdoors": f"{ROLES}inputs[0] = RoomInput('ta', Role.OWN)\nreturn replace(room, inputs=inputs)",
}
# a room that a run takes, and the kit does not -> what it says
MISTAKEN: Mapping[str, tuple[str, str]] = {
    "gains-per-area": (
        f"{ROLES}B = room.input_matrix * [1.0, 1.0, 10.4, 1.0, 1.0]\nreturn replace(room, input_matrix=B)",
        "input 'gains_W', Role.GAINS: of 1 W the room gets 10.3 W; gains are in W",
    ),
    "outdoors-in-fahrenheit": (
        f"{NZEB}B, f = [room.input_matrix * [5 / 9, 1, 1, 1, 1], np.array([1.8, 1, 1, 1, 1])]\n"
        "return replace(room, input_matrix=B, drive=lambda w: (room.drive(w)[0] * f, room.drive(w)[1]))",
        "input 'outdoor_C', Role.OUTDOOR: drive does not give it the temperature of the outdoor air",
    ),
    "outdoors-that-cool": (
        f"{NZEB}return replace(room, input_matrix=room.input_matrix * [-1, 1, 1, 1, 1])",
        "input 'outdoor_C', Role.OUTDOOR: 1 K more changes the air by -",
    ),
    "outdoors-too-warm": (
        f"{NZEB}return replace(room, input_matrix=room.input_matrix * [2, 1, 1, 1, 1])",
        "1 K more of all around it warms the air by 1.",
    ),
    "outdoors-out-of-reach": (
        f"{NZEB}return replace(room, input_matrix=room.input_matrix * [0, 1, 1, 1, 1])",
        "the inputs with the role Role.OUTDOOR do not reach the air",
    ),
    "a-second-outdoors": (
        f"{ROLES}inputs[1] = RoomInput('ground_C', Role.OWN)\n"
        "return replace(room, inputs=inputs, drive=lambda w: (room.drive(w)[0][:, [0, 0, 2, 3, 4]], room.drive(w)[1]))",
        "input 'ground_C', Role.OWN is the outdoor air's temperature: its role is Role.OUTDOOR",
    ),
    "sun-of-no-role": (
        f"{ROLES}inputs[3:] = [RoomInput('south', Role.OWN), RoomInput('west', Role.OWN)]\n"
        "return replace(room, inputs=inputs)",
        "input 'south', Role.OWN changes with the sun: give that an input of its own, Role.SUN",
    ),
    "sun-that-does-nothing": (
        f"{NZEB}lit = [1, 1, 1, 0, 0]\n"
        "return replace(room, drive=lambda w: (room.drive(w)[0] * lit, room.drive(w)[1]))",
        "which changes no input with the role Role.SUN",
    ),
    "sun-that-cools": (
        f"{NZEB}return replace(room, input_matrix=room.input_matrix * [1, 1, 1, 1, -1])",
        "Role.SUN: the sun cools the room",
    ),
    "sky-of-outdoors": (
        f"{ROLES}inputs[1] = RoomInput('sky_C', Role.SKY)\nreturn replace(room, inputs=inputs)",
        "input 'sky_C', Role.SKY: drive does not give it the temperature of the sky",
    ),
}
ROWS = "return [PublishedRow('O_0', 'january', 0.0, 0.0, 1.0, 0.0)]"
REFERENCES: Mapping[str, str] = {
    "rows-raise": "return {}['rows']",
    "rows-of-nothing": "return None",
    "findings-raise": f"{ROWS}\n\n{FINDINGS}{{}}['findings'])",
    "findings-of-nothing": f"{ROWS}\n\n{FINDINGS}None)",
    "findings-of-dicts": f"{ROWS}\n\n{FINDINGS}[{{'id': 'a'}}])",
    "no-findings": ROWS,
}
COLDER = "belief.inputs.supply_C"
EFFECTS: Mapping[str, tuple[str, str]] = {
    "effect-that-changes-at-neutral": (
        f"return replace(belief, inputs=replace(belief.inputs, supply_C={COLDER} - 1.0 - p.fraction))",
        "at its neutral parameters, fraction = 0, an output changes by ",
    ),
    "effect-that-changes-its-belief": (
        f"{COLDER}[:] -= p.fraction\nreturn belief",
        "apply changes the belief that it is given: return another, with belief.changed or replace",
    ),
    "effect-of-nothing": ("return belief", "it changes nothing at any point of its range: controller 'on-off'"),
    "effect-of-no-number": (
        f"lost = {COLDER} if p.fraction == 0.0 else {COLDER} * float('nan')\n"
        "return replace(belief, inputs=replace(belief.inputs, supply_C=lost))",
        " no number at fraction = ",
    ),
    "effect-that-absorbs-a-text": (
        f'return replace(belief, inputs=replace(belief.inputs, supply_C={COLDER} - p.fraction))\n{ABSORBS}"heat-loss"',
        "its `absorbs` must be a sequence of names, as ('heat-loss',)",
    ),
    "effect-that-gives-none": ("return None", "apply gives None, not a Belief"),
}
