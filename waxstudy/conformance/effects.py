"""What an effect must do, stage by stage."""

from __future__ import annotations

import copy
import re
from collections.abc import Iterator, Mapping, Sequence
from math import exp, isfinite, log
from typing import Any

import numpy as np
from pydantic import ValidationError

from waxstudy.conformance.beliefs import beliefs, difference, outcome
from waxstudy.conformance.stage import Problems, Stage, Subject
from waxstudy.plugin import STAGES, Belief, Effect, Prior
from waxstudy.plugin.registry import PluginError, hint, told

SEED = 20260101
SAME = 1e-6  # in the unit of each output
LONGEST = 240  # characters of a sentence
NEW_SENTENCE = re.compile(r"[.!?]\s+[A-Z]")


def _effect(subject: Subject) -> type[Effect]:
    assert issubclass(subject.component, Effect)
    return subject.component


# --- what it says of itself --------------------------------------------------------------------------


def priors(subject: Subject) -> Problems:
    """It names a stage of the loop, and says of each parameter, a number, where it is looked for."""
    effect = _effect(subject)
    if getattr(effect, "stage", None) not in STAGES:
        stage = getattr(effect, "stage", None)
        yield f"its stage is {stage!r}{hint(str(stage), STAGES)} (stages: {', '.join(STAGES)})"
    names = effect.absorbs if isinstance(effect.absorbs, Sequence) and not isinstance(effect.absorbs, str) else (None,)
    if not all(isinstance(name, str) for name in names):
        yield f"its `absorbs` must be a sequence of names, as ('heat-loss',), not {effect.absorbs!r}"
    if not isinstance(effect.priors, Mapping) or not all(isinstance(p, Prior) for p in effect.priors.values()):
        yield 'its priors must be a table {"fraction": Prior(low, high, noticeable=...)}'
        return
    fields = effect.Parameters.model_fields
    if not fields:
        yield "it has no parameter: an effect is fitted, so it needs one at least"
    for name in [*fields, *(name for name in effect.priors if name not in fields)]:
        if name not in effect.priors:
            yield f"parameter {name}: priors do not say where it is looked for"
        elif name not in fields:
            yield f"priors name '{name}', which is no parameter{hint(name, fields)}"
        else:
            yield from (f"parameter {name}: {wrong}" for wrong in _prior_problems(effect, name, effect.priors[name]))


def _prior_problems(effect: type[Effect], name: str, prior: Prior) -> Problems:
    if effect.Parameters.model_fields[name].annotation is not float:
        yield "declare it as float: only numbers are fitted"
    numbers = (prior.low, prior.high, prior.noticeable)
    if not all(isfinite(number) for number in numbers) or not prior.low < prior.high:
        yield f"it is looked for from {prior.low:g} to {prior.high:g}: that is no range"
        return
    if prior.is_log and prior.low <= 0.0:
        yield "on a log scale its range must begin above 0"
    if prior.is_log and prior.noticeable <= 1.0:
        yield "on a log scale `noticeable` is a factor above 1"
    if prior.noticeable <= 0.0:
        yield "`noticeable` must be above 0"
    for bound in (prior.low, prior.high):
        yield from _refusal(effect, name, bound)


def _refusal(effect: type[Effect], name: str, value: float) -> Problems:
    """Yield why a single value is outside the parameter's own bounds."""
    try:
        effect.Parameters.__pydantic_validator__.validate_assignment(effect.Parameters.model_construct(), name, value)
    except ValidationError as error:
        if refused := [e["msg"].lower() for e in error.errors() if e["loc"][:1] == (name,)]:
            yield f"priors look for it at {value:g}, which its own bounds refuse ({refused[0]})"


# --- what it does ------------------------------------------------------------------------------------


