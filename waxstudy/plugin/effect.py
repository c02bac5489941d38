"""The contract of an effect: a named edit of what the modeller believes, with free parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, ClassVar

from waxstudy.plugin.contracts import CHAIN, Choice, Component, FloatArray

# the links of the loop where a gap can lie
STAGES = (*CHAIN, "emitter", "room")
HOURS = ("from_h", "to_h")  # parameters of an effect that acts between two hours of every day


@dataclass(frozen=True)
class Inputs:
    """What drove the room, as recorded or assumed; each array is (n,), NaN-free, one value per interval.

    Temperatures are values at the end of an interval, the rest means over it.
    """

    interval_s: float
    start_s: float  # start of the first interval after midnight
    outdoor_C: FloatArray
    supply_C: FloatArray
    solar_W: FloatArray
    gains_W: FloatArray
    air_C: FloatArray  # the room's own air, smoothed, for what exchanges heat with it
    ventilation_C: FloatArray | None = None  # supply air; None leaves what the room says
    flow_L_h: FloatArray | None = None  # through the circuit, where it was recorded
    signal: FloatArray | None = None  # heating signal, where it was recorded
    neighbour_C: FloatArray | None = None
    extra_W: FloatArray | None = None  # heat that an effect gives to the air
    added_flow_L_h: FloatArray | None = None  # beyond the recorded or modelled flow, as while nothing was recorded
    start_K: float = 0.0  # how much warmer all of the room is at the start than the first day, repeated, would make it
    start_floor_K: float = 0.0  # and its heated floor besides
    stand_ins: frozenset[str] = frozenset()  # fields of this class that nobody recorded: something else is in them

    @property
    def hour(self) -> FloatArray:
        """Hour of the day at the middle of each interval (n,); read-only."""
        return _hours(len(self.outdoor_C), self.interval_s, self.start_s)


@lru_cache(maxsize=8)
def _hours(count: int, interval_s: float, start_s: float) -> FloatArray:
    import numpy as np

    hours: FloatArray = (start_s + (np.arange(count, dtype=float) + 0.5) * interval_s) % 86_400 / 3600
    hours.flags.writeable = False
    return hours


@dataclass(frozen=True)
class Belief:
    """What the modeller believes, and what an effect edits: the chain's blocks by kind, the room, its inputs."""

    blocks: Mapping[str, Choice]
    room: Choice | None = None
    inputs: Inputs | None = None
    room_error_factor: float = 1.0  # on the error that the room states of its model

    def has(self, kind: str, *parameters: str) -> bool:
        """Whether there is a block of this kind and it has all these parameters."""
        block = self.blocks.get(kind)
        return block is not None and all(name in type(block.parameters).model_fields for name in parameters)

    def value(self, kind: str, parameter: str) -> float:
        """Return the believed value of a block's parameter."""
        return float(getattr(self.blocks[kind].parameters, parameter))

    def with_block(self, kind: str, choice: Choice) -> Belief:
        """Return the belief with another block of this kind, or with one where there was none."""
        blocks = {**self.blocks, kind: choice}
        return replace(self, blocks={kind: blocks[kind] for kind in CHAIN if kind in blocks})

    def changed(self, kind: str, **values: float) -> Belief:
        """Return the belief with parameters of a block changed; raise `ValueError` with a one-line reason."""
        return self.with_block(kind, self.blocks[kind].changed(**values))


@dataclass(frozen=True)
class Prior:
    """Where a parameter of an effect is looked for. `noticeable` is the least departure from neutral worth naming.

    `as_built` says how far healthy loops are from their documents, where that is no effect: the standard deviation of
    a departure from neutral, of its logarithm where `is_log`; 0 where documents and loop do not differ so. `varies` is
    the same of one healthy record from another of the same loop: people do not live alike every week.
    """

    low: float
    high: float
    noticeable: float  # a factor above 1 where `is_log`, else in the parameter's unit
    is_log: bool = False
    as_built: float = 0.0
    varies: float = 0.0


class Effect(Component):
    """An edit of a belief; it changes nothing at `neutral`. `priors` says where its parameters are looked for."""

    kind = "effect"
    stage: ClassVar[str]  # one of STAGES
    priors: ClassVar[Mapping[str, Prior]] = {}
    # names of uncertainties that rest while it is there, and of effects that are not tried beside it
    absorbs: ClassVar[Sequence[str]] = ()
    replaces: ClassVar[bool] = (
        False  # puts another block in a believed one's place, and so comes before what acts on it
    )

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        """Return why the effect cannot apply to this belief, or an empty text."""
        return ""

    @classmethod
    def neutral(cls, belief: Belief) -> Mapping[str, float] | None:
        """Return the parameters at which it does nothing, or None where there are none (a block is replaced).

        A parameter that is left out may then be anything: the hours of a window through which no air comes.
        """
        return {name: float(field.default) for name, field in cls.Parameters.model_fields.items()}

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        """Return the belief with the effect; raise `ValueError` with a one-line reason where p is impossible."""
        raise NotImplementedError

    @classmethod
    def hours(cls, p: Any) -> tuple[float, float] | None:
        """Return the hours of each day from and to which it acts, None of what acts always."""
        return (p.from_h, p.to_h) if cls.has_hours() else None

    @classmethod
    def has_hours(cls) -> bool:
        """Whether hours of the day, between which it acts, are looked for."""
        return set(HOURS) <= cls.priors.keys()

    @classmethod
    def sentence(cls, p: Any) -> str:
        """Return what a plant engineer should read, one sentence."""
        raise NotImplementedError

    @classmethod
    def starts(cls, belief: Belief) -> Sequence[Mapping[str, float]]:
        """Return parameters to start a fit from, where the corners of `priors` would miss the best."""
        return ()
