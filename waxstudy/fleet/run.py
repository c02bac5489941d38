"""Call a fleet: each finished batch of loops is kept at once, and a call that was interrupted goes on from there.

The folder is read by `waxstudy.fleet.result`; `batches/KEY.parquet` holds the rows of some loops, and its key is a
digest of all that they depend on.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import Any

import pandas as pd

from waxstudy.fleet import figures, response, summary
from waxstudy.fleet.batch import computed, course_of
from waxstudy.fleet.folder import BATCHES, LOOPS, MANIFEST, RESPONSE
from waxstudy.fleet.prepare import Fleet, prepared
from waxstudy.fleet.result import FORMAT
from waxstudy.plugin import SimulationError
from waxstudy.results.atomic import whole_file
from waxstudy.results.json_text import json_text
from waxstudy.results.parquet import write_parquet
from waxstudy.simulation.run import Progress
from waxstudy.simulation.software import software
from waxstudy.simulation.sources import digest
from waxstudy.study import activation, spread
from waxstudy.study.activation import FLOW, SETPOINT, of_block
from waxstudy.study.model import Study
from waxstudy.sweeps.point import key_of
from waxstudy.sweeps.run import Where, compute_points, is_whole, points_folder

BATCH = 20  # loops


def run(study: Study, folder: Path, workers: int, told: Progress, jit: bool = True) -> list[str]:
    """Compute the batches that the folder does not hold, and write what they come to; return warnings.

    Raises what `prepared` raises, `SimulationError`, `RunError` for a folder that holds something else or is in use,
    `OSError`, and `KeyboardInterrupt`; what was finished before that is kept.
    """
    with points_folder(folder, BATCHES, "activation"):
        fleet = prepared(study, jit)
        _warn_of_slow_blocks(fleet, told)
        batches = [range(a, min(a + BATCH, len(fleet.members))) for a in range(0, len(fleet.members), BATCH)]
        files = [folder / BATCHES / f"{key}.parquet" for key in _keys(fleet, batches)]
        told.total(len(batches))
        missing = {number: batch for number, batch in enumerate(batches) if not is_whole(files[number])}
        for _ in range(len(batches) - len(missing)):
            told.done(None, False)
        units = {**figures.UNITS, **units_of(study)}
        failing = replace(told, warn=_first(told.warn))  # no loop is left out: what failed first ends the command
        failed = compute_points(missing, files, Where("threads", workers), failing, partial(computed, fleet), units)
        if failed:
            raise SimulationError(failed[min(failed)])
        return _finish(fleet, folder, files, told)


def _first(tell: Callable[[str], None]) -> Callable[[str], None]:
    """Return what tells the first failure when it happens; those after it change nothing."""
    told: list[str] = []

    def once(text: str) -> None:
        if not told:
            reason = text.partition(": ")[2].removesuffix("; it is left out")
            tell(f"{reason}; the other batches are computed and kept, then the call ends")
        told.append(text)

    return once


def _warn_of_slow_blocks(fleet: Fleet, told: Progress) -> None:
    week = next(iter(fleet.study.weeks))
    found = [text for case in fleet.cases for text in course_of(fleet, fleet.members[0], week, case).warnings]
    for text in dict.fromkeys(found):
        told.warn(text)


def _keys(fleet: Fleet, batches: Sequence[range]) -> list[str]:
    """Return a digest for each batch of all that its rows depend on: a larger fleet begins with the same loops."""
    code = [
        *sorted(Path(__file__).parent.glob("*.py")),
        *(Path(module.__file__ or "") for module in (activation, spread)),
    ]
    said = fleet.activation.described()
    apart = ("loops", "cop", "idle_limit")
    stated = {key: value for key, value in said.items() if key not in apart}
    files = [fleet.activation.file] if fleet.activation.file else []
    common = digest([_key_of_cases(fleet.study), repr(stated), *code, *files])
    return [digest([common, repr(batch)]) for batch in batches]


def _key_of_cases(study: Study) -> str:
    """Return the digest of what a study says but for its fleet."""
    return key_of(replace(study, activation=None))


def units_of(study: Study) -> dict[str, str]:
    """Return the unit of each key that is drawn."""
    assert study.activation
    found = {SETPOINT: "C", FLOW: "1"}
    choices = [study.room, *(choice for case in study.cases.values() for choice in case.blocks.values())]
    for key in study.activation.keys:
        kind, name = of_block(key)
        for choice in choices:
            declared = type(choice.parameters).model_fields.get(name)
            if choice.component.kind == kind and declared and isinstance(declared.json_schema_extra, dict):
                found[key] = str(declared.json_schema_extra.get("unit") or "1")
    return found


def _finish(fleet: Fleet, folder: Path, files: Sequence[Path], told: Progress) -> list[str]:
    study, call = fleet.study, fleet.activation.call
    loops = _sorted(fleet, pd.concat([pd.read_parquet(file) for file in files], ignore_index=True))
    table = summary.rows(loops, call, study.step_s)
    warnings = list(summary.idle_warnings(table, call))
    told_of_loops = loops.drop(columns=list(figures.SERIES))
    used = [study.room, *study.weeks.values(), *(c for case in study.cases.values() for c in case.blocks.values())]
    said = {
        "format": FORMAT,
        "study": study.name,
        "step_s": study.step_s,
        "comfort_limit_C": study.comfort.operative_limit_C,
        "rooms": len(fleet.rooms),
        "activation": fleet.activation.described(),
        "table": [asdict(row) for row in table],
        "warnings": warnings,
        "provenance": software(choice.component for choice in used),
    }
    (folder / MANIFEST).unlink(missing_ok=True)
    with whole_file(folder / LOOPS) as path:
        write_parquet(told_of_loops, path, {**figures.UNITS, **units_of(study)})
    with whole_file(folder / RESPONSE) as path:
        write_parquet(response.response(loops, call, study.step_s), path, response.UNITS)
    with whole_file(folder / MANIFEST) as path:
        path.write_text(json_text(said))
    for warning in warnings:
        told.warn(warning)
    return warnings


def _sorted(fleet: Fleet, loops: pd.DataFrame) -> pd.DataFrame:
    """Return the rows by week, state, call and loop, in the order of the study."""
    order: dict[str, list[Any]] = {
        "week": list(fleet.study.weeks),
        "state": list(fleet.activation.states),
        "at_h": list(dict.fromkeys(fleet.activation.call.at_h)),
    }
    places = [loops[name].map({value: place for place, value in enumerate(known)}) for name, known in order.items()]
    keys = pd.DataFrame({"week": places[0], "state": places[1], "at_h": places[2], "loop": loops["loop"]})
    return loops.loc[keys.sort_values([*order, "loop"]).index].reset_index(drop=True)
