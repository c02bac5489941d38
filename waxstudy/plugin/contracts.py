"""The contracts: what a component of each kind declares and provides.

A component is a class. It is never instantiated: it names its `Parameters`, and its functions take them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from waxstudy.plugin.model_error import ModelError
from waxstudy.plugin.parameters import Parameters, changed, checked
from waxstudy.plugin.roles import Role, RoomInput

if TYPE_CHECKING:
    import pandas as pd

API_VERSION = "1.0"

FloatArray = NDArray[np.float64]


class Refused(ValueError):
    """A value of the study that a room or weather cannot take, told at its line: key, value, and what is allowed.

    `key` is the place in a study file: "study.step_s", "weather.KEY" of the week at hand, or "room.KEY".
    """

    def __init__(self, key: str, value: object, wrong: str) -> None:
        super().__init__(wrong)
        self.key, self.value = key, value


class Component:
    """Anything that a plugin registers: a kind, a name, and documented parameters.

    `api_version` is the version of these contracts that it was written for; another major is refused.
    """

    kind: ClassVar[str]
    name: ClassVar[str]
    api_version: ClassVar[str] = API_VERSION
    Parameters: ClassVar[type[Parameters]] = Parameters
    # labelled parameter sets worth showing and testing, e.g. one per product
    examples: ClassVar[Mapping[str, Mapping[str, Any]]] = {"default": {}}
    # conformance stages that cannot hold for this component -> why
    exemptions: ClassVar[Mapping[str, str]] = {}

    @classmethod
    def contents(cls, path: Path) -> Sequence[Mapping[str, str]]:
        """Return what a file that `path` names holds for this component: a row per choice, the same columns in each.

        For `plugins show NAME FILE`. Raises `ValueError` with a one-line reason, or `BackendMissing`.
        """
        raise NotImplementedError


@dataclass(frozen=True)
class Choice:
    """A component with checked parameters."""

    component: type[Component]
    parameters: Parameters

    @classmethod
    def of(cls, component: type[Component], values: Mapping[str, Any]) -> Choice:
        """Return a component with these parameters; raise `ValueError` with a one-line reason."""
        return cls(component, checked(component.Parameters, values))

    def changed(self, **values: Any) -> Choice:
        """Return the same component with some parameters changed; raise `ValueError` with a one-line reason."""
        return Choice(self.component, changed(self.parameters, **values))

    def described(self) -> dict[str, object]:
        """The choice in the study file's words, all defaults filled in, a path as an absolute one."""
        return {"use": self.component.name, **self.parameters.model_dump(mode="json", exclude_none=True)}


# --- blocks of the control chain -------------------------------------------------------------------


@dataclass(frozen=True)
class Port:
    """An input or output of a block: what it is, its unit, and the range that the engine enforces."""

    quantity: str
    unit: str
    low: float
    high: float


TEMPERATURE = Port("temperature", "C", -100.0, 150.0)
ERROR = Port("setpoint minus reading", "K", -250.0, 250.0)
LEVEL = Port("level", "1", 0.0, 1.0)


@dataclass(frozen=True)
class Tunable:
    """Where a parameter is looked for when it is tuned; on a logarithmic scale where it counts by factors."""

    low: float
    high: float
    is_log: bool = False


@dataclass
class NoState:
    """State of a block that remembers nothing."""


class Block(Component):
    """One single-input single-output element of the chain.

    `step(p, x, u, t, dt)` is a plain function: parameters `p` and state `x` by field name, input `u` held over
    the step, time `t` at the start of the step [s], step `dt` [s]; it changes `x` in place and returns the output
    at the end of the step. Text parameters with fixed choices (`Literal`) arrive as the index of the choice (-1
    for none), an optional number that is not given as NaN.
    It must compile with numba and run unchanged in the interpreter.

    `tuned` names the parameters that a search for better ones varies, and how far.
    """

    input: ClassVar[Port] = LEVEL
    output: ClassVar[Port] = LEVEL
    tuned: ClassVar[Mapping[str, Tunable]] = {}
    State: ClassVar[type] = NoState
    step: ClassVar[Callable[..., float]]

    @classmethod
    def start(cls, p: Any, dt: float) -> Any:
        """Return the initial state for parameters `p` and step `dt` [s]."""
        return cls.State()


