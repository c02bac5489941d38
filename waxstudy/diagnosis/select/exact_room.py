"""A second look at a room as it is believed, to the letter: effects in the place of all that nobody knows of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from waxstudy.diagnosis.estimate.fitter import Fitter
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.estimate.noise_floor import NoiseFloor
from waxstudy.diagnosis.estimate.parameter_space import EffectType
from waxstudy.diagnosis.model.room_response import OF_AIR_AND_FLOOR
from waxstudy.diagnosis.residuals.judge import Residual
from waxstudy.diagnosis.result import in_floors
from waxstudy.diagnosis.select.criteria import EXPLAINED
from waxstudy.diagnosis.select.search import Selection, Tick, select

CLEAR = 1.75  # floors by which a room must be missed without an effect
POOR_FORM = 3.0  # floors, left with effects by all that nobody knows of a room: it is not as believed
# what other forms of a room leave at least, with an effect fitted: in kelvins, of what was missed
NO_FORM_K, NO_FORM_SHARE = 0.015, 0.05
MOST_ALIKE = 3  # names in a group: a little heat that half of the library explains is no evidence


def with_exact_room(wide: Selection, effects: Sequence[EffectType], seed: int, tick: Tick) -> Selection:
    """Return a selection in which nothing of a room departs, where effects then leave nothing but noise; else the same.

    That they do what a dozen nuisances together did is no chance, although these could take each of them.
    """
    loose = wide.fitter
    if not _is_known_well(loose) or max(_floors(wide.after, wide.floor)) > POOR_FORM:
        return wide
    parts = loose.segment, loose.record, loose.belief, loose.thorough
    exact = Fitter(*parts, room_tolerance=0.0, holds_out=loose.holds_out)
    believed = exact.base_on_both(exact.base.convention)
    floor = NoiseFloor.of(exact, believed)
    is_hidden = any(floor.plain[each.channel] > _of_form_K(each) for each in _shown(believed))
    if is_hidden or max(_floors(believed, floor)) < CLEAR:
        return wide
    found = select(exact, effects, seed, tick)
    is_clear = all(each.candidate.over >= CLEAR and len(each.group) <= MOST_ALIKE for each in found.found)
    return found if found.found and is_clear and _is_noise(found) else wide


def _is_known_well(fitter: Fitter) -> bool:
    """Whether a room is no rough guess, and what drives it is known: what a noisy opening lets through is not."""
    is_measured = fitter.segment.driven_by == "flow_L_h" or fitter.segment.driven_by in fitter.record.binary
    of_air = [channel for channel in fitter.segment.judged if channel in OF_AIR_AND_FLOOR]
    is_told = is_measured and not fitter.record.stand_ins
    return fitter.segment.with_room and bool(of_air) and is_told and fitter.room_tolerance <= 1.0


def _shown(model: Hypothesis) -> list[Residual]:
    """Return what is missed of air and floor."""
    return [residual for residual in model.residuals if residual.channel in OF_AIR_AND_FLOOR]


def _floors(model: Hypothesis, floor: NoiseFloor) -> Iterator[float]:
    """Yield what is missed of air and floor over its noise floor."""
    for residual in _shown(model):
        yield in_floors(residual.gap(), floor.plain[residual.channel])


def _of_form_K(before: Residual) -> float:
    """Return what another form of a room would leave at least of what was missed."""
    return max(NO_FORM_K, NO_FORM_SHARE * before.gap())


def _is_noise(selection: Selection) -> bool:
    """Whether of air and floor nothing but noise is left, and less than another form of a room would leave."""
    pairs = zip(_shown(selection.before), _shown(selection.after), strict=True)
    is_no_form = all(after.gap() <= _of_form_K(before) for before, after in pairs)
    return is_no_form and max(_floors(selection.after, selection.floor)) <= EXPLAINED
