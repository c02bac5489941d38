"""`[activation]`: a fleet of loops, the call that it gets, and the states in which the call finds it."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, Self

from pydantic import model_validator

from waxstudy.plugin import CHAIN, Choice, Parameters, parameter
from waxstudy.study.spread import Spread

TABLE = "activation"
SETPOINT, FLOW = "setpoint_C", "flow_share"  # what is drawn for a loop beside parameters of its room and blocks
MOST_ROOMS = 100  # that are built: loops share rooms
FEWEST, MOST = 10, 10_000  # loops


class ActivationTable(Parameters):
    """`[activation]`: a fleet of loops is switched on or off; `[activation.draw]` and `[activation.state]` beside."""

    loops: int = parameter(100, unit="1", description="loops of the fleet", source="chosen", ge=FEWEST, le=MOST)
    seed: int = parameter(1, unit="1", description="seed of what is drawn", source="chosen", ge=0)
    signal: Literal["on", "off"] = parameter(
        "on", unit="", description="what the call switches all loops to", source="given by the user"
    )
    at_h: tuple[float, ...] = parameter(
        unit="h",
        description="times of the call, from the start of the week; each finds the fleet undisturbed by the others",
        source="given by the user",
        min_length=1,
        max_length=24,
    )
    lasts_s: float = parameter(
        900.0,
        unit="s",
        description="how long the call lasts",
        source="section 1: loads are switched within 5 to 15 min",
        gt=0.0,
        le=14400.0,
    )
    limit_s: float = parameter(
        300.0,
        unit="s",
        description="time within which a loop has to answer",
        source="section 1 and research question 2: 5 min",
        gt=0.0,
        le=14400.0,
    )
    rebound_h: float = parameter(
        6.0, unit="h", description="how long the fleet is watched after the call", source="chosen", ge=0.0, le=72.0
    )
    cop: float = parameter(
        3.0,
        unit="1",
        description="heat that a heat pump gives for its electricity, for the table of reserve",
        source="chosen: supply at 30 C in winter",
        gt=0.0,
        le=20.0,
    )
    clock_spread_s: float = parameter(
        3600.0,
        unit="s",
        description="loops' clocks, by which modulators begin their periods, differ by up to this",
        source="chosen: the period of the paper's modulation",
        ge=0.0,
        le=86400.0,
    )
    idle_limit: float = parameter(
        0.01,
        unit="1",
        description="share of the full flow above which water that flows while nobody asks is warned of",
        source="chosen: 1 % of the full heat",
        ge=0.0,
        le=1.0,
    )

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if self.limit_s >= self.lasts_s:
            raise ValueError(f"limit_s = {self.limit_s:g} must be less than lasts_s = {self.lasts_s:g}")
        if len(set(self.at_h)) < len(self.at_h):
            raise ValueError("at_h holds a time twice: each call finds the fleet undisturbed by the others")
        return self


class StateTable(Parameters):
    """`[activation.state.NAME]`: a state in which the call finds the fleet; `pause_s` is a distribution."""

    case: str = parameter(unit="", description="case whose chain the loops have", source="given by the user")
    preheat_s: float = parameter(
        0.0,
        unit="s",
        description="how long loops are heated just before the call",
        source="chosen: none",
        ge=0.0,
        le=86400.0,
    )


@dataclass(frozen=True)
class FleetState:
    """A state: the case whose chain its loops have, and what is done to them before the call.

    Without `pause_s` the controllers are left to themselves; else all are kept off for a time drawn from it.
    """

    name: str
    case: str
    preheat_s: float
    pause_s: Spread | None

    @property
    def longest_s(self) -> float:
        """The longest time before the call in which a loop is not left to itself."""
        return self.preheat_s + (max(self.pause_s.ends) if self.pause_s else 0.0)

    def described(self) -> dict[str, object]:
        pause = {} if self.pause_s is None else {"pause_s": self.pause_s.described()}
        return {"case": self.case, "preheat_s": self.preheat_s, **pause}


@dataclass(frozen=True)
class RoomRow:
    """A row of a table of rooms: so many loops have these values."""

    name: str
    loops: float
    values: Mapping[str, Any]
    line: int = 0


@dataclass(frozen=True)
class Activation:
    """What `[activation]` says. Keys of draws and rows are `room.KEY`, `BLOCK.KEY`, `setpoint_C` or `flow_share`."""

    call: ActivationTable
    states: Mapping[str, FleetState]
    draws: Mapping[str, Spread]
    rooms: Sequence[RoomRow] = ()
    file: Path | None = None  # the table of rooms

    @property
    def keys(self) -> list[str]:
        """All that a loop is drawn by, those of the table of rooms first."""
        return [*(self.rooms[0].values if self.rooms else ()), *self.draws]

    def described(self) -> dict[str, Any]:
        rooms = {"rooms": str(self.file)} if self.file else {}
        return {
            **self.call.model_dump(mode="json"),
            **rooms,
            "draw": {key: spread.described() for key, spread in self.draws.items()},
            "state": {name: state.described() for name, state in self.states.items()},
        }


def of_block(key: str) -> tuple[str, str]:
    """Return kind and parameter of a key such as `actuator.product` or `room.height_m`; no kind for others."""
    kind, _, name = key.partition(".")
    return (kind, name) if kind in ("room", *CHAIN) else ("", key)


def bare(choice: Choice, keys: Sequence[str] = ()) -> dict[str, Any]:
    """Return as few parameters as say the same, without those of these keys, which are to be given others.

    A product stands for its times: where it is another one, times that came of it must not be left over.
    """
    stated = {key: value for key, value in choice.described().items() if key != "use"}
    for key in list(stated):
        less = {name: value for name, value in stated.items() if name != key}
        if key not in keys and _says(choice, less):
            stated = less
    return {key: value for key, value in stated.items() if key not in keys}


def _says(choice: Choice, stated: Mapping[str, Any]) -> bool:
    try:
        return as_file(choice, stated).described() == choice.described()
    except Exception:  # a stranger's check may raise anything
        return False


def as_file(choice: Choice, stated: Mapping[str, Any]) -> Choice:
    """Return a component of the same kind with parameters as a file states them; raise `ValueError`."""
    model = choice.component.Parameters
    return Choice(choice.component, model.model_validate_json(json.dumps(dict(stated), default=str)))
