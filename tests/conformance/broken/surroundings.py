"""Broken weather, rooms, published figures and effects: source of their function, and what a run or report says."""

from __future__ import annotations

from collections.abc import Mapping
from textwrap import indent

FINDINGS = "findings = classmethod(lambda cls, run: "
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


def source(kind: str, body: str) -> str:
    """Source of a plugin of one component of this kind."""
    return f'''\
from dataclasses import replace

import numpy as np

from waxstudy.plugin import (
    Effect, Parameters, Prior, PublishedRow, Reference, Room, Weather, WeatherRecord, hookimpl, parameter
)

{OF_EFFECT if kind == "Effect" else ""}
class Broken({kind}):
    """Made for a test."""

    name = "NAME"
    api_version = "1.0"
{IN_EFFECT if kind == "Effect" else ""}

    @classmethod
    def {SIGNATURES[kind]}:
{indent(body, 8 * " ").replace(8 * " " + FINDINGS, 4 * " " + FINDINGS)}


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
ROOMS: Mapping[str, str] = {
    "room-of-nothing": "return None",
    "room-exits": "raise SystemExit('no such house')",
    "room-cannot-drive": f"{NZEB}return replace(room, drive=lambda weather: {{}}['sun'])",
    "room-of-another-shape": f"{NZEB}return replace(room, output_matrix=room.output_matrix[:3])",
    "room-of-nan": f"{NZEB}return replace(room, capacity_J_K=room.capacity_J_K * np.nan)",
    "room-of-negative-mass": f"{NZEB}return replace(room, capacity_J_K=-room.capacity_J_K)",
    "room-of-one-conductance": f"{NZEB}return replace(room, floor_conductance_W_K=lambda flow: 3.0)",
    "room-of-one-supply": f"{NZEB}return replace(room, drive=lambda w: (room.drive(w)[0], np.full(1, 45.0)))",
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
    "effect-that-gives-none": ("return None", "apply gives None, not a Belief"),
}
