"""Expanding a ladder: a step merges into the case before it, on the raw values, before defaults are filled in."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from waxstudy.plugin import CHAIN
from waxstudy.plugin.registry import nearest
from waxstudy.study.check import Check
from waxstudy.study.fragment import FROM, included
from waxstudy.study.model import NAME_RULE, is_safe_name
from waxstudy.study.problems import listed
from waxstudy.study.spots import RawTable, Spot

START = 'must be a table such as { id = "...", controller = { use = "..." } }'
STEP = 'must be a table such as { id = "...", sensor = { use = "..." } }'
KEYS = ("reference", "start", "steps")
STEPS = "must be a list of tables: [ { id = ... }, ... ]"


@dataclass(frozen=True)
class RawCase:
    """A case before its parameters are checked."""

    id: str
    spot: Spot
    blocks: Mapping[str, RawTable]


@dataclass(frozen=True)
class RawLadder:
    name: str
    reference: str
    cases: list[RawCase]


def read_ladder(check: Check, name: str) -> RawLadder:
    """Return a ladder's cases, each with all of its blocks; note what is wrong with its form."""
    spot = Spot.table("ladder", name)
    table = check.table(spot) or {}
    check.unknown_keys(spot, table, KEYS)
    cases: list[RawCase] = []
    blocks: dict[str, RawTable] = {}
    for place, values in _entries(check, spot, table):
        case = _case(check, place, values, blocks)
        blocks = dict(case.blocks)
        cases.append(case)
    if cases and "controller" not in table["start"]:
        allowed = f"installed: {listed(check.registry.names('controller'))}"
        check.problem(cases[0].spot.at("controller"), "missing: a chain needs a controller", allowed=allowed)
    return RawLadder(name, _reference(check, spot, table, cases), cases)


def _entries(check: Check, ladder: Spot, table: Mapping[str, Any]) -> Iterator[tuple[Spot, dict[str, Any]]]:
    """Yield the start and each step; without a start the steps have nothing to change."""
    start, steps = table.get("start"), table.get("steps", [])
    if start is None:
        check.problem(ladder.at("start"), f"missing: {START}")
        return
    if not isinstance(start, dict):
        check.problem(ladder.at("start"), START, value=start)
        return
    yield ladder.at("start"), start
    if not isinstance(steps, list):
        check.problem(ladder.at("steps"), STEPS, value=steps)
        return
    for i, step in enumerate(steps):
        if isinstance(step, dict):
            yield ladder.at("steps", i), step
        else:
            check.problem(ladder.at("steps", i), STEP, value=step)


def _case(check: Check, place: Spot, values: dict[str, Any], before: Mapping[str, RawTable]) -> RawCase:
    """Return the case that a start or step makes of the blocks before it."""
    id = values.get("id")
    if is_safe_name(id):
        place = Spot(f"case {id}", place.path, len(place.path))
    elif id is None:
        check.problem(place.at("id"), "missing: every case needs one")
    else:
        check.problem(place.at("id"), NAME_RULE, value=id)
    check.unknown_keys(place, values, ("id", *CHAIN))
    blocks = dict(before)
    for kind in CHAIN:
        if kind in values:
            merge_block(check, blocks, kind, values[kind], place.at(kind))
    return RawCase(id if isinstance(id, str) else "", place, {kind: blocks[kind] for kind in CHAIN if kind in blocks})


def merge_block(check: Check, blocks: dict[str, RawTable], kind: str, block: Any, spot: Spot) -> None:
    """Put what a table says of a block of this kind upon what was there before; note it if it is no table."""
    if not isinstance(block, dict):
        example = block if isinstance(block, str) and block in check.registry.names(kind) else "..."
        check.problem(spot, f'must be a table such as {{ use = "{example}" }}', value=block)
    elif FROM in block:
        taken = included(check, kind, block, spot)
        if taken is not None:
            blocks[kind] = taken
    elif kind in blocks:
        blocks[kind] = blocks[kind].merged(block, spot)
    else:
        blocks[kind] = RawTable.of(block, spot)


def _reference(check: Check, ladder: Spot, table: Mapping[str, Any], cases: list[RawCase]) -> str:
    reference, ids = table.get("reference"), list(dict.fromkeys(case.id for case in cases if case.id))
    spot, allowed = ladder.at("reference"), f"cases: {listed(ids)}"
    if reference is None:
        check.problem(spot, "missing: the case that the others are compared with", allowed=allowed)
    elif cases and reference not in ids and not _lacks_steps(table):
        near = nearest(str(reference), ids)
        check.problem(spot, "is no case of this ladder", value=reference, near=near, allowed=allowed)
    return str(reference)


def _lacks_steps(table: Mapping[str, Any]) -> bool:
    """Whether the steps may stand under a misspelt key, which is then the only problem to tell."""
    return "steps" not in table and any(key not in KEYS for key in table)
