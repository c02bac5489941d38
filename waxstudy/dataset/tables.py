"""The tables of dataset.toml that are not of a study: [dataset], [site], [columns], [noise], setpoint of [nominal]."""

from __future__ import annotations

from typing import Literal, Self
from zoneinfo import available_timezones

from pydantic import field_validator, model_validator

from waxstudy.dataset.channels import CHANNELS
from waxstudy.plugin import Parameters, parameter
from waxstudy.plugin.registry import nearest

USER = "given by the user"


class DatasetTable(Parameters):
    """`[dataset]`"""

    name: str | None = parameter(None, unit="", description="name; the folder's, if not given", source=USER)
    origin: str | None = parameter(None, unit="", description="where the record comes from", source=USER)
    interval_s: float | None = parameter(
        None,
        unit="s",
        description="interval of the grid; the usual distance of the stamps, if not given",
        source=USER,
        ge=0.1,
        le=86_400.0,
    )
    inputs: tuple[str, ...] = parameter(
        (), unit="", description="channels that are assumed rather than measured", source=USER, strict=False
    )
    room_tolerance: float = parameter(
        1.0,
        unit="1",
        description="factor on how far the room may lie from what is known of it; above 1 for a rough guess",
        source=USER,
        ge=0.1,
        le=20.0,
    )
    room_error_factor: float = parameter(
        1.0,
        unit="1",
        description="factor on the error that the room states of its model; above 1 for a room unlike those it was "
        "held against",
        source=USER,
        ge=1.0,
        le=20.0,
    )
    file: str | None = parameter(
        None, unit="", description="data file, if it is not data.csv or data.parquet beside dataset.toml", source=USER
    )
    stamps: Literal["end", "start"] = parameter(
        "end", unit="", description="which end of its interval a row's time stamps", source="section Format"
    )
    time_format: str | None = parameter(
        None, unit="", description='format of the stamps, as in "%d.%m.%Y %H:%M"; ISO 8601 if not given', source=USER
    )
    separator: Literal[",", ";", "\t", "|"] | None = parameter(
        None, unit="", description="between the cells; found from the header, if not given", source=USER
    )
    decimal: Literal[".", ","] | None = parameter(
        None, unit="", description="mark of decimals; found from the first rows, if not given", source=USER
    )

    @field_validator("inputs")
    @classmethod
    def _are_channels(cls, inputs: tuple[str, ...]) -> tuple[str, ...]:
        for name in inputs:
            if name not in CHANNELS:
                near = nearest(name, CHANNELS)
                hint = f"; did you mean '{near}'?" if near else ""
                raise ValueError(f"'{name}' is no channel{hint}")
        return inputs


class Site(Parameters):
    """`[site]`: where the room is, in the words of pvlib's `Location`."""

    latitude: float = parameter(unit="deg", description="north of the equator", source=USER, ge=-90.0, le=90.0)
    longitude: float | None = parameter(
        None, unit="deg", description="east of Greenwich; noon at 12 h, if not given", source=USER, ge=-180.0, le=180.0
    )
    altitude: float = parameter(0.0, unit="m", description="above the sea", source=USER, ge=-500.0, le=9000.0)
    timezone: str | None = parameter(
        None, unit="", description='of the stamps, as "Europe/Tallinn"; by the longitude, if not given', source=USER
    )

    @field_validator("timezone")
    @classmethod
    def _is_known(cls, timezone: str | None) -> str | None:
        if timezone is not None and timezone not in available_timezones():
            near = nearest(timezone, available_timezones())
            hint = f"; did you mean '{near}'?" if near else ""
            raise ValueError(f"'{timezone}' is no time zone{hint}")
        return timezone


class Nominal(Parameters):
    """What `[nominal]` says besides the chain."""

    setpoint_C: float | None = parameter(
        None,
        unit="C",
        description="setpoint that is believed where none was measured",
        source="given by the user; bounds as in [comfort] of a study",
        ge=5.0,
        le=40.0,
    )


class Part(Parameters):
    """A column of a foreign file, with a weight of its own."""

    column: str = parameter(unit="", description="name of the file's column", source=USER)
    scale: float = parameter(1.0, unit="1", description="factor", source=USER)


class Column(Parameters):
    """An entry of `[columns]`: channel = scale times a column, or a mean or sum of columns, plus offset."""

    column: str | None = parameter(None, unit="", description="name of the file's column", source=USER)
    mean: tuple[str | Part, ...] | None = parameter(
        None, unit="", description="columns whose mean is the channel", source=USER, min_length=1, strict=False
    )
    sum: tuple[str | Part, ...] | None = parameter(
        None, unit="", description="columns whose sum is the channel", source=USER, min_length=1, strict=False
    )
    scale: float = parameter(1.0, unit="1", description="factor on the file's values", source=USER)
    offset: float = parameter(0.0, unit="", description="added to the scaled values", source=USER)

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
