"""Weather files in EnergyPlus's format (EPW)."""

from __future__ import annotations

import io
from codecs import BOM_UTF8
from collections.abc import Mapping, Sequence
from datetime import datetime, timedelta
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from pydantic import field_validator

from waxstudy.plugin import Facade, FloatArray, Weather, WeatherRecord, parameter
from waxstudy.plugin.files import DATA_BYTES, read_file
from waxstudy_paper.weather.sun import Sky, SunParameters, on_facade, sun_at

if TYPE_CHECKING:
    import pandas as pd

HEADER_LINES = 8
MISSING_W_M2 = 9999.0
STEFAN_BOLTZMANN = 5.670e-8  # W/(m2 K4)
COMMON_YEAR, LEAP_YEAR = 2001, 2000
PLACE = {"latitude": 90.0, "longitude": 180.0}  # the sun stands nowhere else
# pvlib's column -> what it is, and the range outside which EPW has no value (missing: 99.9 and 9999)
DRY_BULB = {"temp_air": ("dry bulb temperature", -70.0, 70.0)}
RADIATION = {
    "ghi": ("global horizontal radiation", 0.0, 9998.0),
    "dni": ("direct normal radiation", 0.0, 9998.0),
    "dhi": ("diffuse horizontal radiation", 0.0, 9998.0),
}


class EpwParameters(SunParameters):
    path: str = parameter(
        unit="", description="the weather file, relative to the study file", source="given by the user"
    )
    start: str = parameter(
        unit="", description="first day as MM-DD; the record starts at 00:00", source="given by the user"
    )
    days: int = parameter(
        7,
        unit="d",
        description="length of the record; it runs on from 31 December to 1 January",
        source="chosen: the paper simulates weeks",
        ge=1,
        le=365,
    )

    @field_validator("start")
    @classmethod
    def _is_a_day(cls, start: str) -> str:
        try:
            day = datetime.strptime(f"{LEAP_YEAR}-{start}", "%Y-%m-%d")
        except ValueError:
            raise ValueError(f"'{start}' is not a day of the year as MM-DD") from None
        return f"{day:%m-%d}"


class Stamp(NamedTuple):
    """Start of a row's hour in a year that has as many days as the file's, and the row's own year."""

    hour: datetime
    year: int

    def __str__(self) -> str:
        return f"{self.hour:%m-%d} hour {self.hour.hour + 1}"


class Epw(Weather):
    """Hourly weather from an EPW file, in its local standard time.

    Radiation covers the hour that ends at a row's stamp: the sun stands where it stands in the middle of that
    hour. The dry bulb is a reading at the stamp: an interval gets the mean of the readings at both its ends.
    The sky's temperature is that of a black body with the file's horizontal infrared radiation, if it has it.
    Raises `ValueError` with one line that names the file and the place. Source: EnergyPlus, Auxiliary Programs.
    """

    name = "epw"
    api_version = "1.0"
    Parameters = EpwParameters
    examples = {}
    exemptions = {"examples": "it reads a weather file that the user has"}

    @classmethod
    def load(cls, p: EpwParameters, facades: Mapping[str, Facade]) -> WeatherRecord:
        import pandas as pd

        lines = _lines(p.path)
        stamps = _stamps(p.path, lines)
        rows = _rows(p, stamps)
        data, site = _table(p.path, lines, stamps, rows)
        _refuse_missing(p.path, data, DRY_BULB, stamps, rows)
        hours = data.iloc[1:]  # the first row only gives the temperature at 00:00
        _refuse_missing(p.path, hours, RADIATION, stamps, rows[1:])
        middle = pd.DatetimeIndex(hours.index) + pd.Timedelta(minutes=30)
        sun = sun_at(middle, site["latitude"], site["longitude"])
        sky = Sky(*(hours[column].to_numpy(dtype=float) for column in ("dni", "dhi", "ghi")))
        dry_bulb_C = data["temp_air"].to_numpy(dtype=float)
        return WeatherRecord(
            interval_s=3600.0,
            first_day=f"{hours.index[0]:%Y-%m-%d}",
            outdoor_C=(dry_bulb_C[:-1] + dry_bulb_C[1:]) / 2.0,
            irradiance_W_m2={name: on_facade(facade, sun, sky, p.albedo) for name, facade in facades.items()},
            sky_C=_sky_C(hours),
            file=p.path,
        )


def _lines(path: str) -> list[str]:
    """Return the file's lines; place names may be in any encoding, figures are ASCII."""
    try:
        data = read_file(path, DATA_BYTES).removeprefix(BOM_UTF8)
    except OSError as error:
        raise ValueError(f"{path}: cannot be read ({error.strerror})") from None
    # lines are split as bytes: in other encodings a byte of a letter may be a line's end to Python
    lines = [line.decode("latin-1") for line in data.rstrip().splitlines()]
    if not lines or not lines[0].startswith("LOCATION,"):
        raise ValueError(f"{path}: not an EPW file: its first line does not start with LOCATION")
    if len(lines) <= HEADER_LINES:
        raise ValueError(f"{path}: ends after line {len(lines)}, before any hour of weather")
    return lines


