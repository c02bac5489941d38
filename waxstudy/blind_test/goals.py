"""The goals, and the figures that stand beside them: full channels, nominal noise, a gap above twice the floor."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from waxstudy.blind_test.figures import NOTHING, Figure, mean, median, share
from waxstudy.blind_test.marks import Mark, with_probabilities
from waxstudy.blind_test.plan import LEAST_OVER

FAST, OTHER, BUILT = "fast room", "other physics", "as built, with a baseline"
WHERE = (FAST, OTHER, BUILT)
HALF = 0.5  # of the hours in which an effect acts or is said to
NOMINAL_COVERAGE = 0.95
MOST_NOISE = 2.0  # times the nominal one, of records of temperatures only
ROOM_STAGES = frozenset({"emitter", "room"})
WITH_CAUSE = ("single", "pair", "family")
BRIER, LOG_SCORE = "Brier score of the probabilities", "logarithmic score of the probabilities"


@dataclass(frozen=True)
class Goal:
    """A figure that should reach a value: `at_most` for what should be rare; None where it is only reported."""

    name: str
    where: str
    wanted: float | None
    of: Callable[[Chosen], Figure]
    at_most: bool = False
    covers: bool = False  # the figure's interval is to hold 0.95

    def described(self, chosen: Chosen) -> dict[str, Any]:
        figure = self.of(chosen)
        about = {"name": self.name, "where": self.where, "wanted": self.wanted, "at_most": self.at_most}
        return {**about, **figure.described(), "met": self.met(figure)}

    def met(self, figure: Figure) -> bool | None:
        """Whether it is reached; None where nothing is asked or there is nothing to judge."""
        if figure.value is None or figure.low is None or figure.high is None:
            return None
        if self.covers:
            return figure.low <= NOMINAL_COVERAGE <= figure.high
        if self.wanted is None:
            return None
        return figure.value <= self.wanted if self.at_most else figure.value >= self.wanted


@dataclass(frozen=True)
class Chosen:
    """The marks that a goal is about."""

    own: Sequence[Mark]
    left_out: Sequence[Mark]
    shrinks: Mapping[str, float]

    def of(self, *kinds: str, channels: str = "all") -> list[Mark]:
        """Return marks of some kinds whose noise is nominal; of what has causes, those whose gaps are large enough.

        Fewer channels are drawn together with another noise: up to twice the nominal one counts.
        """
        return [m for m in self.own if m.truth.kind in kinds and _is_goal(m, channels)]

    def answered(self, *kinds: str, channels: str = "all") -> list[Mark]:
        """Return the same without failures: who says nothing says nothing wrong, which is no merit."""
        return [m for m in self.of(*kinds, channels=channels) if not m.answer.has_failed]


def _is_goal(mark: Mark, channels: str) -> bool:
    truth = mark.truth
    is_large = truth.kind == "null" or truth.over > LEAST_OVER
    is_so = truth.channels == channels or (truth.has_baseline and channels == "all")
    noise = truth.noise_factor
    is_usual = noise == 1.0 if channels == "all" else noise <= MOST_NOISE
    return is_so and is_usual and is_large


def right_group(chosen: Chosen) -> Figure:
    return share([m.right_group for m in chosen.of("single")])


def beyond_room(chosen: Chosen) -> Figure:
    return share([m.right_group for m in chosen.of("single") if m.truth.beyond > LEAST_OVER])


def room_group(chosen: Chosen) -> Figure:
    return share([m.right_group for m in chosen.of("single") if _is_of_room(m)])


def chain_group(chosen: Chosen) -> Figure:
    return share([m.right_group for m in chosen.of("single") if not _is_of_room(m)])


def _is_of_room(mark: Mark) -> bool:
    return all(cause.stages <= ROOM_STAGES for cause in mark.truth.causes)


def group_size(chosen: Chosen) -> Figure:
    return mean([len(claim.group) for m in chosen.of("single") for _, claim in m.right_claims])


def top_1(chosen: Chosen) -> Figure:
    return share([m.top_1 for m in chosen.of("single") if m.is_nameable])


def right_stage(chosen: Chosen) -> Figure:
    return share([m.right_stage for m in chosen.of("single")])


def false_alarms(chosen: Chosen) -> Figure:
    return share([m.false_alarm for m in chosen.answered("null")])


def misdiagnosis(chosen: Chosen) -> Figure:
    return share([m.misdiagnosis for m in chosen.answered("single", "pair")])


def unknown_found(chosen: Chosen) -> Figure:
    return share([m.unknown_found for m in chosen.of("family")])


def unknown_claimed(chosen: Chosen) -> Figure:
    return share([m.unknown_claimed for m in chosen.answered("null", "single", "pair")])


def leave_one_out(chosen: Chosen) -> Figure:
    return share([m.left_out_honestly for m in chosen.left_out if _is_goal(m, "all") and not m.truth.departs])


def both(chosen: Chosen) -> Figure:
    return share([m.right_group for m in chosen.of("pair")])


def shrinkage(chosen: Chosen) -> Figure:
    """What is claimed of the stage's gap, of effects that were found."""
    claims = [claim for m in chosen.of("single") for _, claim in m.right_claims]
    return median([claim.shrink for claim in claims if claim.shrink is not None])


