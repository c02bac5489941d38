"""One answer held against one truth: what was right in it, and what was not."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from waxstudy.blind_test.answer import NONE, UNKNOWN, Answer, Claim, hypothesis
from waxstudy.blind_test.plan import LEAST_OVER
from waxstudy.plugin.effect import Effect
from waxstudy.plugin.hours import DAY_H
from waxstudy.plugin.registry import installed
from waxstudy.plugin.trial import engine_of

LEAST_STATED = 0.01  # of a probability that is looked at
LEAST_TRUE = 1e-4  # what the truth is given at least, so that no single answer makes the mean infinite
Spans = Sequence[tuple[float, float]]
FLOW = "_L_h"


@dataclass(frozen=True)
class TrueCause:
    """A cause that is in a record, with the size of its gap; `members` are the names that a group may hold."""

    name: str
    stages: frozenset[str]
    is_family: bool
    values: Mapping[str, float]
    over: float  # true gap over its floor, 0 where no channel shows it
    beyond: float  # the same when all that nobody knows of the room is fitted
    alike: frozenset[str]
    when: tuple[tuple[float, float], ...] | None = None  # hours since the record began in which it acts

    @property
    def members(self) -> frozenset[str]:
        return self.alike if self.is_family else self.alike | {self.name}


@dataclass(frozen=True)
class Truth:
    """The truth of a record, as its box has it."""

    name: str
    stratum: str
    kind: str
    engine: str
    channels: str
    noise_factor: float
    interval_s: float
    days: int
    causes: tuple[TrueCause, ...]
    departs: frozenset[str]
    is_measured: bool
    has_baseline: bool = False  # a house that was not built as it is believed, and a healthy record of it

    @classmethod
    def read(cls, box: Mapping[str, Any]) -> Truth:
        engine, measured = engine_of(box["engine"]), box["measured"]
        return cls(
            name=box["name"],
            stratum=box["stratum"],
            kind=box["kind"],
            engine=box["engine"],
            channels=measured["channels"],
            noise_factor=measured["noise_factor"],
            interval_s=measured["interval_s"],
            days=measured["days"],
            causes=tuple(_cause(each) for each in box["causes"]),
            departs=frozenset(engine.departs),
            is_measured=engine.is_measured,
            has_baseline="baseline" in box,
        )

    @property
    def over(self) -> float:
        """The least of its causes' gaps over their floors; of a null 0."""
        return min((cause.over for cause in self.causes), default=0.0)

    @property
    def beyond(self) -> float:
        return min((cause.beyond for cause in self.causes), default=0.0)

    @property
    def hypothesis(self) -> str:
        """What a posterior calls it."""
        return hypothesis({UNKNOWN if cause.is_family else cause.name for cause in self.causes})

    @property
    def label(self) -> str:
        return " + ".join(sorted(cause.name for cause in self.causes)) or "nothing"


def _cause(said: Mapping[str, Any]) -> TrueCause:
    size = said["size"] or {"over": 0.0, "beyond": 0.0, "alike": ()}
    stages, alike = frozenset(said["stages"]), frozenset(size["alike"])
    acts = tuple((begin, end) for begin, end in said["when"]) if "when" in said else None
    return TrueCause(said["name"], stages, said["is_family"], said["values"], size["over"], size["beyond"], alike, acts)


def _stage_of(name: str) -> str:
    """Return where an effect of the library acts, "" of what is none of it."""
    entry = installed().components.get(("effect", name))
    return entry.component.stage if entry and issubclass(entry.component, Effect) else ""


