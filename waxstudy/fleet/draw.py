"""The loops of a fleet, drawn: a row of random shares for each, so that a larger fleet begins with the same loops."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from waxstudy.plugin import Choice
from waxstudy.simulation.engine import Start
from waxstudy.simulation.ensemble import AIR_SPREAD_K, SLAB_SPREAD_K
from waxstudy.simulation.run import InputError
from waxstudy.study.activation import FLOW, SETPOINT, TABLE, Activation, FleetState, as_file, bare, of_block
from waxstudy.study.model import Case, Study
from waxstudy.study.spread import OneOf

FIXED = 5  # shares before those of the study's keys: start of air and slab, clock, pause, row of the table of rooms


@dataclass(frozen=True)
class Member:
    """One loop of a fleet: what was drawn for it, by key."""

    number: int
    room: str  # its row in a table of rooms, "" without one
    values: Mapping[str, Any]
    start: Start
    clock_s: float
    pause_share: float
    setpoint_C: float
    flow_share: float

    def pause_s(self, state: FleetState) -> float:
        """How long the loop is kept off in a state; of one distribution states have the same pauses."""
        return float(state.pause_s.at(self.pause_share)) if state.pause_s else 0.0

    @property
    def room_kind(self) -> str:
        """What loops with the same room have in common."""
        return repr(self.of("room"))

    def of(self, kind: str) -> dict[str, Any]:
        """Return what was drawn for the parameters of a kind."""
        keys = {key: of_block(key) for key in self.values}
        return {name: self.values[key] for key, (of, name) in keys.items() if of == kind}


def members(study: Study) -> list[Member]:
    """Return the loops of a study's fleet."""
    activation = study.activation
    assert activation
    call, draws = activation.call, activation.draws
    shares = np.random.default_rng(call.seed).random((call.loops, FIXED + len(draws)))
    return [_member(study, activation, number, row) for number, row in enumerate(shares.tolist())]


def _member(study: Study, activation: Activation, number: int, shares: Sequence[float]) -> Member:
    air, slab, clock, pause, place = shares[:FIXED]
    row = _row(activation, place)
    drawn = {
        key: spread.at(share) for (key, spread), share in zip(activation.draws.items(), shares[FIXED:], strict=True)
    }
    values = {**(row.values if row else {}), **drawn}
    return Member(
        number,
        row.name if row else "",
        values,
        Start(AIR_SPREAD_K * (2.0 * air - 1.0), SLAB_SPREAD_K * (2.0 * slab - 1.0)),
        _whole_steps(clock * activation.call.clock_spread_s, study.step_s),
        pause,
        float(values.get(SETPOINT, study.comfort.setpoint_C)),
        float(values.get(FLOW, 1.0)),
    )


def _whole_steps(seconds: float, step_s: float) -> float:
    """Return a time at which a step may start in any run: else a period that is heated ends with a gap."""
    return round(seconds / step_s) * step_s


def _row(activation: Activation, share: float) -> Any:
    rows = activation.rooms
    return OneOf(tuple(rows), tuple(row.loops for row in rows)).at(share) if rows else None


class Blocks:
    """The blocks of cases with what was drawn; a product stands for its times."""

    def __init__(self, study: Study) -> None:
        assert study.activation
        self.keys = [of_block(key) for key in study.activation.keys]
        self._bare: dict[tuple[str, str], Mapping[str, Any]] = {}

    def of(self, case: Case, member: Member) -> dict[str, Choice]:
        """Return the blocks of a loop."""
        return {kind: self._with(case.id, kind, choice, member) for kind, choice in case.blocks.items()}

    def room(self, choice: Choice, member: Member) -> Choice:
        """Return the room of a loop."""
        return self._with("", "room", choice, member)

    def _with(self, case: str, kind: str, choice: Choice, member: Member) -> Choice:
        """Raise `InputError` for values that are possible one by one and not together."""
        fields = type(choice.parameters).model_fields
        taken = {name: value for name, value in member.of(kind).items() if name in fields}
        if not taken:
            return choice
        if (case, kind) not in self._bare:
            self._bare[case, kind] = bare(choice, [name for of, name in self.keys if of == kind])
        try:
            return as_file(choice, {**self._bare[case, kind], **taken})
        except ValueError as error:
            told = "; ".join(line.strip() for line in str(error).splitlines()[1:3]) or str(error)
            raise InputError(TABLE, f"loop {member.number}: {kind} with {taken} cannot be: {told}", "draw") from error
