"""The truth of a record: what was put in, the size of its gap beside the noise, and what nobody could tell from it.

A true gap is that of one stage without noise: what the stage would give without the cause, driven by what truly came
before it, against what it gave. Sizes are computed once, when a record is made, by `blind_test.sizes`, and sealed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from waxstudy.blind_test.draw import Case, Measured
from waxstudy.blind_test.record import shown
from waxstudy.blind_test.sizes.missed import Gaps, Missed, gaps, measured, missed
from waxstudy.blind_test.sizes.record import LEVELS, Record
from waxstudy.blind_test.sizes.refit import Refit, as_believed
from waxstudy.blind_test.sizes.stretch import SHOWN, Stretch, stretch_of
from waxstudy.dataset.channels import CHANNELS
from waxstudy.dataset.read import Dataset
from waxstudy.plugin import CHAIN, Belief, Choice, Effect, FloatArray
from waxstudy.plugin.registry import installed
from waxstudy.plugin.trial import Cause, Staged
from waxstudy.synthetic.departures import Departures, departed
from waxstudy.synthetic.effects import EffectError, applied

TIMES = 4  # that a record is measured for its floor: whether a switch comes early hangs on single samples
TIMING = 12.0**-0.5  # of an interval: no switch is known better
# chosen: times what the best fit of the true effect leaves, that another one may: searches end near each other
AS_NEAR = 1.05
HARDLY = 0.3  # of what is missed of a measured record anyway, or of a gap
HOUSE_K, RETURN_K = (
    0.1,
    0.2,
)  # by which a measured room is fitted: the first minutes of each return are a matter of form


@dataclass(frozen=True)
class Size:
    """The true gap of a cause on the channel where it stands out most.

    `beyond` is the largest gap over its floor that is left when all that nobody knows of the room is fitted; `alike`
    are the effects whose refit to the record without noise leaves less than the floor: nobody could tell them apart.
    """

    link: str
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
    """A record without noise, some with noise and nothing missing, what is believed, and what strays from that."""

    about: Dataset
    free: Record
    noisy: Sequence[Record]
    departures: Departures = field(default_factory=dict)

    def truth(self, record: Record, effects: Sequence[Choice] = ()) -> Belief:
        """Return what is true of a record with effects, but for form that no belief has; raise `EffectError`."""
        return applied(effects, departed(record.belief(self.about), self.departures))

    def stretch_of(self, cause: Cause) -> Stretch | None:
        return stretch_of(cause.stages[0], self.free, self.free.belief(self.about))

    def missed(self, stretch: Stretch, record: Record, effects: Sequence[Choice]) -> Missed:
        """Return what is missed of a record, driven by itself, with effects."""
        return missed(stretch, record, stretch.shown(record, self.truth(record, effects)))

    def refit(self, stretch: Stretch, record: Record, effects: Sequence[Choice], limits: Gaps) -> Refit:
        return Refit(
            stretch,
            record,
            record.belief(self.about),
            limits,
            self.about.room_tolerance,
            departures=self.departures,
            others=partial(applied, effects),
        )


@dataclass(frozen=True)
class Cut:
    """Gap and floor of each channel of a stretch, and what any refit leaves of it besides."""

    gaps: Gaps
    floors: Gaps
    form: Gaps


def sizes(case: Case, staged: Staged, seen: Dataset, with_alike: bool = True) -> list[Size | None]:
    """Return the size of each cause, None where the record has no channel that shows its stage, or lacks its drive.

    `seen` says what is believed.
    """
    if not case.causes:
        return []
    how = replace(case.measured, missing=0.0)
    again = [] if staged.is_measured else [replace(how, seed=how.seed + time) for time in range(TIMES)]
    noisy = [recorded(staged, each, seen, noise=True) for each in again]
    stand = Stand(seen, recorded(staged, how, seen), noisy, staged.departures)
    return [_size(case, staged, stand, place, with_alike) for place in range(len(case.causes))]


def recorded(staged: Staged, how: Measured, about: Dataset, noise: bool = False) -> Record:
    """Return what the instruments show, driven by what truly drove it."""
    return Record.of(shown(staged, how.with_drives(), noise).drop(columns="time"), about, noise)


def _size(case: Case, staged: Staged, stand: Stand, place: int, with_alike: bool) -> Size | None:
    cause, own = case.causes[place], staged.effects[place]
    others = [choice for choice in staged.effects if choice is not None and choice is not own]
    stretch = stand.stretch_of(cause)
    if stretch is None:
        return None
    healthy = without_cause(case, staged, stand, place) if case.baseline else None
    try:
        cut = _cut(case, staged, stand, stretch, place, with_form=with_alike and healthy is None)
    except EffectError:
        return None  # as pipes where no flow is recorded
    channel = max(cut.gaps, key=lambda name: cut.gaps[name] / cut.floors[name])
    gap, floor = cut.gaps[channel], cut.floors[channel]
    if not with_alike:
        return Size(stretch.name, channel, gap, floor, 0.0, ())
    limits = {name: math.hypot(each, cut.form[name]) for name, each in cut.floors.items()}
    refit = stand.refit(stretch, stand.free, others, limits)
    if healthy:
        refit = refit.beside(stand.refit(stretch, healthy, others, cut.floors))
    if own is None and not staged.is_measured:
        refit = replace(refit, limits=_as_near(refit, cause.name, cut.gaps))
    tried = [each for each in library() if each.name != cause.name and each.stage in stretch.stages]
    alike = tuple(each.name for each in tried if gap > floor and refit.is_alike(each))
    return Size(stretch.name, channel, gap, floor, refit.beyond, alike)


def _cut(case: Case, staged: Staged, stand: Stand, stretch: Stretch, place: int, with_form: bool) -> Cut:
    """Return the gaps of one cause; raise `EffectError`."""
    own, effects = staged.effects[place], [choice for choice in staged.effects if choice is not None]
    if own is not None:
        return cut_of_effect(stand, stretch, effects, [choice for choice in effects if choice is not own])
    null = without_cause(case, staged, stand, place)
    if staged.is_measured:
        return _cut_of_house(stand, stretch, null)
    return _cut_of_channels(stand, stretch, effects, null, with_form)


def without_cause(case: Case, staged: Staged, stand: Stand, place: int) -> Record:
    """Return the record that the engine gives without one cause, without noise."""
    changed = _up_to_recorded(staged.without[place], stand.free, case.causes[place])
    still = replace(staged, channels={**staged.channels, **changed})
    return recorded(still, replace(case.measured, missing=0.0), stand.about)


def _up_to_recorded(changed: Mapping[str, FloatArray], record: Record, cause: Cause) -> Mapping[str, FloatArray]:
    """Return what a cause changes of the chain up to the first channel that was recorded: further on that drives."""
    if cause.stages[0] not in CHAIN:
        return changed
    kept: dict[str, FloatArray] = {}
    for kind in CHAIN[CHAIN.index(cause.stages[0]) :]:
        source = CHANNELS[SHOWN[kind]].source
        kept |= {source: changed[source]} if source in changed else {}
        if SHOWN[kind] in record.values:
            return kept
    return changed


def _as_near(refit: Refit, cause: str, true_gaps: Gaps) -> Gaps:
    """Return what an effect may leave to be alike: its limit, or what the library's effect of the cause's name leaves.

    The engine has another form than what is believed, so that leaves something, of which little of the gap counts.
    """
    effect = next((each for each in library() if each.name == cause), None)
    found = refit.nearest(effect) if effect else None
    if found is None:
        return refit.limits
    left = {channel: AS_NEAR * gap for channel, gap in gaps(found.missed).items()}
    return {c: max(limit, min(left[c], HARDLY * true_gaps[c])) for c, limit in refit.limits.items()}


def cut_of_effect(stand: Stand, stretch: Stretch, effects: Sequence[Choice], others: Sequence[Choice]) -> Cut:
    """Return gap and floor of the one of the true effects that is not among the others.

    The floor is what the truth itself misses of the noisy record, driven by that; the gap what the rest of the truth
    misses of the record without noise, driven by that.
    """
    true_gaps = gaps(stand.missed(stretch, stand.free, others))
    noise = [gaps(stand.missed(stretch, record, effects)) for record in stand.noisy]
    return Cut(true_gaps, _floors(stand.free, noise), dict.fromkeys(true_gaps, 0.0))


def _cut_of_channels(stand: Stand, stretch: Stretch, others: Sequence[Choice], null: Record, with_form: bool) -> Cut:
    """Return gap and floor of a cause in an engine's own terms, or of the logger, beside the record without it."""
    noise = [_noise(stand, stretch, others, record) for record in stand.noisy]
    floors = _floors(stand.free, noise)
    form = gaps(stand.refit(stretch, null, others, floors).base.missed) if with_form else dict.fromkeys(floors, 0.0)
    return Cut(gaps(missed(stretch, stand.free, measured(stretch, null))), floors, form)


