"""Running the stages of a component's kind, one after the other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from waxstudy.conformance import declaration as said
from waxstudy.conformance import surroundings
from waxstudy.conformance.blocks import STAGES as BLOCK_STAGES
from waxstudy.conformance.effects import EFFECT_STAGES
from waxstudy.conformance.outside import OUTSIDE_STAGES
from waxstudy.conformance.stage import Problems, Stage, Subject
from waxstudy.plugin import CHAIN, BackendMissing, OutsideRoom
from waxstudy.plugin.registry import described

COMMON = (
    Stage("declaration", "name, docstring, API version", said.declaration, needed=True),
    Stage("parameters", "unit, range, description and source of each", said.documentation),
    Stage("examples", "valid, and kept when written and read", said.examples, needed=True, exemptible=True),
)
BY_KIND: Mapping[str, tuple[Stage, ...]] = {
    **{kind: BLOCK_STAGES for kind in CHAIN},
    "room": surroundings.ROOM_STAGES,
    "weather": surroundings.WEATHER_STAGES,
    "effect": EFFECT_STAGES,
    "reference": surroundings.REFERENCE_STAGES,
}
PASSED, FAILED, EXEMPT, NOT_RUN = "passed", "failed", "exempt", "not run"


@dataclass(frozen=True)
class Outcome:
    """What came of one stage; `messages` are problems, or the reason for an exemption or for not running."""

    stage: str
    claim: str
    status: str  # "passed", "failed", "exempt" or "not run"
    messages: Sequence[str] = ()


def check(component: Any, examples: Mapping[str, Mapping[str, Any]] | None = None) -> list[Outcome]:
    """Run every stage for a component; `examples` replace its own, e.g. where they need a file.

    Nothing that the component raises gets out: it becomes a message.
    """
    outcomes: list[Outcome] = []
    given = getattr(component, "examples", {}) if examples is None else examples
    subject = Subject(component, given)
    missing = ""
    for stage in _stages(component):
        outcome = _outcome(stage, subject, missing, replaced=examples is not None)
        outcomes.append(outcome)
        if stage.needed and outcome.status != PASSED and not missing:
            missing = stage.name
    return outcomes


def _stages(component: Any) -> tuple[Stage, ...]:
    """Return the stages for a component; for what is none, those that say so."""
    is_outside = isinstance(component, type) and issubclass(component, OutsideRoom)
    return (*COMMON, *BY_KIND.get(str(getattr(component, "kind", "")), ()), *(OUTSIDE_STAGES if is_outside else ()))


def _outcome(stage: Stage, subject: Subject, missing: str, replaced: bool) -> Outcome:
    result = partial(Outcome, stage.name, stage.claim)
    if missing:
        return result(NOT_RUN, [f"needs '{missing}'"])
    try:
        problems = list(_problems(stage, subject))
    except BackendMissing as error:
        return result(NOT_RUN, [str(error)])
    except (Exception, SystemExit) as error:
        problems = [f"the check failed with {described(error)}"]
    reason = "" if replaced else _exemption(stage, subject)
    if problems and reason:
        return result(EXEMPT, [reason])
    return result(FAILED if problems else PASSED, problems)


def _problems(stage: Stage, subject: Subject) -> Problems:
    found = list(stage.problems(subject))
    yield from found
    if stage is COMMON[0] and not found:
        exemptible = [s.name for s in _stages(subject.component) if s.exemptible]
        yield from said.exemptions(subject.component, exemptible)


def _exemption(stage: Stage, subject: Subject) -> str:
    return str(subject.component.exemptions.get(stage.name, "")) if stage.exemptible else ""


def assert_conforms(component: Any, examples: Mapping[str, Mapping[str, Any]] | None = None) -> None:
    """Raise `AssertionError` with every problem of every stage, each with what to do; for a package's own tests."""
    __tracebackhide__ = True
    failed = [outcome for outcome in check(component, examples) if outcome.status == FAILED]
    if failed:
        lines = [f"{outcome.stage}: {message}" for outcome in failed for message in outcome.messages]
        raise AssertionError("\n".join([f"{getattr(component, '__name__', component)} does not conform:", *lines]))