@dataclass(frozen=True)
class Mark:
    """What an answer is worth.

    Where the believed model differs in form, and no cause lies, one claim of a stage is counted apart: a finding there
    is right in its way, a list of everything is not. What is left unexplained there is counted apart as well, and so
    are such names in hypotheses. Who saw a healthy record of the same loop is not excused: a difference in form is no
    change.
    """

    truth: Truth
    answer: Answer
    seconds: float = 0.0
    saw_baseline: bool = False

    # --- what it says, without what is counted apart ---

    @cached_property
    def claims(self) -> tuple[Claim, ...]:
        return tuple(claim for claim in self.answer.claims if not self._is_apart(claim))

    @cached_property
    def open_stages(self) -> tuple[frozenset[str], ...]:
        return tuple(stages for stages in self.answer.open_stages if not self._is_form(stages))

    @property
    def has_apart(self) -> bool:
        """Whether anything was found where the believed model differs in form."""
        return len(self.claims) + len(self.open_stages) < len(self.answer.claims) + len(self.answer.open_stages)

    def _is_apart(self, claim: Claim) -> bool:
        is_named = any(claim.group & cause.members for cause in self.truth.causes)
        is_only_one = sum(bool(claim.stages & other.stages) for other in self.answer.claims) == 1
        return self._is_form(claim.stages) and is_only_one and not is_named

    def _is_form(self, stages: frozenset[str]) -> bool:
        """Whether the believed model differs in form at these stages, no cause lies there, and no baseline tells it."""
        if self.saw_baseline:
            return False
        return stages <= self.truth.departs and not any(stages & cause.stages for cause in self.truth.causes)

    @cached_property
    def posterior(self) -> Mapping[str, float] | None:
        """The probability of each hypothesis without what is counted apart; None where none is stated."""
        if self.answer.posterior is None:
            return None
        found: dict[str, float] = {}
        for name, probability in self.answer.posterior.items():
            names = name.split("+")
            counted = hypothesis(set(names) - {NONE} - {each for each in names if self._is_named_apart(each, names)})
            found[counted] = found.get(counted, 0.0) + probability
        return found

    def _is_named_apart(self, name: str, names: Sequence[str]) -> bool:
        """Whether a name in a hypothesis is counted apart; `unknown` where all that is left open is."""
        if name == UNKNOWN:
            return self._is_open_of_form
        stage = _stage_of(name)
        is_only_one = [_stage_of(each) for each in names].count(stage) == 1
        is_named = any(name in cause.members for cause in self.truth.causes)
        return bool(stage) and self._is_form(frozenset({stage})) and is_only_one and not is_named

    @property
    def _is_open_of_form(self) -> bool:
        """Whether something is left open, and all of it where the believed model differs in form."""
        return bool(self.answer.open_stages) and not self.open_stages

    # --- figures ---

    @property
    def detected(self) -> bool:
        return bool(self.claims or self.open_stages)

    @property
    def false_alarm(self) -> bool:
        """A null in which an effect is named."""
        return self.truth.kind == "null" and bool(self.claims)

    @property
    def right_claims(self) -> tuple[tuple[TrueCause, Claim], ...]:
        """Each cause with the claim that holds it and nothing that could be told from it."""
        return tuple(
            (cause, claim)
            for cause in self.truth.causes
            for claim in self.claims
            if not cause.is_family and cause.name in claim.group and claim.group <= cause.members
        )

    # --- probabilities and hours, where an answer has them ---

    @property
    def stated(self) -> Sequence[tuple[float, bool]]:
        """Each hypothesis with a probability worth naming: that, and whether it is the truth; the likeliest first."""
        said = self.posterior or {}
        found = [(value, name == self.truth.hypothesis) for name, value in said.items() if value >= LEAST_STATED]
        return sorted(found, key=lambda each: -each[0])

    @property
    def brier(self) -> float | None:
        """The squared errors of the probabilities of all hypotheses, from 0 to 2; of a failure 1, as of none at all."""
        if self.answer.has_failed:
            return 1.0
        said = self.posterior
        if said is None:
            return None
        every = {self.truth.hypothesis: 0.0, **said}
        return sum((value - (name == self.truth.hypothesis)) ** 2 for name, value in every.items())

    @property
    def log_score(self) -> float | None:
        """Minus the logarithm of the truth's probability; a failure gave it none."""
        if self.answer.has_failed:
            return -math.log(LEAST_TRUE)
        said = self.posterior
        return None if said is None else -math.log(max(LEAST_TRUE, said.get(self.truth.hypothesis, 0.0)))

    @property
    def overlaps(self) -> Sequence[tuple[bool, float]]:
        """Of each claim of a cause that says when: whether the cause comes and goes, and hours in both over either.

        A claim is of a cause of the library that it names rightly, and of a family at whose stages it is.
        """
        placed = [(c, each) for c in self.truth.causes if c.is_family for each in self.claims if each.stages & c.stages]
        said = [(cause.when, claim.when) for cause, claim in (*self.right_claims, *placed)]
        whole = ((0.0, DAY_H * self.truth.days),)
        return [(true != whole, overlap(true, found)) for true, found in said if true is not None and found is not None]

    @property
    def right_group(self) -> bool:
        """All causes found, each in a group of its own, and nothing else claimed."""
        causes = {cause.name for cause, _ in self.right_claims}
        claims = {claim.name for _, claim in self.right_claims}
        return len(causes) == len(claims) == len(self.truth.causes) == len(self.claims) > 0

    @property
    def is_nameable(self) -> bool:
        """Whether some diagnoser could name the cause alone."""
        return all(not cause.alike for cause in self.truth.causes)

    @property
    def top_1(self) -> bool:
        return self.right_group and all(len(claim.group) == 1 for claim in self.claims)

    @property
    def right_stage(self) -> bool:
        """Every cause is placed at one of its stages, and nothing elsewhere: by claims, else by what stays open."""
        places = [claim.stages for claim in self.claims] or list(self.open_stages)
        hit = [any(place & cause.stages for place in places) for cause in self.truth.causes]
        elsewhere = [place for place in places if not any(place & cause.stages for cause in self.truth.causes)]
        return bool(places) and all(hit) and not elsewhere

    @property
    def misdiagnosis(self) -> bool:
        """A claim that holds neither a cause nor what nobody could tell from one."""
        members = frozenset().union(*(cause.members for cause in self.truth.causes))
        return bool(self.truth.causes) and any(not claim.group & members for claim in self.claims)

    @property
    def over_claim(self) -> bool:
        """An effect named alone though nobody could tell it from others."""
        known = [cause.members for cause in self.truth.causes if len(cause.members) > 1]
        return any(len(claim.group) == 1 and claim.group <= members for claim in self.claims for members in known)

    @property
    def unknown_claimed(self) -> bool:
        """Something that the library has, or nothing at all, said to be unknown; but not for the form alone."""
        return self.answer.verdict == "unknown" and not self._is_open_of_form

    @property
    def unknown_found(self) -> bool:
        """Something outside the library said to be unknown at an acceptable stage, or one of its class named."""
        return all(self.honest(cause, cause.alike) for cause in self.truth.causes)

    def honest(self, cause: TrueCause, alike: frozenset[str]) -> bool:
        """Whether a cause that cannot be named is left open at its stage, or one of its class is named."""
        if any(not claim.group & alike for claim in self.claims):
            return False
        return bool(self.claims) or any(stages & cause.stages for stages in self.open_stages)

    @property
    def left_out_honestly(self) -> bool:
        return all(self.honest(cause, cause.alike - {cause.name}) for cause in self.truth.causes)

    @property
    def right_or_untestable(self) -> bool:
        names = {cause.name for cause in self.truth.causes}
        says_so = self.answer.verdict == "untestable" or names <= self.answer.untestable
        return self.right_group or (not self.claims and says_so and not self.answer.has_failed)

    @property
    def is_right(self) -> bool:
        """Whether nothing has to be listed as a failure."""
        if self.answer.has_failed:
            return False
        if self.truth.kind == "null":
            return not (self.false_alarm or self.unknown_claimed)
        if self.truth.is_measured:
            return self.unknown_found if self.truth.kind == "family" else self.right_or_untestable
        if self.truth.over <= LEAST_OVER:
            return not self.misdiagnosis
        return self.unknown_found if self.truth.kind == "family" else self.right_group

    @property
    def outcome(self) -> str:
        """In a word, for lists and the confusion matrix."""
        if self.answer.has_failed:
            return "failed"
        if self.claims:
            return " + ".join(sorted("|".join(sorted(claim.group)) for claim in self.claims))
        if self.open_stages:
            return "unknown"
        return "counted apart" if self.has_apart else self.answer.verdict

    @property
    def parameters(self) -> Sequence[tuple[str, float, tuple[float, float, float]]]:
        """Each parameter of a cause that is named: its name, what is true, and value, low and high as said."""
        found = []
        for cause, claim in self.right_claims:
            if claim.name == cause.name:
                told = {n: unrolled(n, said) for n, said in claim.parameters.items() if n in cause.values}
                found += [(f"{cause.name}.{n}", turned(n, cause.values[n], said[0]), said) for n, said in told.items()]
        return found


