"""The size of what was put in: the true gap beside its noise, and what nobody could tell from it.

A true gap is that of one stage without noise: what the stage would give without the cause, driven by what truly came
before it, against what it gave. It is judged in the currency of a diagnosis: seconds of a switch, quarters of an hour
of a room.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from waxstudy.blind_test.draw import Case
from waxstudy.blind_test.record import shown, without_noise
from waxstudy.dataset.read import Dataset
from waxstudy.diagnosis.diagnose import installed_effects, record_of
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.estimate.residual import Residual
from waxstudy.diagnosis.model.conventions import Convention
from waxstudy.diagnosis.model.predicted import Predicted
from waxstudy.diagnosis.model.segments import Segment, segments
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.residuals.continuous import Continuous
from waxstudy.diagnosis.residuals.judge import Judge
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.residuals.switching import Switching
from waxstudy.plugin import Belief, Choice
from waxstudy.plugin.trial import Cause, Staged
from waxstudy.synthetic.effects import EffectError, applied

THOROUGH = 4.0  # times the points that a diagnosis looks at first: an alike effect must not be missed here
ROUGH = 0.35  # the same of a measured house, whose priors are so wide that every fit is long
HARDLY = 0.3  # of what is missed of a measured record anyway
CONTINUOUS = "control_output"  # where it runs on: without noise of its own, moved by that of the sensor
LEAST = 1e-9  # a floor of nothing at all would make any gap a large one

Gaps = dict[str, float]


@dataclass(frozen=True)
class Size:
    """The true gap of a cause on the channel where it stands out most.

    `beyond` is the largest gap over its floor that is left when all that nobody knows of the room is fitted; `alike`
    are the effects whose refit to the record without noise leaves less than the floor: nobody could tell them apart.
    """

    segment: str
    channel: str
    gap: float
    floor: float
    beyond: float
    alike: tuple[str, ...]

    @property
    def over(self) -> float:
        return self.gap / self.floor


@dataclass(frozen=True)
class Stand:
    """A record with and without noise, and what is believed of it."""

    noisy: Record
    free: Record  # judged with the noisy one's weights
    noisy_belief: Belief
    belief: Belief
    room_tolerance: float
    thorough_room: float

    @classmethod
    def of(cls, seen: Dataset, free: Dataset, thorough_room: float = 1.0) -> Stand:
        noisy = record_of(seen)
        clean = replace(record_of(free), stated_noise=noisy.noise)
        return cls(noisy, clean, _belief(seen, noisy), _belief(free, clean), seen.room_tolerance, thorough_room)

    def segment_of(self, cause: Cause) -> Segment | None:
        """Return the segment that shows a cause's own stage, or None."""
        found = segments(self.noisy, self.noisy_belief)
        return next((segment for segment in found if cause.stages[0] in segment.stages and not segment.is_supply), None)

    def fitter(self, segment: Segment, record: Record, belief: Belief) -> Estimator[SegmentProblem]:
        thorough = self.thorough_room if segment.with_room else THOROUGH
        return Estimator(SegmentProblem(segment, record, belief, self.room_tolerance), thorough)


def _belief(dataset: Dataset, record: Record) -> Belief:
    return dataset.believed(record.inputs if record.has_inputs else None)


def sizes(case: Case, staged: Staged, seen: Dataset, with_alike: bool = True) -> list[Size | None]:
    """Return the size of each cause, None where the record has no channel that shows its stage, or lacks its drive."""
    if not case.causes:
        return []
    stand = Stand.of(seen, without_noise(staged, case.measured), ROUGH if staged.is_measured else 1.0)
    found = []
    for place, cause in enumerate(case.causes):
        segment = stand.segment_of(cause)
        try:
            found.append(_how(staged, place)(case, staged, stand, segment, place, with_alike) if segment else None)
        except EffectError:
            found.append(None)  # as pipes where no flow is recorded
    return found


