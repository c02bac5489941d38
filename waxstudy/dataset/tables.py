"""The tables of dataset.toml that are not of a study: [dataset], [site], [columns] and the like."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Field, field_validator, model_validator

from waxstudy.dataset.channels import CHANNELS
from waxstudy.dataset.limits import MOST_UNCERTAIN
from waxstudy.dataset.zones import is_zone, zone_hint
from waxstudy.plugin import Parameters, parameter
from waxstudy.plugin.registry import hint

TRUSTED = ("room_tolerance", "room_error_factor")  # keys of [dataset] that say how far a room is trusted


def given(description: str, default: Any = None, unit: str = "", **options: Any) -> Any:
    """Declare what the user may give."""
    return parameter(default, unit=unit, description=description, source="given by the user", **options)


class DatasetTable(Parameters):
    """`[dataset]`"""

    name: str | None = given("name; the folder's, if not given")
    origin: str | None = given("where the record comes from")
    interval_s: float | None = given(
        "interval of the grid; the usual distance of the stamps, if not given", unit="s", ge=0.1, le=86_400.0
    )
    inputs: Annotated[tuple[str, ...], Field(strict=False)] | dict[str, float] = given(
        "channels that are assumed rather than measured, or that something stands in for; a table says how uncertain "
        "each is: the standard deviation of the logarithm of a factor",
        (),
    )
    room_tolerance: float = given(
        "factor on how far the room may lie from what is known of it; above 1 for a rough guess",
        1.0,
        unit="1",
        ge=0.1,
        le=20.0,
    )
    room_error_factor: float = given(
        "factor on the error that the room states of its model; above 1 for a room unlike those it was held against",
        1.0,
        unit="1",
        ge=1.0,
        le=20.0,
    )
    file: str | None = given("data file, if it is not data.csv or data.parquet beside dataset.toml")
    stamps: Literal["end", "start"] = parameter(
        "end", unit="", description="which end of its interval a row's time stamps", source="section Format"
    )
    time_format: str | None = given('format of the stamps, as in "%d.%m.%Y %H:%M"; ISO 8601 if not given')
    separator: Literal[",", ";", "\t", "|"] | None = given("between the cells; found from the header, if not given")
    decimal: Literal[".", ","] | None = given("mark of decimals; found from the first rows, if not given")

    @field_validator("inputs")
    @classmethod
    def _are_channels(cls, inputs: tuple[str, ...] | dict[str, float]) -> tuple[str, ...] | dict[str, float]:
        for name in inputs:
            if name not in CHANNELS:
                raise ValueError(f"'{name}' is no channel{hint(name, CHANNELS)}")
        if isinstance(inputs, dict):
            for name, spread in inputs.items():
                if not 0.0 < spread <= MOST_UNCERTAIN:
                    raise ValueError(f"{name} = {spread:g}: must be above 0, and {MOST_UNCERTAIN:g} at most")
        return inputs

    @property
    def spreads(self) -> dict[str, float]:
        """How uncertain inputs are whose uncertainty is stated."""
        return dict(self.inputs) if isinstance(self.inputs, dict) else {}


class Site(Parameters):
    """`[site]`: where the room is, in the words of pvlib's `Location`."""

    latitude: float = given("north of the equator", ..., unit="deg", ge=-90.0, le=90.0)
    longitude: float | None = given("east of Greenwich; noon at 12 h, if not given", unit="deg", ge=-180.0, le=180.0)
    altitude: float = given("above the sea", 0.0, unit="m", ge=-500.0, le=9000.0)
    timezone: str | None = given('of the stamps, as "Europe/Tallinn"; by stamps or longitude, if not given')
    # of photovoltaic panels whose power was recorded
    panels_peak_W: float | None = given("peak power of the panels", unit="W", gt=0.0, le=1e7)
    panels_tilt_deg: float = given("tilt of the panels; 90 is upright", 35.0, unit="deg", ge=0.0, le=90.0)
    panels_azimuth_deg: float = given("where they face, from north, clockwise", 180.0, unit="deg", ge=0.0, le=360.0)

    @field_validator("timezone")
    @classmethod
    def _is_known(cls, timezone: str | None) -> str | None:
        if timezone is not None and not is_zone(timezone):
            raise ValueError(f"'{timezone}' is no time zone{zone_hint(timezone)}")
        return timezone


class Nominal(Parameters):
    """What `[nominal]` says besides the chain."""

    # bounds as in [comfort] of a study
    setpoint_C: float | None = given("setpoint that is believed where none was measured", unit="C", ge=5.0, le=40.0)


FACTORS: dict[str, Any] = {"ge": -1e9, "le": 1e9}  # beyond any unit


class Part(Parameters):
    """A column of a foreign file, with a weight of its own."""

    column: str = given("name of the file's column", ...)
    scale: float = given("factor", 1.0, unit="1", **FACTORS)


class Column(Parameters):
    """An entry of `[columns]`: channel = scale times a column, or a mean or sum of columns, plus offset."""

    column: str | None = given("name of the file's column")
    mean: tuple[str | Part, ...] | None = given("columns whose mean is the channel", min_length=1, strict=False)
    sum: tuple[str | Part, ...] | None = given("columns whose sum is the channel", min_length=1, strict=False)
    scale: float = given("factor on the file's values", 1.0, unit="1", **FACTORS)
    offset: float = given("added to the scaled values", 0.0, **FACTORS)

    @model_validator(mode="after")
    def _is_one_of_them(self) -> Self:
        if sum(given is not None for given in (self.column, self.mean, self.sum)) != 1:
            raise ValueError("give one of column, mean and sum")
        return self

    @field_validator("scale")
    @classmethod
    def _keeps_something(cls, scale: float) -> float:
        if scale == 0.0:
            raise ValueError("a scale of 0 leaves nothing of the column")
        return scale

    @property
    def parts(self) -> tuple[Part, ...]:
        columns = self.mean or self.sum or ((self.column,) if self.column is not None else ())
        return tuple(part if isinstance(part, Part) else Part(column=part) for part in columns)
