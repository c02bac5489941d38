"""A diagnosis from a dataset: segments, selection, what stays, how far the gap shrinks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from waxstudy.dataset.alike import alike
from waxstudy.dataset.baseline import refuse_too_short
from waxstudy.dataset.excerpt import excerpt
from waxstudy.dataset.read import Dataset
from waxstudy.dataset.stand_ins import GAINS, SUN, stand_ins
from waxstudy.diagnosis.assembly import Work, assembled, of_segment
from waxstudy.diagnosis.calibration.calibrate import Calibration, calibrate
from waxstudy.diagnosis.calibration.healthy import AsBelieved, Healthy
from waxstudy.diagnosis.calibration.room import CalibratedRoom
from waxstudy.diagnosis.calibration.stored import calibrated as stored
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.ladder_effects import ladder_effects
from waxstudy.diagnosis.model.edits import EffectType
from waxstudy.diagnosis.model.room_response import OF_ROOM, built
from waxstudy.diagnosis.model.segments import Segment, segments
from waxstudy.diagnosis.neighbours.judge import judged
from waxstudy.diagnosis.observations.counted import with_pulses
from waxstudy.diagnosis.observations.partition import FIT
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.result import Diagnosis
from waxstudy.diagnosis.select.changed import changed
from waxstudy.diagnosis.select.exact_room import with_exact_room
from waxstudy.diagnosis.select.posterior import Weighed
from waxstudy.diagnosis.select.search import Search, Selection, Tick, select
from waxstudy.diagnosis.select.testability import DRIVES, too_short
from waxstudy.diagnosis.select.timing import best_timed, is_moved_by_noise
from waxstudy.diagnosis.select.weigh import Weighing
from waxstudy.plugin import Belief, Effect
from waxstudy.plugin.registry import installed
from waxstudy.study.model import Study
from waxstudy.study.problems import Problem, StudyError

QUICK = 0.35  # of the fits' effort
Tell = Callable[[str, float], None]


def diagnose(
    dataset: Dataset,
    *,
    baseline: Dataset | None = None,
    seed: int = 1,
    quick: bool = False,
    study: Study | None = None,
    tick: Tell | None = None,
) -> Diagnosis:
    """Return where a dataset's gap lies, which effects cause it and how far it shrinks once they are added.

    The steps of a study's ladders are tried as effects too. With a `baseline`, a healthy record of the same loop, the
    question is what changed since. The same dataset and seed give the same diagnosis.
    `tick` is told what is being tried and the share done.
    """
    work = _work(dataset, baseline, seed, QUICK if quick else 1.0, study)
    cut, short = _cut(work)
    long_enough = [segment for segment in cut if segment not in short]
    selections = list(_selections(work, long_enough, tick or (lambda what, share: None)))
    return _with_neighbours(assembled(work, cut, short, selections, quick), dataset, tick or (lambda what, share: None))


def weighed_links(dataset: Dataset, baseline: Dataset | None) -> Iterator[tuple[Segment, Sequence[Weighed]]]:
    """Yield every link whose hypotheses are weighed, with them: what a posterior is made of."""
    work = _work(dataset, baseline)
    cut, short = _cut(work)
    for segment in (each for each in cut if each not in short):
        if _is_weighed(work, segment):
            effects, (whole, _) = of_segment(segment, work.effects), _problems(work, segment)
            yield segment, Weighing(whole, effects, _healthy(work, whole), work.thorough, lambda name: None).weighed()


def _work(
    dataset: Dataset,
    baseline: Dataset | None = None,
    seed: int = 1,
    thorough: float = 1.0,
    study: Study | None = None,
) -> Work:
    dataset = excerpt(dataset)
    if baseline:
        dataset, baseline = alike(dataset, excerpt(baseline))
    record = record_of(dataset)
    effects = [*installed_effects(), *(ladder_effects(study) if study else ())]
    # the steps of a study are made as it is read, and no cache can tell them
    calibration = calibrated(baseline, effects, thorough, is_kept=study is None) if baseline else None
    calibration = calibration.seen_in(record) if calibration else None
    return Work(dataset, record, _documented(dataset, record), effects, seed, thorough, calibration, baseline)


def _cut(work: Work) -> tuple[list[Segment], dict[Segment, str]]:
    """Return the segments of a record, and why some of them cannot be judged."""
    # By the documents' room, as only that says how a sun may be meant. How far a curve was off is no change.
    cut = [each for each in segments(work.record, work.documented) if not (work.calibration and each.is_supply)]
    return cut, {each: reason for each in cut if (reason := too_short(each, work.record, work.belief))}


def _problems(work: Work, segment: Segment) -> tuple[SegmentProblem, SegmentProblem]:
    """Return a link with all its days to fit, and with days held out."""
    parts = np.full(len(work.record), FIT)
    about = segment, work.record, work.documented
    whole = SegmentProblem(*about, as_built=work.as_built, parts=parts)
    problem = SegmentProblem(*about, as_built=work.as_built, alike=whole)
    if not is_moved_by_noise(whole):
        return whole, problem
    _base(work, Estimator(whole, work.thorough))
    fits, noisy = best_timed(whole, of_segment(segment, work.effects), work.thorough)
    return whole.timed_by(fits, noisy), problem.timed_by(fits, noisy)


def _is_weighed(work: Work, segment: Segment) -> bool:
    """Whether it is known what a link leaves where nothing is amiss: of a chain noise; of a room a baseline tells."""
    return segment.name in work.healthy or not (segment.with_room or segment.is_supply)


def _healthy(work: Work, whole: SegmentProblem) -> Healthy:
    """Return what nothing amiss leaves of a link: what a healthy record shows, else what noise makes."""
    healthy = work.healthy.get(whole.segment.name)
    return healthy or AsBelieved.of(whole, whole.timed or _base(work, Estimator(whole, work.thorough)))


def _with_neighbours(diagnosis: Diagnosis, dataset: Dataset, tick: Tell) -> Diagnosis:
    """Return a diagnosis with what the rooms that were measured beside each other tell."""
    if dataset.neighbours is None:
        return diagnosis
    beside = judged(dataset.neighbours, tick)
    diagnosis = replace(diagnosis, neighbours=beside)
    if diagnosis.verdict not in ("none", "untestable"):
        return diagnosis
    if diagnosis.verdict == "untestable" or beside.events:
        return replace(diagnosis, verdict="room" if beside.events else "none", summary=beside.sentence)
    return diagnosis


def calibrated(
    baseline: Dataset, effects: Sequence[EffectType], thorough: float = 1.0, is_kept: bool = False
) -> Calibration:
    """Return what a healthy record of the loop says of it, as it was told before where that may be kept."""
    record = record_of(baseline)
    documented = _documented(baseline, record)
    try:
        found = (stored if is_kept else calibrate)(record, documented, effects, thorough, baseline.room_tolerance)
    except ValueError as error:
        raise _wrong(baseline, str(error), "[nominal]") from error
    # a link in which too little happened was calibrated on nothing
    return found.without({each.name for each in segments(record, documented) if too_short(each, record, documented)})


def calibrated_room(dataset: Dataset) -> CalibratedRoom:
    """Return the room of a healthy record as it was built; raise `StudyError` where it does not show its room."""
    if dataset.room is None:
        raise _wrong(dataset, "there is no room to calibrate", "[building]", "tell it in [building] or [room]")
    refuse_too_short(dataset)
    dataset = excerpt(dataset)
    record = record_of(dataset)
    documented = _documented(dataset, record)
    of_room = [each for each in segments(record, documented) if each.with_room and not each.is_supply]
    if not of_room:
        lacking = [channel for channel in DRIVES if not record.has(channel)]
        seen = f"it lacks {', '.join(lacking)}" if lacking else f"it needs one of {', '.join(OF_ROOM)}"
        raise _wrong(dataset, f"the record does not show what the room does: {seen}", "")
    if all(whys := [too_short(each, record, documented) for each in of_room]):
        raise _wrong(dataset, f"the record does not show what the room does: {whys[0]}", "")
    days = dataset.days[[0, -1]].strftime("%Y-%m-%d")
    calibration = calibrated(dataset, installed_effects())
    return CalibratedRoom.of(calibration, documented, dataset.name, dataset.origin, (days[0], days[1]))


def _documented(dataset: Dataset, record: Record) -> Belief:
    return dataset.believed(record.inputs if record.has_inputs else None)


def _wrong(dataset: Dataset, wrong: str, where: str, allowed: str = "") -> StudyError:
    return StudyError([Problem(str(dataset.folder / "dataset.toml"), 0, where, "", "", wrong, allowed=allowed)])


def record_of(dataset: Dataset) -> Record:
    """Return the record of a dataset, its setpoint as believed where none is recorded."""
    values = {str(name): column.to_numpy(dtype=float) for name, column in dataset.values.items()}
    if "setpoint_C" in values and np.isfinite(values["setpoint_C"]).any():
        # loggers write it down when it changes
        values["setpoint_C"] = dataset.values["setpoint_C"].ffill().bfill().to_numpy(dtype=float)
    elif dataset.setpoint_C is not None:
        values["setpoint_C"] = np.full(len(dataset.time), dataset.setpoint_C)
    first = dataset.time[0]
    start_s = (first - first.normalize()).total_seconds() - dataset.interval_s
    about = dataset.interval_s, start_s, values, dataset.noise, dataset.assumed
    record = with_pulses(Record(*about, first_weekday=first.day_of_week, spreads=dataset.spreads))
    lacking = [channel for channel in (SUN, GAINS) if not record.has(channel)]
    if dataset.room is None or not record.has_inputs or not lacking:
        return record
    room = built(dataset.room)
    about_sun = dataset.site, values, dataset.spreads
    return replace(record, stand_ins=stand_ins(lacking, room, dataset.time, dataset.interval_s, *about_sun))


def installed_effects() -> list[EffectType]:
    """Return the effects that are installed, by name."""
    found = (entry.component for (kind, _), entry in sorted(installed().components.items()) if kind == "effect")
    return [component for component in found if issubclass(component, Effect)]


def _selections(work: Work, cut: Sequence[Segment], tick: Tell) -> Iterator[Selection]:
    total = sum(len(of_segment(segment, work.effects)) + 1 for segment in cut) or 1
    done = 0
    for place, segment in enumerate(cut):
        effects = of_segment(segment, work.effects)
        first = done

        def step(name: str, at: int = first, most: int = len(effects)) -> None:
            nonlocal done
            done = min(done + 1, at + most)
            tick(name, done / total)

        tick(segment.name, done / total)
        if _is_weighed(work, segment):
            yield _changed(work, segment, effects, work.seed + place, step)
            done = first + len(effects) + 1
            continue
        selection = _selection(work, segment, effects, work.seed + place, step)
        if selection.is_late:
            again = _selection(work, segment, effects, work.seed + place, step, holds_out=False)
            selection = again if again.found else selection
        yield with_exact_room(selection, effects, work.seed + place, step)
        done = first + len(effects) + 1


def _changed(work: Work, segment: Segment, effects: Sequence[EffectType], seed: int, tick: Tick) -> Selection:
    """Return what is otherwise at a link than in the healthy record, or than believed."""
    whole, problem = _problems(work, segment)
    estimator = Estimator(problem, work.thorough, keeps=True)
    search = Search(estimator, effects, np.random.default_rng(seed), lambda name: None)
    return changed(search, _healthy(work, whole), whole, tick)


def _selection(
    work: Work, segment: Segment, effects: Sequence[EffectType], seed: int, tick: Tick, holds_out: bool = True
) -> Selection:
    tolerance = work.dataset.room_tolerance
    problem = SegmentProblem(segment, work.record, work.belief, tolerance, holds_out)
    estimator = Estimator(problem, work.thorough)
    _base(work, estimator)
    return select(estimator, effects, seed, tick)


def _base(work: Work, estimator: Estimator[SegmentProblem]) -> Hypothesis:
    """Return the belief itself at a link; raise `StudyError` where it cannot be simulated."""
    try:
        return estimator.base
    except ValueError as error:
        where = "[room]" if estimator.problem.segment.stages[0] == "emitter" else "[nominal]"
        raise _wrong(work.dataset, str(error), where) from error