def _how(staged: Staged, place: int) -> Callable[..., Size]:
    if staged.is_measured:
        return _of_house
    return _of_effect if staged.effects[place] is not None else _of_channels


# --- a cause that is an edit of what is believed ---


def _of_effect(case: Case, staged: Staged, stand: Stand, segment: Segment, place: int, with_alike: bool) -> Size:
    choices = [choice for choice in staged.effects if choice is not None]
    own = staged.effects[place]
    assert own
    floors, true_gaps = gap_and_floor(stand, segment, choices, own)
    belief = applied([choice for choice in choices if choice is not own], stand.belief)
    form = dict.fromkeys(floors, 0.0)
    return _sized(stand.fitter(segment, stand.free, belief), case.causes[place], true_gaps, floors, form, with_alike)


def gap_and_floor(stand: Stand, segment: Segment, choices: Sequence[Choice], own: Choice) -> tuple[Gaps, Gaps]:
    """Return floor and true gap of each channel of a segment, for one of the effects that are true.

    The floor is what the truth itself misses of the noisy record, driven by that; the gap what the rest of the truth
    misses of the record without noise, driven by that.
    """
    truth, noisy_truth = applied(choices, stand.belief), applied(choices, stand.noisy_belief)
    belief = applied([choice for choice in choices if choice is not own], stand.belief)
    free, seen = stand.fitter(segment, stand.free, stand.belief), stand.fitter(segment, stand.noisy, stand.noisy_belief)
    convention = min(segment.conventions, key=lambda each: sum(e.loss() for e in missed(free, truth, each)))
    noise = Judge(segment, stand.noisy, noisy_truth)
    floors = gaps(noise.residuals(seen.problem.predicted(noisy_truth, convention)))
    # no switch is known better than to the interval
    floors |= {c: max(floors[c], typical_s(noise, c)) for c in segment.judged if c in stand.noisy.binary}
    return floors, gaps(missed(free, belief, convention))


# --- a cause in an engine's own terms, or of the logger ---


def _of_channels(case: Case, staged: Staged, stand: Stand, segment: Segment, place: int, with_alike: bool) -> Size:
    belief = applied([c for c in staged.effects if c is not None], stand.belief)
    null = _null_record(case, staged, stand.free, place)
    judge = Judge(segment, stand.free, belief)
    true_gaps = gaps(judge.residuals(_as_measured(segment, null, belief)))
    noise = Judge(segment, stand.noisy, belief)
    floors = gaps(noise.residuals(_as_measured(segment, stand.free, belief)))
    floors |= {channel: typical_s(noise, channel) for channel in segment.judged if channel in stand.noisy.binary}
    if CONTINUOUS in segment.judged and CONTINUOUS not in stand.noisy.binary:
        floors[CONTINUOUS] = max(floors[CONTINUOUS], moved(noise))
    form = gaps(stand.fitter(segment, null, belief).base.residuals) if with_alike else {}
    return _sized(stand.fitter(segment, stand.free, belief), case.causes[place], true_gaps, floors, form, with_alike)


def _null_record(case: Case, staged: Staged, free: Record, place: int) -> Record:
    """Return the record without noise in which what a cause changes is as it would be without it."""
    still = replace(staged, channels={**staged.channels, **staged.without[place]})
    table = shown(still, case.measured, noise=False)
    changed = {str(n): table[n].to_numpy(dtype=float) for n in table.columns[1:] if str(n) in free.values}
    return replace(free, values={**free.values, **changed})


def _as_measured(segment: Segment, record: Record, belief: Belief) -> Predicted:
    """Return a record's channels as those of a segment are judged."""
    judge = Judge(segment, record, belief)
    return Predicted({channel: judge.ways[channel].measured for channel in segment.judged})


# --- a record that was measured ---