def with_probabilities(own: Sequence[Mark]) -> list[Mark]:
    """Return marks whose answers state probabilities or failed to; none of a diagnoser that never states any."""
    if all(mark.answer.posterior is None for mark in own):
        return []
    return [mark for mark in own if mark.answer.posterior is not None or mark.answer.has_failed]


def overlap(one: Spans, other: Spans) -> float:
    """Return the hours in both over the hours in either.

    >>> overlap([(0.0, 4.0), (10.0, 12.0)], [(2.0, 4.0)])
    0.3333333333333333
    """
    both = sum(max(0.0, min(a[1], b[1]) - max(a[0], b[0])) for a in one for b in other)
    either = sum(end - begin for begin, end in (*one, *other)) - both
    return both / either if either > 0.0 else 0.0


def turned(parameter: str, true: float, said: float) -> float:
    """Return what is true, of an hour of the day as near as may be to what is said: twelve later is twelve earlier.

    >>> turned("shift_h", -12.0, 11.9), turned("from_h", 23.5, 0.5), turned("flow_L_h", 50.0, 20.0)
    (12.0, -0.5, 50.0)
    """
    return true + DAY_H * round((said - true) / DAY_H) if _is_hour(parameter) else true


def unrolled(parameter: str, said: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return a value, low and high as said, of an hour of the day with an interval that reaches over midnight.

    >>> unrolled("from_h", (23.75, 23.5, 0.25)), unrolled("to_h", (2.0, 0.0, 24.0)), unrolled("bias_K", (0.1, 0.0, 0.2))
    ((23.75, 23.5, 24.25), (2.0, -10.0, 14.0), (0.1, 0.0, 0.2))
    """
    value, low, high = said
    if not _is_hour(parameter):
        return said
    if (low, high) == (0.0, DAY_H):  # any hour
        return value, value - 0.5 * DAY_H, value + 0.5 * DAY_H
    return said if low <= high else (value, value - (value - low) % DAY_H, value + (high - value) % DAY_H)


def relative_errors(said: Sequence[tuple[str, float, tuple[float, float, float]]]) -> list[float]:
    """Return by how much of what is true parameters are missed; an hour of the day has no size, nor has a true 0.

    >>> relative_errors([("leak.factor", 2.0, (3.0, 1.0, 4.0)), ("window.from_h", 22.0, (19.0, 18.0, 20.0))])
    [0.5]
    """
    return [abs(value / true - 1.0) for name, true, (value, _, _) in said if true and not _is_hour(name)]


def _is_hour(parameter: str) -> bool:
    return parameter.endswith("_h") and not parameter.endswith(FLOW)