class Sensor(Block):
    kind = "sensor"
    input = output = TEMPERATURE


class Controller(Block):
    """A controller; `gain` [1/K] and `integration_time` [s] name the parameters that textbook rules set, if any."""

    kind = "controller"
    input = ERROR
    gain: ClassVar[str] = ""
    integration_time: ClassVar[str] = ""


class Modulator(Block):
    """A modulator; `period` names the parameter [s] after which it decides anew by its own clock, if it has one."""

    kind = "modulator"
    period: ClassVar[str] = ""


class Actuator(Block):
    """An actuator, and how far real ones are known to stray from it: |displacement error| over time, per switch [s]."""

    kind = "actuator"
    stray_s: ClassVar[float] = 0.0


class Valve(Block):
    kind = "valve"


CHAIN = ("sensor", "controller", "modulator", "actuator", "valve")


# --- weather ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Facade:
    """A direction that the sun is asked for: azimuth from north, clockwise; tilt 90 is vertical."""

    azimuth_deg: float
    tilt_deg: float = 90.0
    # above 0: each light counts by what so many panes of clear glass let through of it, relative to normal incidence
    panes: int = 0


@dataclass(frozen=True)
class WeatherRecord:
    """Weather in equal intervals, the first starting at 00:00 local standard time."""

    interval_s: float
    first_day: str  # ISO date
    outdoor_C: FloatArray  # (n,) mean of each interval
    irradiance_W_m2: Mapping[str, FloatArray]  # facade name -> (n,) global on the facade, mean of each interval
    sky_C: FloatArray | None = None  # (n,) temperature at which the sky radiates; None where nobody knows it
    file: str = ""  # the EPW file that it comes from, for an engine that reads one itself

    @property
    def duration_s(self) -> float:
        return self.interval_s * len(self.outdoor_C)


class Weather(Component):
    kind = "weather"

    @classmethod
    def load(cls, p: Any, facades: Mapping[str, Facade]) -> WeatherRecord:
        """Return the record for parameters `p`; raise `ValueError` with a one-line reason if it cannot be had."""
        raise NotImplementedError


# --- room ------------------------------------------------------------------------------------------

ROOM_OUTPUTS = (
    "sensed_C",  # what the sensor is exposed to
    "layer_C",  # floor in the plane of the pipes
    "operative_C",
    "air_C",
    "floor_surface_C",
    "floor_heat_W_m2",  # from the floor surface into the room
)


@dataclass(frozen=True)
class LinearRoom:
    """A room of capacities and conductances with one heated floor layer.

    C dT/dt = -G T + B u + f q,   y = H T + D u

    with node temperatures T [C], slow inputs u (constant over a weather interval) and the heat q [W] that the
    water gives to the floor. G is symmetric and positive definite, so that every mode is real and stable.
    """

    floor_area_m2: float
    nodes: Sequence[str]
    capacity_J_K: FloatArray  # C (n,)
    conductance_W_K: FloatArray  # G (n, n)
    inputs: Sequence[RoomInput]
    input_matrix: FloatArray  # B (n, m), W per unit of the input
    floor_heat_share: FloatArray  # f (n,), sums to 1
    output_matrix: FloatArray  # H (len(ROOM_OUTPUTS), n)
    feedthrough: FloatArray  # D (len(ROOM_OUTPUTS), m)
    air_nodes: FloatArray  # (n,) 1 where an ensemble member's air temperature applies at the start, else 0
    facades: Mapping[str, Facade]
    full_flow_L_h: float
    water_J_L_K: float  # heat capacity of the water
    # flow fraction (k,) -> heat to the floor per kelvin of supply minus layer temperature [W/K] (k,), 0 at 0
    floor_conductance_W_K: Callable[[FloatArray], FloatArray]
    # weather -> (inputs (intervals, m), supply water temperature [C] (intervals,))
    drive: Callable[[WeatherRecord], tuple[FloatArray, FloatArray]]

    def places(self, role: Role) -> list[int]:
        """Return which inputs have a role."""
        return [place for place, each in enumerate(self.inputs) if each.role is role]

    def takes(self, role: Role) -> bool:
        """Whether an input of a role gives the room anything."""
        return bool(self.input_matrix[:, self.places(role)].any())