def _of_house(case: Case, staged: Staged, stand: Stand, segment: Segment, place: int, with_alike: bool) -> Size:
    """Return how far an alteration moves what is missed, beside what is missed of the untouched record.

    Both with the room as fitted to the untouched record. Alike is what leaves hardly more of the altered one.
    """
    null = _null_record(case, staged, stand.free, place)
    untouched = stand.fitter(segment, null, replace(stand.belief, inputs=null.inputs))
    altered, base = stand.fitter(segment, stand.free, stand.belief), untouched.base
    moved = altered.problem.at((), base.departures, base.convention)
    assert moved
    floors = gaps(base.residuals)
    pairs = zip(moved.residuals, base.residuals, strict=True)
    true_gaps = gaps([replace(new, error=new.error - old.error) for new, old in pairs])
    form = {channel: HARDLY * floor for channel, floor in floors.items()}
    return _sized(altered, case.causes[place], true_gaps, floors, form, with_alike)


# --- all ---


def _sized(
    fitter: Estimator[SegmentProblem], own: Cause, true_gaps: Gaps, floors: Gaps, form: Gaps, with_alike: bool
) -> Size:
    channel = max(true_gaps, key=lambda name: true_gaps[name] / max(floors[name], LEAST))
    gap, floor = true_gaps[channel], max(floors[channel], LEAST)
    beyond, names = 0.0, []
    if with_alike:
        beyond = over(gaps(fitter.base.residuals), {c: math.hypot(floors[c], form.get(c, 0.0)) for c in floors})
        names = list(_alike(fitter, own, floors, form)) if gap > floor else []
    return Size(fitter.problem.segment.name, channel, gap, floor, beyond, tuple(names))


def _alike(fitter: Estimator[SegmentProblem], own: Cause, floors: Gaps, form: Gaps) -> Iterable[str]:
    """Yield the effects that explain the record without noise but for the floor, and for what the form leaves."""
    for effect in installed_effects():
        if effect.name != own.name and effect.stage in fitter.problem.segment.stages:
            fitted = fitter.fit(effect, fitter.base)
            if fitted is not None and is_alike(fitted, floors, form):
                yield effect.name


def is_alike(fitted: Hypothesis, floors: Mapping[str, float], form: Mapping[str, float]) -> bool:
    left = gaps(fitted.residuals)
    return all(left[c] ** 2 <= floors[c] ** 2 + form.get(c, 0.0) ** 2 for c in left)


def missed(fitter: Estimator[SegmentProblem], belief: Belief, convention: Convention) -> list[Residual]:
    return Judge(fitter.problem.segment, fitter.problem.record, belief).residuals(
        fitter.problem.predicted(belief, convention)
    )


def typical_s(judge: Judge, channel: str) -> float:
    way = judge.ways[channel]
    return way.typical_s if isinstance(way, Switching) else 0.0


def moved(judge: Judge) -> float:
    """Return how far the noise of the drive moves a control output that runs on."""
    way = judge.ways[CONTINUOUS]
    return float((way.driven**2).mean() ** 0.5) if isinstance(way, Continuous) else 0.0


def gaps(residual: Iterable[Residual]) -> Gaps:
    """Return the gap of each channel."""
    return {each.channel: max(each.gap(), LEAST) for each in residual}


def over(left: Mapping[str, float], floors: Mapping[str, float]) -> float:
    return max(left[channel] / max(floors[channel], LEAST) for channel in left)


def told(case: Case, staged: Staged, found: Sequence[Size | None]) -> dict[str, Any]:
    """Return the truth of a record, in JSON's words."""
    causes = []
    for cause, each, size in zip(case.causes, case.scene["causes"], found, strict=True):
        measure = None if size is None else _rounded(asdict(size) | {"over": size.over})
        about = {"name": cause.name, "stages": list(cause.stages), "is_family": cause.is_family}
        causes.append({**about, "values": each["values"], "size": measure})
    return {**case.described(), "causes": causes, "about": dict(staged.about)}


def _rounded(values: Mapping[str, Any]) -> dict[str, Any]:
    return {name: float(f"{value:.6g}") if isinstance(value, float) else value for name, value in values.items()}
