"""The plan of a blind test: how many records of which kind, before anything is drawn."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from waxstudy.blind_test.key import Key
from waxstudy.plugin.trial import Engine, broken_engines, engine_of, engines

Kind = Literal["null", "single", "pair", "family"]
LEAST_OVER = 2.0  # true gap over its noise floor, in the goal strata
# of records that are made now: the second has channel sets without sun or gains, of the third a share has as much of
# each engine; a key keeps its first one
DRAW = 3
PER_EFFECT = 8  # records of each effect in the goal stratum


class PlanProblem(ValueError):
    """A plan that cannot be had; the message says why."""


@dataclass(frozen=True)
class Slot:
    """A record to draw. `cause` is what it must hold, if anything is; `is_free` draws channels and noise too."""

    stratum: str
    engine: str
    kind: Kind
    cause: str = ""
    is_free: bool = False
    least_over: float = 0.0
    has_baseline: bool = False  # of a house as it was built, with a healthy record from before
    draw: int = 1  # the way in which a key draws


@dataclass(frozen=True)
class Plan:
    """What was asked for, as it is told to everybody: sizes and engines, nothing of any record."""

    cases: int = 0  # of a mixture; 0 for a judged run
    share: float = 1.0  # of every stratum of a judged run
    strata: tuple[str, ...] = ()  # of a judged run; none for all of them
    engines: tuple[str, ...] = ()
    draw: int = 1  # those of earlier versions say nothing of it

    @property
    def is_judged(self) -> bool:
        return not self.cases

    def slots(self, key: Key) -> list[Slot]:
        """Return the records to draw, in an order that only the key knows."""
        chosen = [engine_of(name) for name in self.engines]
        slots = _judged(chosen, self, key) if self.is_judged else _mixture(chosen, self.cases, key)
        order = key.random("order").permutation(len(slots))
        return [replace(slots[place], draw=self.draw) for place in order]


def available(is_judged: bool) -> tuple[str, ...]:
    """Return the engines that records can be had of here."""
    return tuple(name for name, engine in _wanted(is_judged).items() if not engine.hindrance())


def left_out(is_judged: bool) -> Mapping[str, str]:
    """Return the engines that take no part here, with the reason."""
    hindered = {name: reason for name, engine in _wanted(is_judged).items() if (reason := engine.hindrance())}
    return {**broken_engines(), **hindered}


def _wanted(is_judged: bool) -> dict[str, type[Engine]]:
    """Return the engines of a judged run, or of a mixture, which has neither those kept nor measured ones."""
    return {n: e for n, e in engines().items() if is_judged or not (e.is_kept or e.is_measured)}


def causes_of(engine: type[Engine], kind: Kind, is_judged: bool) -> list[str]:
    """Return what an engine can put into a record of a kind; a null is drawn as a single that is left out again."""
    return [c.name for c in engine.causes() if c.is_family == (kind == "family") and (is_judged or not c.is_kept)]


# --- a judged run ---


def _judged(chosen: Sequence[type[Engine]], plan: Plan, key: Key) -> list[Slot]:
    strata = _strata(chosen)
    for name in plan.strata:
        if name not in strata:
            raise PlanProblem(f"no stratum '{name}' (there are: {', '.join(strata)})")
    wanted = plan.strata or tuple(strata)
    return [slot for name in wanted for slot in _shared(strata[name], plan, key)]


def _shared(slots: Sequence[Slot], plan: Plan, key: Key) -> list[Slot]:
    """Return a share of each kind and engine of a stratum, rounded up, its causes in turn from one that the key draws.

    Before the third draw it was a share of each kind and cause, nearly all of the engines named first.
    """
    is_old = plan.draw < 3
    groups: dict[tuple[str, ...], list[Slot]] = {}
    for slot in slots:
        old, new = (slot.kind, slot.cause or slot.engine), (slot.stratum, slot.kind, slot.engine)
        place: tuple[str, ...] = old if is_old else new
        groups.setdefault(place, []).append(slot)
    found = []
    for place, group in groups.items():
        first = 0 if is_old else int(key.random("share", *place).integers(len(group)))
        found += _spread([*group[first:], *group[:first]], math.ceil(plan.share * len(group)))
    return found


def _spread(group: Sequence[Slot], count: int) -> list[Slot]:
    return [group[place * len(group) // count] for place in range(count)]


def _strata(chosen: Sequence[type[Engine]]) -> dict[str, list[Slot]]:
    """Return the strata of a judged run with their slots; one without an engine is empty."""
    own = [e for e in chosen if not e.departs and not e.is_measured]
    other = [e for e in chosen if e.departs and not e.is_measured]
    built = [e for e in chosen if e.has_baselines]
    house = [e for e in chosen if e.is_measured]
    effects = [(e, name) for e in own for name in causes_of(e, "single", is_judged=True)]
    goal = [
        Slot("goal", e.name, "single", name, least_over=LEAST_OVER) for e, name in effects for _ in range(PER_EFFECT)
    ]
    return {
        "goal": goal,
        "null": _turns("null", own, "null", 150),
        "pair": _turns("pair", own, "pair", 50, least_over=LEAST_OVER),
        "other-null": _turns("other-null", other, "null", 80),
        "other-single": _causes_in_turn("other-single", other, "single", 80),
        "other-pair": _turns("other-pair", other, "pair", 30, least_over=LEAST_OVER),
        "family": [
            *_causes_in_turn("family", own, "family", 40),
            *_causes_in_turn("family", other, "family", 40),
        ],
        "semi-real": [
            *_causes_in_turn("semi-real", house, "single", 25, least_over=0.0),
            *_causes_in_turn("semi-real", house, "family", 7, least_over=0.0),
            *_turns("semi-real", house, "null", 8),
        ],
        "spread": [
            *_turns("spread", own, "null", 20, is_free=True),
            *_turns("spread", own, "single", 65, is_free=True),
            *_turns("spread", own, "pair", 15, is_free=True),
            *_turns("spread", own, "family", 10, is_free=True),
            *_turns("spread", other, "null", 10, is_free=True),
            *_turns("spread", other, "single", 20, is_free=True),
            *_turns("spread", other, "family", 10, is_free=True),
        ],
        "built-null": _built(_turns("built-null", built, "null", 60)),
        "built-single": _built(_causes_in_turn("built-single", built, "single", 120)),
        "built-pair": _built(_turns("built-pair", built, "pair", 40, least_over=LEAST_OVER)),
        "built-family": _built(_causes_in_turn("built-family", built, "family", 40)),
    }


def _built(slots: Sequence[Slot]) -> list[Slot]:
    return [replace(slot, has_baseline=True) for slot in slots]


def _turns(
    stratum: str, chosen: Sequence[type[Engine]], kind: Kind, count: int, is_free: bool = False, least_over: float = 0.0
) -> list[Slot]:
    """Return slots of engines in turn, whose causes are drawn."""
    if not chosen:
        return []
    names = [chosen[place % len(chosen)].name for place in range(count)]
    return [Slot(stratum, name, kind, is_free=is_free, least_over=least_over) for name in names]


def _causes_in_turn(
    stratum: str, chosen: Sequence[type[Engine]], kind: Kind, count: int, least_over: float = LEAST_OVER
) -> list[Slot]:
    """Return slots of engines in turn, each with its causes in turn."""
    if not chosen:
        return []
    lists = [causes_of(engine, kind, is_judged=True) for engine in chosen]
    pairs = [(chosen[n % len(chosen)], lists[n % len(chosen)], n // len(chosen)) for n in range(count)]
    return [Slot(stratum, e.name, kind, names[n % len(names)], least_over=least_over) for e, names, n in pairs if names]


# --- a mixture ---

MIXTURE: Sequence[tuple[Kind, float]] = (("null", 0.3), ("single", 0.4), ("pair", 0.15), ("family", 0.15))


def _mixture(chosen: Sequence[type[Engine]], cases: int, key: Key) -> list[Slot]:
    """Return slots in which engine, kind, channels and noise are drawn by themselves."""
    random = key.random("mixture")
    kinds, shares = zip(*MIXTURE, strict=True)
    slots = []
    for _ in range(cases):
        engine = chosen[int(random.integers(len(chosen)))]
        kind = kinds[int(random.choice(len(kinds), p=shares))]
        free = bool(random.random() < 0.5)
        if not causes_of(engine, kind, is_judged=False):
            kind = "single"
        slots.append(Slot("mixture", engine.name, kind, is_free=free))
    return slots
