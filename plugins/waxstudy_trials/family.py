"""A family: something that real plants do and no effect of the library describes, put into the fast room."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from waxstudy.plugin import Choice, Effect, FloatArray, Parameters, parameter
from waxstudy.plugin.trial import Cause

Channels = Mapping[str, FloatArray]


class Family(Effect):
    """An edit of a belief like an effect's, but never registered, so that no diagnosis can try it.

    `stages` are where an answer may place it, its own first. A logger's family changes nothing but what is recorded.
    """

    stages: ClassVar[tuple[str, ...]]
    is_kept: ClassVar[bool] = False
    is_logger: ClassVar[bool] = False
    api_version = "1.0"

    @classmethod
    def cause(cls) -> Cause:
        about = (cls.__doc__ or "").splitlines()[0]
        return Cause(cls.name, cls.stages, is_family=True, is_kept=cls.is_kept, about=about)

    @classmethod
    def log(cls, p: Any, channels: Channels, step_s: float) -> dict[str, FloatArray]:
        """Return the channels that a logger shows otherwise than they are."""
        return {}


def logged(channels: Channels, step_s: float, choices: Sequence[Choice]) -> tuple[Channels, list[Channels]]:
    """Return what is logged, and for each family of a logger what would be without it."""
    without: list[Channels] = []
    for choice in choices:
        family = choice.component
        changed = family.log(choice.parameters, channels, step_s) if issubclass(family, Family) else {}
        without.append({name: channels[name] for name in changed})
        channels = {**channels, **changed}
    return channels, without


def one(name: str, default: float, unit: str, description: str, low: float, high: float) -> type[Parameters]:
    """Return parameters of a single field; at `default` the family does nothing."""
    field = parameter(default, unit=unit, description=description, source="chosen", ge=low, le=high)
    return type(f"{name}Parameters", (Parameters,), {"__annotations__": {name: float}, name: field})