def _noise(stand: Stand, stretch: Stretch, others: Sequence[Choice], record: Record) -> Gaps:
    """Return the noise of each channel, of a controller's, which have none, what that of the drive moves them by."""
    free = replace(stand.free, is_noisy=True)  # smoothed alike
    own = missed(stretch, record, measured(stretch, free))
    levels = set(LEVELS) & set(stretch.judged)
    if not levels:
        return gaps(own)
    still = stretch.shown(stand.free, stand.truth(stand.free, others))
    believed = replace(stand.free, values={**stand.free.values, **{level: still[level] for level in levels}})
    moved = missed(stretch, believed, stretch.shown(record, stand.truth(record, others)))
    return gaps({channel: moved[channel] if channel in levels else own[channel] for channel in own})


def _floors(free: Record, noise: Sequence[Gaps]) -> Gaps:
    """Return the root mean square of several floors; no switch is known better than to the interval."""
    usual = {channel: float(np.sqrt(np.mean([each[channel] ** 2 for each in noise]))) for channel in noise[0]}
    return {c: max(floor, TIMING * free.interval_s) if c in free.switches else floor for c, floor in usual.items()}


def _cut_of_house(stand: Stand, stretch: Stretch, null: Record) -> Cut:
    """Return how far an alteration moves what is missed, beside what is missed of the untouched record.

    Both with the room as fitted to the untouched record. Alike is what leaves hardly more of the altered one.
    """
    weights = {c: RETURN_K if c == "return_temperature_C" else HOUSE_K for c in stretch.judged}
    before = stand.refit(stretch, null, (), weights).base
    after = stand.refit(stretch, stand.free, (), weights).fit(as_believed, before.departures)
    assert after
    floors = gaps(before.missed)
    moved = gaps({channel: after.missed[channel] - before.missed[channel] for channel in floors})
    return Cut(moved, floors, {channel: HARDLY * floor for channel, floor in floors.items()})


def library() -> list[type[Effect]]:
    """Return the effects that are installed, by name."""
    found = (entry.component for (kind, _), entry in sorted(installed().components.items()) if kind == "effect")
    return [component for component in found if issubclass(component, Effect)]


def told(case: Case, staged: Staged, found: Sequence[Size | None]) -> dict[str, Any]:
    """Return the truth of a record, in JSON's words."""
    causes = []
    always = [(0.0, 24.0 * case.measured.days)]
    spans = staged.when or [None] * len(case.causes)
    for cause, each, size, when in zip(case.causes, case.scene["causes"], found, spans, strict=True):
        measure = None if size is None else _rounded(asdict(size) | {"over": size.over})
        about = {"name": cause.name, "stages": list(cause.stages), "is_family": cause.is_family}
        acts = [list(span) for span in (always if when is None else when)]
        causes.append({**about, "values": each["values"], "size": measure, "when": acts})
    as_built = {"as_built": case.scene["as_built"]} if "as_built" in case.scene else {}
    return {**case.described(), "causes": causes, "about": dict(staged.about), **as_built}


def _rounded(values: Mapping[str, Any]) -> dict[str, Any]:
    return {name: float(f"{value:.6g}") if isinstance(value, float) else value for name, value in values.items()}
