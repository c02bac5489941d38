"""A diagnosis from a dataset: links, selection, what stays, how far the gap shrinks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from waxstudy.dataset.read import Dataset
from waxstudy.gap.assembly import Work, assembled, of_link
from waxstudy.gap.fit import Fitter
from waxstudy.gap.ladder import ladder_effects
from waxstudy.gap.letter import to_the_letter
from waxstudy.gap.links import Link, links
from waxstudy.gap.record import Record
from waxstudy.gap.result import Diagnosis
from waxstudy.gap.select import Selection, Tick, select
from waxstudy.gap.space import EffectType
from waxstudy.gap.testable import too_short
from waxstudy.plugin import Effect, Inputs
from waxstudy.plugin.registry import installed
from waxstudy.study.model import Study
from waxstudy.study.problems import Problem, StudyError

QUICK = 0.35  # of the fits' effort
Tell = Callable[[str, float], None]


def diagnose(
    dataset: Dataset,
    *,
    seed: int = 1,
    quick: bool = False,
    study: Study | None = None,
    tick: Tell | None = None,
) -> Diagnosis:
    """Return where a dataset's gap lies, which effects cause it and how far it shrinks once they are added.

    The steps of a study's ladders are tried as effects too. The same dataset and seed give the same diagnosis.
    `tick` is told what is being tried and the share done.
    """
    record = record_of(dataset)
    belief = dataset.believed(_inputs(record))
    effects = [*installed_effects(), *(ladder_effects(study) if study else ())]
    work = Work(dataset, record, belief, effects, seed, QUICK if quick else 1.0)
    cut = links(record, belief)
    short = {link: reason for link in cut if (reason := too_short(link, record, belief))}
    judged = [link for link in cut if link not in short]
    selections = list(_selections(work, judged, tick or (lambda what, share: None)))
    return assembled(work, cut, short, selections, quick)


def record_of(dataset: Dataset) -> Record:
    """Return the record of a dataset, its setpoint as believed where none is recorded."""
    values = {str(name): column.to_numpy(dtype=float) for name, column in dataset.values.items()}
    if "setpoint_C" in values:
        # loggers write it down when it changes
        values["setpoint_C"] = dataset.values["setpoint_C"].ffill().bfill().to_numpy(dtype=float)
    elif dataset.setpoint_C is not None:
        values["setpoint_C"] = np.full(len(dataset.time), dataset.setpoint_C)
    first = dataset.time[0]
    start_s = (first - first.normalize()).total_seconds() - dataset.interval_s
    return Record(dataset.interval_s, start_s, values, dataset.noise, dataset.assumed)


def _inputs(record: Record) -> Inputs | None:
    return record.inputs if record.has_inputs else None


def installed_effects() -> list[EffectType]:
    """Return the effects that are installed, by name."""
    found = (entry.component for (kind, _), entry in sorted(installed().components.items()) if kind == "effect")
    return [component for component in found if issubclass(component, Effect)]


def _selections(work: Work, cut: Sequence[Link], tick: Tell) -> Iterator[Selection]:
    total = sum(len(of_link(link, work.effects)) + 1 for link in cut) or 1
    done = 0
    for place, link in enumerate(cut):
        effects = of_link(link, work.effects)
        first = done

        def step(name: str, at: int = first, most: int = len(effects)) -> None:
            nonlocal done
            done = min(done + 1, at + most)
            tick(name, done / total)

        tick(link.name, done / total)
        selection = _selection(work, link, effects, work.seed + place, step)
        if selection.is_late:
            again = _selection(work, link, effects, work.seed + place, step, holds_out=False)
            selection = again if again.found else selection
        yield to_the_letter(selection, effects, work.seed + place, step)
        done = first + len(effects) + 1


def _selection(
    work: Work, link: Link, effects: Sequence[EffectType], seed: int, tick: Tick, holds_out: bool = True
) -> Selection:
    fitter = Fitter(link, work.record, work.belief, work.thorough, work.dataset.room_tolerance, holds_out)
    try:
        assert fitter.base
    except ValueError as error:
        raise StudyError([_impossible(work.dataset, link, str(error))]) from error
    return select(fitter, effects, seed, tick)


def _impossible(dataset: Dataset, link: Link, reason: str) -> Problem:
    where = "[room]" if link.stages[0] == "emitter" else "[nominal]"
    return Problem(str(dataset.folder / "dataset.toml"), 0, where, "", "", reason)