@dataclass(frozen=True)
class Uncertainty:
    """Something that nobody knows of a room exactly: `apply(room, departure)` edits a room; 0 is what is believed.

    The departure has a normal prior of standard deviation `sd`. The edited room may be another component, and takes
    the other edits too. Where it `is_log`, the departure is the logarithm of the factor that is described.
    """

    name: str
    description: str
    sd: float
    apply: Callable[[Choice, float], Choice]
    is_log: bool = False


class Room(Component):
    kind = "room"
    # what a dataset may say of such a room in words and numbers; None where it can only be given by its parameters
    Building: ClassVar[type[Parameters] | None] = None

    @classmethod
    def of_building(cls, building: Any) -> tuple[Mapping[str, Any], Sequence[str]]:
        """Return parameters in the study file's words, and what was assumed, one sentence each.

        `building` is an instance of `Building`. Raises `ValueError` with a one-line reason.
        """
        raise NotImplementedError

    @classmethod
    def build(cls, p: Any) -> LinearRoom:
        """Return the linear room for parameters `p`; raise `ValueError` with a one-line reason."""
        raise NotImplementedError

    @classmethod
    def description(cls, p: Any) -> Any:
        """Return the room in the words of room `surfaces`, as that one's parameters, or None.

        It is what effects on leaks, masses, the floor and its circuit edit; without one they cannot apply.
        """
        return None

    @classmethod
    def of_description(cls, p: Any, description: Any) -> Choice:
        """Return the room with another description; with its own it is the same room, perhaps as another component.

        Raises `ValueError` with a one-line reason.
        """
        raise NotImplementedError

    @classmethod
    def uncertainties(cls, p: Any) -> Sequence[Uncertainty]:
        """Return what of this room nobody knows exactly; a diagnosis fits it, held by its priors."""
        return ()

    @classmethod
    def model_errors(cls, p: Any) -> Mapping[str, ModelError]:
        """Return how far the form of this model is off, by output (those of `ASSUMED`, which stands for the others)."""
        return {}

    @classmethod
    def states_curve(cls, p: Any) -> bool:
        """Whether the room has a heating curve of its own; without one a recorded supply is not held against any."""
        return True

    @classmethod
    def solar_readings(cls, p: Any) -> Mapping[str, float]:
        """Return how a recorded solar gain can be meant: a sentence -> the sun's heat over the recorded one."""
        return {}


# --- published figures -----------------------------------------------------------------------------


@dataclass(frozen=True)
class PublishedRow:
    """One case and week of a published comparison (columns as in Table 5)."""

    case: str
    week: str
    setpoint_shift_K: float
    mae_K: float
    heat_kWh_m2_week: float
    heat_vs_most_detailed_percent: float


@dataclass(frozen=True)
class Finding:
    """A published statement and what this run says of it: its mean, and how many of its single runs would say so."""

    id: str
    statement: str
    verdict: str  # "held", "not held" or "not resolved", by the mean of the ensemble
    figure: str  # the run's own figure, readable
    single_run_share: float = math.nan  # of single runs in which all of it holds
    corrected_verdict: str = ""  # the same with corrected heat, where the statement is on heat
    corrected_figure: str = ""
    corrected_single_run_share: float = math.nan
    circular: str = ""  # what was chosen by this statement, if anything was: then to hold it proves nothing


class FinishedRun(Protocol):
    """What published figures are held against: a run, of which no more is promised than this."""

    @property
    def kpis(self) -> pd.DataFrame:
        """One row per case, week and member, with columns `case`, `week` and `member` and one per key figure."""

    def durations(self, case: str, week: str) -> pd.DataFrame:
        """Return percentiles 0 to 100 (column `percent`) of channels over a week, for each `member`."""


class Reference(Component):
    """Published figures that a run can be held against."""

    kind = "reference"

    @classmethod
    def rows(cls) -> Sequence[PublishedRow]:
        raise NotImplementedError

    @classmethod
    def findings(cls, run: FinishedRun) -> Sequence[Finding]:
        """Return what the run says of each published statement; raise `ValueError` with a one-line reason."""
        return ()


KINDS = (*CHAIN, "room", "weather", "effect", "reference")