def _stamps(path: str, lines: Sequence[str]) -> list[Stamp]:
    """Return the stamp of every row; refuse a file whose hours do not follow each other."""
    rows = [line.split(",", 4)[:4] for line in lines[HEADER_LINES:]]
    leap = any([field.lstrip("0") for field in row[1:3]] == ["2", "29"] for row in rows)
    stamps: list[Stamp] = []
    for number, row in enumerate(rows, start=HEADER_LINES + 1):
        try:
            year, month, day, hour = map(int, row)
            stamp = Stamp(datetime(LEAP_YEAR if leap else COMMON_YEAR, month, day, hour - 1), year)
        except ValueError:
            raise ValueError(f"{path} line {number}: not a row of year, month, day, hour 1 to 24") from None
        if stamps and not _follows(stamp, stamps[-1]):
            raise ValueError(
                f"{path} line {number}: {stamp} follows {stamps[-1]}: hours are missing, doubled or out of order"
            )
        stamps.append(stamp)
    return stamps


def _follows(stamp: Stamp, before: Stamp) -> bool:
    """Tell whether an hour is the next one; the year is a circle."""
    year = timedelta(days=366 if stamp.hour.year == LEAP_YEAR else 365)
    return (stamp.hour - before.hour) % year == timedelta(hours=1)


def _rows(p: EpwParameters, stamps: Sequence[Stamp]) -> list[int]:
    """Return the rows of the record, and before them the one that ends where it starts."""
    starts = [i for i, stamp in enumerate(stamps) if f"{stamp.hour:%m-%d %H}" == f"{p.start} 00"]
    if not starts:
        raise ValueError(f"{p.path}: has no {p.start} hour 1")
    rows = range(starts[0] - 1, starts[0] + 24 * p.days)
    whole_year = _follows(stamps[0], stamps[-1])
    if not whole_year and (rows[0] < 0 or rows[-1] >= len(stamps)):
        days = "a day" if p.days == 1 else f"{p.days} days"
        raise ValueError(
            f"{p.path}: holds {stamps[0]} to {stamps[-1]}, which is less than {days} from {p.start} and the hour before"
        )
    return [row % len(stamps) for row in rows]


def _table(
    path: str, lines: Sequence[str], stamps: Sequence[Stamp], rows: Sequence[int]
) -> tuple[pd.DataFrame, dict[str, Any]]:
    """Return the rows as pvlib reads them, each indexed by the start of its hour, and the header's site."""
    from pvlib.iotools import read_epw

    years = {stamp.year for stamp in stamps}
    # a typical year is pieced together from many: give it one of its own
    year = years.pop() if len(years) == 1 else stamps[0].hour.year
    text = "\n".join([*lines[:HEADER_LINES], *(lines[HEADER_LINES + row] for row in rows)])
    try:
        data, site = read_epw(io.StringIO(text), coerce_year=year)
    except (ValueError, KeyError, TypeError):
        raise ValueError(f"{path}: not an EPW file that pvlib can read") from None
    for what, most in PLACE.items():
        if not abs(site[what]) <= most:
            raise ValueError(f"{path} line 1: {what} {site[what]:g} is not within -{most:g} to {most:g} degrees")
    return data, site


def _sky_C(hours: pd.DataFrame) -> FloatArray | None:
    """Return the temperature of a black sky that radiates as the file says, None where an hour of it is missing."""
    radiation_W_m2 = hours["ghi_infrared"].to_numpy(dtype=float)
    if not np.all((radiation_W_m2 > 0.0) & (radiation_W_m2 < MISSING_W_M2)):
        return None
    return np.asarray((radiation_W_m2 / STEFAN_BOLTZMANN) ** 0.25 - 273.15)


def _refuse_missing(
    path: str,
    data: pd.DataFrame,
    columns: Mapping[str, tuple[str, float, float]],
    stamps: Sequence[Stamp],
    rows: Sequence[int],
) -> None:
    """Raise for the first value that is not a number or outside its range, as the markers for missing ones are."""
    import pandas as pd

    for column, (quantity, low, high) in columns.items():
        values: FloatArray = pd.to_numeric(data[column], errors="coerce").to_numpy(dtype=float)
        bad = np.flatnonzero(~((values >= low) & (values <= high)))
        if len(bad):
            row = rows[bad[0]]
            raise ValueError(
                f"{path} line {HEADER_LINES + 1 + row}: {stamps[row]}: {quantity} is missing or "
                f"impossible ({data[column].iloc[bad[0]]}); {len(bad)} such hours in these days"
            )