def true_shrinkage(chosen: Chosen) -> Figure:
    found = [chosen.shrinks[m.truth.name] for m in chosen.of("single") if m.truth.name in chosen.shrinks]
    return median(found) if found else NOTHING


def coverage(chosen: Chosen) -> Figure:
    said = [each for m in chosen.of("single") for each in m.parameters]
    return share([low <= true <= high for _, true, (_, low, high) in said])


def right_by_temperatures(chosen: Chosen) -> Figure:
    return share([m.right_group for m in chosen.of("single", channels="temperatures only")])


def over_claim_by_temperatures(chosen: Chosen) -> Figure:
    return share([m.over_claim for m in chosen.answered("single", channels="temperatures only")])


def semi_real(chosen: Chosen) -> Figure:
    return share([m.right_or_untestable for m in chosen.own if m.truth.is_measured and m.truth.kind == "single"])


def brier(chosen: Chosen) -> Figure:
    return mean([m.brier for m in with_probabilities(chosen.own) if m.brier is not None])


def log_score(chosen: Chosen) -> Figure:
    return mean([m.log_score for m in with_probabilities(chosen.own) if m.log_score is not None])


def right_hours(chosen: Chosen) -> Figure:
    return share([found >= HALF for m in chosen.of(*WITH_CAUSE) for _, found in m.overlaps])


def right_hours_of_some(chosen: Chosen) -> Figure:
    return share([found >= HALF for m in chosen.of(*WITH_CAUSE) for is_timed, found in m.overlaps if is_timed])


def _everywhere(
    name: str, of: Callable[[Chosen], Figure], fast: float | None, other: float | None, built: float | None, **how: Any
) -> list[Goal]:
    """Return a goal of the fast room, and those of other physics, as drawn and as built."""
    return [Goal(name, where, wanted, of, **how) for where, wanted in zip(WHERE, (fast, other, built), strict=True)]


GOALS: Sequence[Goal] = (
    *_everywhere("right group", right_group, 0.95, 0.85, None),
    Goal("right group, beyond what is unknown of the room", FAST, None, beyond_room),
    Goal("right group, room and emitter", BUILT, 0.80, room_group),
    Goal("right group, sensor to valve", BUILT, 0.90, chain_group),
    *_everywhere("mean size of right groups", group_size, 2.0, 2.0, 2.0, at_most=True),
    *_everywhere("top-1 effect, where it could be named", top_1, 0.90, 0.75, 0.75),
    *_everywhere("right stage", right_stage, 0.95, 0.85, 0.85),
    *_everywhere("false alarms on nulls", false_alarms, 0.02, 0.05, 0.03, at_most=True),
    *_everywhere("misdiagnosis", misdiagnosis, 0.05, 0.10, 0.05, at_most=True),
    *_everywhere("unknown found", unknown_found, 0.90, 0.80, 0.75),
    *_everywhere("unknown falsely claimed", unknown_claimed, 0.05, 0.10, 0.10, at_most=True),
    Goal("leave-one-out answered honestly", FAST, 0.85, leave_one_out),
    *_everywhere("both of two effects found", both, 0.80, 0.60, 0.60),
    *_everywhere("median shrinkage claimed", shrinkage, 0.90, 0.75, 0.75),
    *_everywhere("median true shrinkage, held-out days", true_shrinkage, 0.90, 0.75, 0.75),
    Goal("coverage of 95 % intervals", FAST, NOMINAL_COVERAGE, coverage, covers=True),
    Goal("coverage of 95 % intervals", OTHER, 0.85, coverage),
    Goal("coverage of 95 % intervals", BUILT, 0.85, coverage),
    Goal("temperatures only: right group", FAST, 0.90, right_by_temperatures),
    Goal("temperatures only: over-claim", FAST, 0.05, over_claim_by_temperatures, at_most=True),
    Goal("temperatures only: right group", OTHER, None, right_by_temperatures),
    Goal("temperatures only: over-claim", OTHER, None, over_claim_by_temperatures),
    Goal("semi-real: right group or untestable", OTHER, 0.80, semi_real),
    Goal(BRIER, BUILT, None, brier),
    Goal(LOG_SCORE, BUILT, None, log_score),
    Goal("hours told: half of either in both", BUILT, 0.60, right_hours),
    Goal("… of what comes and goes", BUILT, None, right_hours_of_some),
)


def described_goals(
    own: Sequence[Mark], left_out: Sequence[Mark], shrinks: Mapping[str, float]
) -> list[dict[str, Any]]:
    """Return every goal with its figure."""
    rooms = {where: [m for m in own if where_of(m) == where] for where in WHERE}
    return [goal.described(Chosen(_without_house(goal, rooms[goal.where]), left_out, shrinks)) for goal in GOALS]


def where_of(mark: Mark) -> str:
    """Return the part of the goals that a record counts for."""
    if mark.truth.has_baseline:
        return BUILT
    return OTHER if mark.truth.departs or mark.truth.is_measured else FAST


def _without_house(goal: Goal, own: Sequence[Mark]) -> list[Mark]:
    """Return the marks of a goal: a measured house counts for itself only."""
    return [m for m in own if m.truth.is_measured == (goal.of is semi_real)]
