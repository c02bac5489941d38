"""A registry with small components of every kind, named as the paper's, and a helper that reads a study text."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal

import pytest
from pydantic import Field, field_validator, model_validator

from waxstudy.plugin import (
    Actuator,
    Component,
    Controller,
    Modulator,
    Parameters,
    Reference,
    Room,
    Sensor,
    Valve,
    Weather,
    parameter,
)
from waxstudy.plugin.registry import Registry
from waxstudy.study.model import Study
from waxstudy.study.read import StudyError, read_study


def quantity(default: Any = ..., unit: str = "s", description: str = "delay", **options: Any) -> Any:
    return parameter(default, unit=unit, description=description, source="test", **options)


class DelayParameters(Parameters):
    delay_s: float = quantity(120.0, ge=0.0)


class OnOffParameters(Parameters):
    dead_band_K: float = quantity(2.0, unit="K", description="full width of the dead band", ge=0.0, le=20.0)


class PIParameters(Parameters):
    gain: float = quantity(0.3, unit="1/K", description="gain", gt=0.0)
    integration_time_s: float = quantity(300.0, gt=0.0)
    tracking_time_s: float = quantity(30.0, gt=0.0)


class TimesParameters(Parameters):
    product: Literal["A", "B"] | None = quantity(None, unit="", description="product")
    dead_s: float | None = quantity(None, ge=0.0)
    rise_s: float = quantity(100.0, gt=0.0, lt=3600.0)

    @model_validator(mode="after")
    def _one_or_the_other(self) -> TimesParameters:
        if self.product and self.dead_s is not None:
            raise ValueError("give either product or dead_s")
        return self


class Layer(Parameters):
    thickness_m: float = quantity(unit="m", description="thickness", gt=0.0)
    material: Literal["wood", "concrete"] = "wood"


class Surface(Parameters):
    area_m2: float = quantity(unit="m2", description="area", gt=0.0)
    layers: tuple[Layer, ...] = Field((), max_length=3)


class RoomParameters(Parameters):
    height_m: float = quantity(2.6, unit="m", description="clear height", gt=1.0)
    surfaces: tuple[Surface, ...] = ()
    storeys: int = Field(1, multiple_of=1)
    heated: bool = True
    curve: tuple[float, float] | None = None
    flow: float | Literal["design"] = "design"


class WeekParameters(Parameters):
    month: Literal["january", "february"] = quantity(unit="", description="month of the paper")


class EpwParameters(Parameters):
    path: str = quantity(unit="", description="weather file")
    start: str = quantity("01-01", unit="", description="first day")

    @field_validator("start")
    @classmethod
    def _has_a_dash(cls, start: str) -> str:
        if "-" not in start:
            raise ValueError("must be MM-DD, e.g. 01-20")
        return start


class FragileParameters(Parameters):
    size: float = 1.0

    @field_validator("size")
    @classmethod
    def _breaks(cls, size: float) -> float:
        return {1.0: size}[size]


def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
    return u


def made_of(cls: type[Component], *arguments: Any) -> Any:
    raise AssertionError("reading a study makes nothing")


# what a class of each base must define; a study is read without calling any of it
FUNCTIONS: dict[type[Component], tuple[str, Any]] = {
    Room: ("build", classmethod(made_of)),
    Weather: ("load", classmethod(made_of)),
    Reference: ("rows", classmethod(made_of)),
}


def component(base: type[Component], component_name: str, model: type[Parameters] = Parameters) -> type[Component]:
    name, function = FUNCTIONS.get(base, ("step", staticmethod(step)))
    return type(component_name, (base,), {"name": component_name, "Parameters": model, name: function})


COMPONENTS = (
    component(Sensor, "ideal"),
    component(Sensor, "delay", DelayParameters),
    component(Sensor, "fragile", FragileParameters),
    component(Controller, "on-off", OnOffParameters),
    component(Controller, "pi", PIParameters),
    component(Modulator, "pwm"),
    component(Actuator, "variable-times", TimesParameters),
    component(Valve, "linear"),
    component(Valve, "quick-opening"),
    component(Room, "nzeb", RoomParameters),
    component(Weather, "tallinn-week", WeekParameters),
    component(Weather, "epw", EpwParameters),
    component(Reference, "paper"),
)


@pytest.fixture(scope="session")
def registry() -> Registry:
    registry = Registry()
    for one in COMPONENTS:
        registry.add(one, "test", "1")
    return registry


@pytest.fixture
def read(tmp_path: Path, registry: Registry) -> Callable[[str], Study]:
    """Write a text to a file and read it as a study."""

    def read_text(text: str) -> Study:
        path = tmp_path / "x.toml"
        path.write_text(text, encoding="utf-8")
        return read_study(path, registry)

    return read_text


@pytest.fixture
def problems(read: Callable[[str], Study], tmp_path: Path) -> Callable[[str], list[str]]:
    """Return the printed problems of a text, without the folder."""

    def problems_of(text: str) -> list[str]:
        try:
            read(text)
        except StudyError as error:
            return str(error).replace(f"{tmp_path}/", "").splitlines()
        return []

    return problems_of