def _applicable(effect: type[Effect]) -> list[Belief]:
    """Return some beliefs that it applies to; raise `PluginError` with what it says where there is none."""
    found, hindered = [], ""
    for belief in beliefs():
        with told("hindrance failed"):
            reason: Any = effect.hindrance(belief)
        if not isinstance(reason, str):
            raise PluginError(f"hindrance gives {reason!r:.60}, not a text; an empty one where it applies")
        if reason:
            hindered = hindered or reason
        else:
            found.append(belief)
    if not found:
        raise PluginError(f"it applies to no chain and room of the installed components; it says: {hindered}")
    return [found[place] for place in sorted({0, len(found) // 2, len(found) - 1})]


def _neutral(effect: type[Effect], belief: Belief) -> Any:
    """Return the neutral parameters, or None."""
    with told("neutral failed"):
        values = effect.neutral(belief)
        return None if values is None else effect.Parameters(**values)


def neutral(subject: Subject) -> Problems:
    """It applies to something, and at its neutral parameters nothing changes."""
    effect = _effect(subject)
    try:
        for belief in _applicable(effect):
            p = _neutral(effect, belief)
            if p is None:
                continue
            with told("apply failed at the neutral parameters"):
                made: Any = effect.apply(belief, p)
            if not isinstance(made, Belief):
                yield f"apply gives {made!r:.60}, not a Belief: use belief.changed, belief.with_block or replace"
                return
            with told("what it makes of a belief cannot be simulated"):
                away = difference(outcome(belief), outcome(made))
            if away > SAME:
                yield f"at its neutral parameters, {_said(p)}, an output changes by {away:.3g}: {_of(belief)}"
                return
    except PluginError as error:
        yield str(error)


def applied(subject: Subject) -> Problems:
    """At points of its range it changes what the loop does, can be simulated, and leaves the belief it got alone."""
    effect = _effect(subject)
    try:
        tried = _applicable(effect)
        changes = [_changes(effect, belief) for belief in tried]
    except PluginError as error:
        yield str(error)
        return
    if not any(changes):
        yield f"it changes nothing at any point of its range: {'; '.join(map(_of, tried))}"


def _changes(effect: type[Effect], belief: Belief) -> bool:
    """Whether anything changes at any point; raise `PluginError` where something fails."""
    before, kept, differs = outcome(belief), copy.deepcopy(belief), False
    for p in _points(effect, belief):
        made = _made(effect, belief, p)
        if made is not None:
            with told(f"what it makes of a belief at {_said(p)} cannot be simulated"):
                found = outcome(made)
            if lost := [name for name, values in found.items() if not np.isfinite(values).any()]:
                raise PluginError(f"it makes {', '.join(lost)} no number at {_said(p)}")
            differs |= difference(before, found) > SAME
    if not _equal(kept, belief):
        raise PluginError("apply changes the belief that it is given: return another, with belief.changed or replace")
    return differs


def _made(effect: type[Effect], belief: Belief, p: Any) -> Belief | None:
    """Return what it makes of a belief, None where it says that this cannot be."""
    try:
        with told(f"apply failed at {_said(p)}", ValueError):
            return effect.apply(belief, p)
    except ValueError as error:
        if "\n" in str(error) or not str(error):
            raise PluginError(
                f"apply refuses {_said(p)} without a reason in one line: raise ValueError(...)"
            ) from error
        return None


def _points(effect: type[Effect], belief: Belief) -> Iterator[Any]:
    """Yield both ends, the middle, points between, and where a fit would start."""
    draw = np.random.default_rng(SEED)
    for place in (0.0, 1.0, 0.5, *draw.random((2, len(effect.priors)))):
        at = np.broadcast_to(place, len(effect.priors))
        yield _parameters(
            effect, {name: _at(prior, float(x)) for (name, prior), x in zip(effect.priors.items(), at, strict=True)}
        )
    with told("starts failed"):
        starts = list(effect.starts(belief))
    for start in starts:
        outside = [n for n, prior in effect.priors.items() if not prior.low <= start.get(n, prior.low) <= prior.high]
        if set(start) != set(effect.priors) or outside:
            raise PluginError(f"starts give {dict(start)}: each must name every parameter, within its priors")
        yield _parameters(effect, start)


def _at(prior: Prior, place: float) -> float:
    if prior.is_log:
        value = exp(log(prior.low) + place * (log(prior.high) - log(prior.low)))
    else:
        value = prior.low + place * (prior.high - prior.low)
    return min(prior.high, max(prior.low, value))


def _parameters(effect: type[Effect], values: Mapping[str, float]) -> Any:
    with told(f"its Parameters refuse {dict(values)}, within its priors"):
        return effect.Parameters(**values)


def _equal(one: Belief, other: Belief) -> bool:
    """Whether two beliefs hold the same values."""
    if dict(one.blocks) != dict(other.blocks) or one.room != other.room or one.inputs is None or other.inputs is None:
        return False
    pairs = zip(vars(one.inputs).values(), vars(other.inputs).values(), strict=True)
    return all(np.array_equal(a, b) if isinstance(a, np.ndarray) else a is b or a == b for a, b in pairs)


def sentence(subject: Subject) -> Problems:
    """`sentence` tells a plant engineer in one sentence what it is, at any point of its range."""
    effect = _effect(subject)
    try:
        for p in _points(effect, _applicable(effect)[0]):
            with told("sentence failed"):
                said = effect.sentence(p)
            if wrong := _sentence_problem(said):
                yield f"at {_said(p)} its sentence is {said!r:.80}: {wrong}"
                return
    except PluginError as error:
        yield str(error)


def _sentence_problem(said: Any) -> str:
    if not isinstance(said, str) or not said.strip():
        return "give a text"
    if not said.endswith(".") or not said[0].isupper() or NEW_SENTENCE.search(said) or "\n" in said:
        return "write one sentence, from a capital letter to a full stop"
    return f"write at most {LONGEST} characters" if len(said) > LONGEST else ""


def _said(p: Any) -> str:
    return ", ".join(f"{name} = {value:.4g}" for name, value in dict(p).items())


def _of(belief: Belief) -> str:
    """What a belief is made of, for a message."""
    room = () if belief.room is None else (f"room '{belief.room.component.name}'",)
    return ", ".join((*(f"{kind} '{choice.component.name}'" for kind, choice in belief.blocks.items()), *room))


EFFECT_STAGES = (
    Stage("priors", "a stage of the loop; where each parameter is looked for", priors, needed=True),
    Stage("neutral", "applies to something; nothing changes at neutral", neutral, needed=True, exemptible=True),
    Stage("apply", "changes the loop within its range, and not what it is given", applied, exemptible=True),
    Stage("sentence", "one sentence for a plant engineer", sentence),
)
