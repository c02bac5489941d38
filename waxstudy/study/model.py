"""A study: what a study file says once it is read, checked, and all defaults are filled in."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from waxstudy.plugin import Component, Parameters


@dataclass(frozen=True)
class Choice:
    """A registered component with checked parameters."""

    component: type[Component]
    parameters: Parameters

    def described(self) -> dict[str, object]:
        """The choice in the study file's words, all defaults filled in, paths as they were given."""
        return {"use": self.component.name, **self.parameters.model_dump(mode="json", exclude_none=True)}


@dataclass(frozen=True)
class Case:
    """One chain; `blocks` holds the kinds that are present, in the order of the chain."""

    id: str
    ladder: str
    blocks: Mapping[str, Choice]


@dataclass(frozen=True)
class Ladder:
    """Case ids in the order of the file, and the case that the others are compared with."""

    name: str
    reference: str
    cases: Sequence[str]


class StudyTable(Parameters):
    """`[study]`"""

    name: str
    step_s: float = 5.0


class Comfort(Parameters):
    """`[comfort]`: every case is shifted to equal comfort."""

    setpoint_C: float = 21.0
    operative_limit_C: float = 21.0
    hours_below_per_week: float = 33.0


class Ensemble(Parameters):
    """`[ensemble]`: initial states shared by all cases."""

    members: int = 16
    seed: int = 1


class Output(Parameters):
    """`[output]`: traces that are kept."""

    trace_interval_s: float = 60.0
    trace_members: int = 1


@dataclass(frozen=True)
class Study:
    """Everything a run needs. Weeks and cases keep the order of the file."""

    name: str
    step_s: float
    room: Choice
    weeks: Mapping[str, Choice]
    comfort: Comfort
    ensemble: Ensemble
    output: Output
    ladders: Mapping[str, Ladder]
    cases: Mapping[str, Case]

    def described(self) -> dict[str, object]:
        """The resolved study in the study file's words; reading it again gives the same study."""
        raise NotImplementedError
