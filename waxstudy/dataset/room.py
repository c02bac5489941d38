"""Whether the room of a dataset can be built, and can take what was recorded."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from waxstudy.dataset.building import BUILDING, ROOM, noted
from waxstudy.dataset.notes import Notes
from waxstudy.dataset.stand_ins import ROLES, SUPPLY_AIR
from waxstudy.plugin import LinearRoom, Role, Room
from waxstudy.plugin.model_error import ASSUMED, DOUBLED
from waxstudy.plugin.registry import PluginError, told
from waxstudy.plugin.shapes import lost_problems, model_error_problems, room_problems
from waxstudy.study.check import Check
from waxstudy.study.model import Choice
from waxstudy.study.spots import Spot

if TYPE_CHECKING:
    import pandas as pd


def built(check: Check, room: Choice | None) -> LinearRoom | None:
    """Return the room that is believed, if there is one; note why it cannot be built, or what is wrong with it."""
    if room is None:
        return None
    component: type[Room] = room.component  # type: ignore[assignment]

    def build() -> LinearRoom:
        made = component.build(room.parameters)
        for problem in room_problems(made):
            raise PluginError(problem)
        return made

    return noted(check, _spot(check), component, build)


def look_at_roles(check: Check, room: LinearRoom, values: pd.DataFrame, notes: Notes) -> None:
    """Note what is recorded, and no input of the room has the role for."""
    recorded = {role: values[name].to_numpy(float) for name, role in ROLES.items() if name in values}
    for problem in lost_problems(room, recorded):
        check.problem(_spot(check), problem, allowed="leave them out of the record, or give a room that takes them")
    if SUPPLY_AIR in values and not room.places(Role.SUPPLY_AIR):
        notes.warn(f"{SUPPLY_AIR} is not used: no input of the room has the role {Role.SUPPLY_AIR}")


def look_at_model_errors(check: Check, room: Choice, factor: float, notes: Notes) -> None:
    """Note what is assumed of the error of the room's model, or what is wrong with what the room states of it."""
    component: Any = room.component
    try:
        with told(f"room '{component.name}'"):
            stated = component.model_errors(room.parameters)
            for problem in model_error_problems(stated):
                raise PluginError(problem)
    except PluginError as error:
        check.problem(_spot(check), str(error), of_plugin=True)
        return
    lacking = [f"{e.typical_K:g} K of {o} (at most {e.most_K:g} K)" for o, e in ASSUMED.items() if o not in stated]
    if lacking:
        what = f"Room '{component.name}' states no error of its model"
        notes.assume(f"{what}; assumed is {', '.join(lacking)}: {DOUBLED}.")
    if factor != 1.0:
        notes.assume(f"The error of the room's model is taken {factor:g} times, as [dataset] room_error_factor says.")


def _spot(check: Check) -> Spot:
    return ROOM if check.source.values.get("room") else BUILDING
