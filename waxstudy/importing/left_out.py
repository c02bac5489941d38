"""Readings that are left out before channels are looked for: modes of thermostats, and those that are one alone."""

from __future__ import annotations

import re
from collections.abc import Sequence

from waxstudy.dataset.notes import Notes
from waxstudy.importing.layouts import NO_ROWS
from waxstudy.importing.limits import NAMED
from waxstudy.importing.names import CHANNEL_NAMES, plain, says
from waxstudy.importing.reading import Logged, refusal
from waxstudy.importing.seen import ON
from waxstudy.importing.time_columns import EXPECTED
from waxstudy.study.problems import listed

MODE, ACTION = re.compile(r"(?:climate|water_heater)\.\w+"), "hvac_action"  # of Home Assistant's thermostats


def without_modes(logged: list[Logged], stated: Sequence[str], notes: Notes) -> list[Logged]:
    """Return readings without modes of thermostats, which stand at heat whether or not they heat."""
    modes = [each.entity for each in logged if each.is_words and MODE.fullmatch(each.entity)]
    modes = [entity for entity in modes if entity not in stated]
    names = {each.entity for each in logged}
    if silent := [entity for entity in modes if f"{entity}:{ACTION}" not in names]:
        why = f"a thermostat's state is its mode, and only its {ACTION} tells whether it heats"
        notes.warn(f"not used, because {why}: {listed(silent, NAMED)}")
    return [each for each in logged if each.entity not in modes]


def without_lone(logged: list[Logged], stated: Sequence[str], notes: Notes) -> list[Logged]:
    """Return readings without those that are one alone, unless it stays: a setpoint, or a state."""
    short = [each for each in logged if len(each.ns) < 2 and each.entity not in stated]
    lone = [each for each in short if not (len(each.ns) and _stays(each))]
    if logged and all(len(each.ns) < 2 for each in logged):
        raise refusal(logged[0].where, NO_ROWS, EXPECTED)
    if lone:
        found = listed([f"{each.entity} in {each.where}" for each in lone], NAMED)
        notes.warn(f"not used, because there is one reading and no more: {found}")
    return [each for each in logged if all(each is not one for one in lone)]


def _stays(each: Logged) -> bool:
    """Whether what was logged once may be so because it did not change since."""
    words, of_valve = (CHANNEL_NAMES[channel] for channel in ("setpoint_C", "heating_signal"))
    if says(plain(each.entity), f"{words.clear}|{words.weak}"):
        return True
    return each.is_words or (each.values[0] in (0.0, *ON) and says(plain(each.entity), of_valve.clear))
