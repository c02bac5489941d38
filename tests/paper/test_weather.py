"""The paper's synthetic weeks and weather files."""

from __future__ import annotations

from collections.abc import Callable
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from tests.conftest import DATA
from waxstudy.plugin import Facade, FloatArray, WeatherRecord
from waxstudy.plugin.glass import diffuse_through_glass, through_glass
from waxstudy_paper.weather import Epw, TallinnWeek
from waxstudy_paper.weather.sun import Sky, clear_sky, on_facade, sun_at
from waxstudy_paper.weather.tallinn import clear_share

FACADES = {"south": Facade(180.0), "west": Facade(270.0), "north": Facade(0.0), "east": Facade(90.0)}
MONTHS = ("january", "february")
PUBLISHED = {"january": (-1.9, 0.15), "february": (-6.8, 0.82)}


def week(month: str, **parameters: object) -> WeatherRecord:
    return TallinnWeek.load(TallinnWeek.Parameters(month=month, **parameters), FACADES)


def gain_kWh_m2(record: WeatherRecord) -> float:
    """Sun transmitted by the paper's windows: 3 m2 south, 3 m2 west, 0.88 of g 0.3, 10.4 m2 of floor."""
    sun = record.irradiance_W_m2["south"] + record.irradiance_W_m2["west"]
    return float(3.0 * 0.88 * 0.3 * sun.sum() * record.interval_s / 3.6e6 / 10.4)


def by_day(values: FloatArray) -> FloatArray:
    return np.reshape(values, (7, -1))


# --- the paper's weeks -----------------------------------------------------------------------------


@pytest.mark.parametrize("month", MONTHS)
def test_a_week_has_the_published_mean_temperature_and_solar_gain(month: str) -> None:
    record = week(month)
    assert (record.outdoor_C.mean(), gain_kWh_m2(record)) == pytest.approx(PUBLISHED[month], rel=1e-12)
    assert record.duration_s == 7 * 86400


@settings(max_examples=20, deadline=None)
@given(
    month=st.sampled_from(MONTHS),
    seed=st.integers(0, 2**40),
    sun_by_day=st.lists(st.floats(0.3, 1.0), min_size=7, max_size=7),
    interval_s=st.sampled_from([300.0, 1200.0, 3600.0]),
)
def test_the_published_figures_hold_for_any_seed_interval_and_days_of_sun(
    month: str, seed: int, sun_by_day: list[float], interval_s: float
) -> None:
    record = week(month, seed=seed, sun_by_day=sun_by_day, interval_s=interval_s)
    assert (record.outdoor_C.mean(), gain_kWh_m2(record)) == pytest.approx(PUBLISHED[month], rel=1e-10)


def test_a_seed_gives_its_own_temperatures_and_always_the_same() -> None:
    first, again, other = (week("january", seed=seed).outdoor_C for seed in (1, 1, 2))
    assert np.array_equal(first, again)
    assert np.abs(first - other).max() > 1.0
    assert first.mean() == pytest.approx(other.mean(), abs=1e-12)


@pytest.mark.parametrize("month", MONTHS)
def test_a_facade_gets_the_same_sun_whichever_others_are_asked_for(month: str) -> None:
    together = week(month)
    for name, facade in FACADES.items():
        alone = TallinnWeek.load(TallinnWeek.Parameters(month=month), {"mine": facade})
        assert np.array_equal(alone.irradiance_W_m2["mine"], together.irradiance_W_m2[name])
        assert np.array_equal(alone.outdoor_C, together.outdoor_C)


def test_a_finer_interval_is_the_same_weather() -> None:
    hourly, fine = week("february"), week("february", interval_s=300.0)
    assert np.allclose(fine.outdoor_C.reshape(-1, 12).mean(axis=1), hourly.outdoor_C, atol=1e-12)
    for name in FACADES:
        means = fine.irradiance_W_m2[name].reshape(-1, 12).mean(axis=1)
        assert np.allclose(means, hourly.irradiance_W_m2[name], atol=1e-10)


@pytest.mark.parametrize("month", MONTHS)
def test_no_hour_is_brighter_than_under_a_clear_sky(month: str) -> None:
    record = week(month)
    start = pd.Timestamp(record.first_day, tz="Etc/GMT-2") + pd.Timedelta(seconds=30)
    sun = sun_at(pd.date_range(start, periods=7 * 1440, freq="min"), 59.4, 24.8)
    for name, facade in FACADES.items():
        clear = on_facade(facade, sun, clear_sky(sun, 2.5), 0.2).reshape(-1, 60).mean(axis=1)
        assert np.all(record.irradiance_W_m2[name] <= 1.01 * clear + 1.0)
    assert 0.0 < clear_share(TallinnWeek.Parameters(month=month)).max() < 1.0


def test_the_sun_shines_on_the_days_that_are_named() -> None:
    sun_by_day = (0.0, 1.0, 0.0, 0.5, 0.0, 1.0, 0.0)
    south = by_day(week("february", sun_by_day=sun_by_day).irradiance_W_m2["south"]).sum(axis=1)
    dull, half, full = south[[0, 2, 4, 6]], south[3], south[[1, 5]]
    assert dull.max() < half < full.min()
    assert half == pytest.approx((dull.mean() + full.mean()) / 2.0, rel=0.05)


def test_sunny_days_swing_wider_and_are_colder() -> None:
    outdoor = by_day(week("february", noise_K=0.0, sun_by_day=(0, 0, 1, 1, 1, 0, 0)).outdoor_C)
    assert np.ptp(outdoor[3]) > np.ptp(outdoor[0]) + 1.0
    assert outdoor[3].mean() < outdoor[0].mean() - 1.0
    assert list(outdoor[3].argsort()[[0, -1]]) in ([6, 13], [6, 14], [7, 13], [7, 14])


@pytest.mark.parametrize("month", MONTHS)
def test_the_sun_comes_to_the_east_then_the_south_then_the_west(month: str) -> None:
    record = week(month)
    hour = np.arange(168) % 24 + 0.5
    east, south, west = (np.average(hour, weights=record.irradiance_W_m2[f]) for f in ("east", "south", "west"))
    noon = 12.0 + (30.0 - 24.8) / 15.0  # of local standard time, without the equation of time (4 to 14 min late)
    assert east + 0.4 < south < west - 0.4
    assert noon < south < noon + 0.3


@pytest.mark.parametrize(("month", "night_until", "night_from"), [("january", 8, 16), ("february", 7, 18)])
def test_there_is_no_sun_at_night(month: str, night_until: int, night_from: int) -> None:
    hour = np.arange(168) % 24
    night = (hour < night_until) | (hour >= night_from)
    for irradiance in week(month).irradiance_W_m2.values():
        assert np.all(irradiance[night] == 0.0)
        assert np.all(by_day(irradiance)[:, 12] > 0.0)


def test_the_north_gets_direct_sun_in_june_and_none_in_january() -> None:
    for day, gets in (("2021-01-04", False), ("2021-06-21", True)):
        sun = sun_at(pd.date_range(day, periods=96, freq="15min", tz="Etc/GMT-2"), 59.4, 24.8)
        none = np.zeros(96)
        direct_only = Sky(np.full(96, 500.0), none, none)
        assert on_facade(FACADES["north"], sun, direct_only, 0.2).any() == gets
        assert on_facade(FACADES["south"], sun, direct_only, 0.2).any()


def test_the_light_of_a_low_sun_comes_evenly_from_the_whole_sky() -> None:
    sun = sun_at(pd.date_range("2021-02-08", periods=1440, freq="min", tz="Etc/GMT-2"), 59.4, 24.8)
    bright = Sky(np.full(1440, 600.0), np.full(1440, 40.0), np.full(1440, 60.0))
    low = sun.zenith_deg > 87.0
    for facade in FACADES.values():
        irradiance = on_facade(facade, sun, bright, 0.2)
        assert np.allclose(irradiance[low], 60.0 / 2.0 + 0.2 * 60.0 / 2.0)
        assert irradiance.max() < 600.0 + 3.0 * 60.0
    assert np.allclose(on_facade(Facade(180.0, tilt_deg=0.0), sun, bright, 0.2)[low], 60.0)


@pytest.mark.parametrize(
    ("parameters", "reason"),
    [
        (
            {"sun_by_day": (0, 1, 0, 0, 0, 0, 0)},
            r"february: .* 0\.82 kWh/m2 needs 1\.\d+ times a clear sky on day 2",
        ),
        ({"overcast_transmittance": 1.0, "albedo": 0.9}, r"0\.82 kWh/m2 is less than the .* of an overcast week"),
    ],
)
def test_a_gain_that_no_sky_can_give_is_refused_in_one_line(parameters: dict[str, object], reason: str) -> None:
    with pytest.raises(ValueError, match=reason) as refusal:
        week("february", **parameters)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    ("parameters", "reason"),
    [
        ({"month": "march"}, "Input should be 'january' or 'february'"),
        ({"sun_by_day": [1.0] * 6}, "at least 7 items"),
        ({"sun_by_day": [0.0] * 7}, "no day has sun"),
        ({"sun_by_day": ["1"] * 7}, "valid number"),
        ({"sun_by_day": [-1.0] * 7}, "greater than or equal to 0"),
        ({"interval_s": 2100.0}, "divides the hour"),
        ({"interval_s": 60.0}, "greater than or equal to 300"),
    ],
)
def test_parameters_that_make_no_week_are_refused(parameters: dict[str, object], reason: str) -> None:
    with pytest.raises(ValidationError, match=reason):
        TallinnWeek.Parameters(**{"month": "january", **parameters})


@pytest.mark.parametrize("month", MONTHS)
def test_the_month_s_defaults_are_written_out_and_read_back(month: str) -> None:
    p = TallinnWeek.Parameters(month=month)
    written = p.model_dump(mode="json")
    assert (written["outdoor_mean_C"], written["solar_gain_kWh_m2_week"]) == PUBLISHED[month]
    assert len(written["sun_by_day"]) == 7
    assert TallinnWeek.Parameters(**written) == p


# --- glass -----------------------------------------------------------------------------------------

# g of clear double glazing, relative to normal incidence: ASHRAE Handbook of Fundamentals, two panes of 3 mm
PUBLISHED_GLASS = {40.0: 0.74 / 0.76, 50.0: 0.71 / 0.76, 60.0: 0.64 / 0.76, 70.0: 0.50 / 0.76, 80.0: 0.26 / 0.76}


def test_two_panes_let_through_at_every_angle_what_is_published_of_them_within_three_percent_of_g() -> None:
    angles_deg = np.array(list(PUBLISHED_GLASS))
    assert through_glass(2, angles_deg) == pytest.approx(list(PUBLISHED_GLASS.values()), abs=0.03)
    assert diffuse_through_glass(2) == pytest.approx(0.66 / 0.76, abs=0.03)


@pytest.mark.parametrize("panes", [1, 2, 3])
def test_glass_lets_less_through_the_flatter_the_light_and_nothing_from_behind(panes: int) -> None:
    relative = through_glass(panes, np.linspace(0.0, 180.0, 361))
    assert relative[0] == pytest.approx(1.0)
    assert (np.diff(relative) <= 0.0).all()
    assert relative[179] < 0.1
    assert (relative[180:] == 0.0).all()
    assert diffuse_through_glass(panes + 1) < diffuse_through_glass(panes) < 1.0


def test_without_panes_a_facade_counts_all_light_alike() -> None:
    assert (through_glass(0, np.array([0.0, 60.0, 89.0])) == 1.0).all()
    assert diffuse_through_glass(0) == 1.0


def test_behind_glass_direct_sun_counts_by_its_angle_and_diffuse_light_by_the_mean() -> None:
    noon = sun_at(pd.DatetimeIndex(["2021-06-21 12:21"], tz="Etc/GMT-2"), 59.4, 24.8)
    angle_deg = 90.0 - noon.zenith_deg  # the sun stands in the south: height is the angle to an upright facade
    direct, overcast = Sky(*np.array([[800.0], [0.0], [0.0]])), Sky(*np.array([[0.0], [200.0], [200.0]]))

    def relative(sky: Sky) -> float:
        behind, plain = (on_facade(Facade(180.0, panes=panes), noon, sky, albedo=0.2) for panes in (2, 0))
        return float(behind[0] / plain[0])

    assert relative(direct) == pytest.approx(float(through_glass(2, angle_deg)[0]), abs=1e-3)
    assert relative(overcast) == pytest.approx(diffuse_through_glass(2))


# --- weather files ---------------------------------------------------------------------------------

Change = Callable[[list[str]], None]
HEADER = [
    "LOCATION,Jõhvi,-,EST,made by a test,000000,59.4,24.8,2.0,34.0",
    *(f"{name},0" for name in ("DESIGN CONDITIONS", "TYPICAL/EXTREME PERIODS", "GROUND TEMPERATURES")),
    *(f"{name},0" for name in ("HOLIDAYS/DAYLIGHT SAVINGS", "COMMENTS 1", "COMMENTS 2")),
    "DATA PERIODS,1,1,Data,Sunday, 1/ 1,12/31",
]


def row(start: datetime, number: int, year: int | None = None) -> str:
    """One hour of a made-up file: its dry bulb grows by 0.005 K an hour, its radiation is 7, 5 and 6 W/m2."""
    stamp = f"{year or start.year},{start.month},{start.day},{start.hour + 1},0,?"
    return f"{stamp},{0.005 * number:.3f},0,80,101325,0,0,250,7,5,6" + ",0" * 19


def year_of(year: int, days: int = 365) -> list[str]:
    return [row(datetime(year, 1, 1) + timedelta(hours=i), i) for i in range(24 * days)]


def write(path: Path, rows: list[str]) -> str:
    path.write_text("\n".join([*HEADER, *rows]) + "\n", encoding="latin-1")
    return str(path)


def load(path: str, **parameters: object) -> WeatherRecord:
    return Epw.load(Epw.Parameters(path=path, **parameters), FACADES)


@pytest.fixture(scope="module")
def made_up(tmp_path_factory: pytest.TempPathFactory) -> str:
    return write(tmp_path_factory.mktemp("weather") / "year.epw", year_of(2019))


def test_an_hour_s_temperature_is_the_mean_of_its_two_ends(made_up: str) -> None:
    record = load(made_up, start="01-02", days=2)
    assert record.first_day == "2019-01-02"
    assert np.allclose(record.outdoor_C, 0.005 * (np.arange(24, 72) - 0.5))
    assert record.duration_s == 2 * 86400


def test_the_sky_is_as_cold_as_the_radiation_that_comes_from_it(made_up: str) -> None:
    sky_C = load(made_up, start="01-02", days=2).sky_C
    assert sky_C is not None
    assert 5.670e-8 * (sky_C + 273.15) ** 4 == pytest.approx(np.full(48, 250.0))


def test_a_file_without_the_sky_s_radiation_gives_no_sky_temperature(tmp_path: Path) -> None:
    rows = year_of(2019)
    replaced(24 * 1 + 5, ",250,7,5,6", ",9999,7,5,6")(rows)
    path = write(tmp_path / "year.epw", rows)
    assert load(path, start="01-02").sky_C is None
    assert load(path, start="01-03").sky_C is not None


def test_the_year_runs_on_from_december_to_january(made_up: str) -> None:
    around = load(made_up, start="12-29", days=7)
    before, after = load(made_up, start="12-29", days=3), load(made_up, start="01-01", days=4)
    assert np.array_equal(around.outdoor_C, np.concatenate([before.outdoor_C, after.outdoor_C]))
    assert after.outdoor_C[0] == pytest.approx(0.005 * 8759 / 2)  # 31 December 24:00 and 1 January 01:00
    for name in FACADES:
        parts = [before.irradiance_W_m2[name], after.irradiance_W_m2[name]]
        assert np.array_equal(around.irradiance_W_m2[name], np.concatenate(parts))


def test_a_leap_day_is_found_where_the_file_has_one(tmp_path: Path, made_up: str) -> None:
    leap = load(write(tmp_path / "leap.epw", year_of(2020, days=366)), start="02-29", days=2)
    assert leap.first_day == "2020-02-29"
    assert np.allclose(leap.outdoor_C, 0.005 * (np.arange(59 * 24, 61 * 24) - 0.5))
    with pytest.raises(ValueError, match="has no 02-29 hour 1"):
        load(made_up, start="02-29")


def test_a_typical_year_of_many_years_gets_a_year_of_its_own(tmp_path: Path) -> None:
    rows = year_of(2019)
    rows[:744] = [row(datetime(2001, 1, 1) + timedelta(hours=i), i, year=1984) for i in range(744)]
    assert load(write(tmp_path / "typical.epw", rows), start="01-31").first_day == "2001-01-31"


def test_a_part_of_a_year_serves_its_own_days(tmp_path: Path, made_up: str) -> None:
    january = write(tmp_path / "january.epw", year_of(2019)[:744])
    assert np.array_equal(load(january, start="01-25").outdoor_C, load(made_up, start="01-25").outdoor_C)
    for start in ("01-01", "01-26"):
        with pytest.raises(ValueError, match=f"holds 01-01 hour 1 to 01-31 hour 24, .* 7 days from {start}"):
            load(january, start=start)


def swap(rows: list[str]) -> None:
    rows[60], rows[61] = rows[61], rows[60]


def replaced(number: int, old: str, new: str) -> Change:
    def change(rows: list[str]) -> None:
        assert old in rows[number]
        rows[number] = rows[number].replace(old, new)

    return change


@pytest.mark.parametrize(
    ("damage", "reason"),
    [
        (lambda rows: rows.pop(60), "line 69: 01-03 hour 14 follows 01-03 hour 12: hours are missing"),
        (lambda rows: rows.insert(60, rows[60]), "line 70: 01-03 hour 13 follows 01-03 hour 13"),
        (swap, "line 69: 01-03 hour 14 follows 01-03 hour 12"),
        (lambda rows: rows.__setitem__(5000, ""), "line 5009: not a row of year, month, day, hour"),
        (lambda rows: rows.__setitem__(9, rows[9].replace(",10,0,?", ",25,0,?")), "line 18: not a row"),
        (
            replaced(23, "?,0.115,", "?,99.9,"),
            r"line 32: 01-01 hour 24: dry bulb temperature is missing or impossible \(99\.9\)",
        ),
        (
            replaced(60, "?,0.300,", "?,,"),
            r"line 69: 01-03 hour 13: dry bulb temperature is missing or impossible \(nan\)",
        ),
        (
            replaced(60, "?,0.300,", "?,warm,"),
            r"line 69: 01-03 hour 13: dry bulb temperature is missing or impossible \(warm\)",
        ),
        (replaced(60, ",7,5,6", ",9999,5,6"), "01-03 hour 13: global horizontal radiation is missing"),
        (replaced(60, ",7,5,6", ",7,9999,6"), "01-03 hour 13: direct normal radiation is missing"),
        (replaced(60, ",7,5,6", ",7,5,9999"), "01-03 hour 13: diffuse horizontal radiation is missing"),
        (lambda rows: rows.clear(), "ends after line 8, before any hour"),
    ],
)
def test_a_damaged_file_is_refused_in_one_line_that_names_the_place(
    tmp_path: Path, damage: Change, reason: str
) -> None:
    rows = year_of(2019)
    damage(rows)
    path = write(tmp_path / "damaged.epw", rows)
    with pytest.raises(ValueError, match=reason) as refusal:
        load(path, start="01-02")
    assert str(refusal.value).startswith(path)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252"])
def test_a_place_may_be_written_in_any_encoding(made_up: str, tmp_path: Path, encoding: str) -> None:
    text = Path(made_up).read_text(encoding="latin-1").replace("Nowhere", "Ålesund…")
    (tmp_path / "place.epw").write_text(text, encoding=encoding)
    assert np.array_equal(
        load(str(tmp_path / "place.epw"), start="01-02").outdoor_C, load(made_up, start="01-02").outdoor_C
    )


def test_a_missing_value_matters_only_in_the_hours_that_are_needed(tmp_path: Path) -> None:
    rows = year_of(2019)
    replaced(23, ",7,5,6", ",9999,9999,9999")(rows)  # the hour before the start gives its temperature only
    replaced(24 * 8, "?,0.960,", "?,99.9,")(rows)  # the hour after the end
    assert load(write(tmp_path / "year.epw", rows), start="01-02").outdoor_C.shape == (168,)


def test_a_file_that_is_not_there_or_no_weather_is_refused(tmp_path: Path) -> None:
    other = tmp_path / "other.csv"
    other.write_text("time,temperature\n0,1\n")
    for path, reason in ((tmp_path / "none.epw", "cannot be read"), (other, "not an EPW file: its first line")):
        with pytest.raises(ValueError, match=reason) as refusal:
            load(str(path), start="01-02")
        assert str(refusal.value).startswith(str(path))


def test_a_header_without_a_place_is_refused(tmp_path: Path, made_up: str) -> None:
    path = tmp_path / "nowhere.epw"
    path.write_text(Path(made_up).read_text(encoding="latin-1").replace("59.4", "north"), encoding="latin-1")
    with pytest.raises(ValueError, match="not an EPW file that pvlib can read"):
        load(str(path), start="01-02")


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("59.4,", "999.9,", "line 1: latitude 999.9 is not within -90 to 90 degrees"),
        (",24.8,", ",-200,", "line 1: longitude -200 is not within -180 to 180 degrees"),
        ("59.4,", "nan,", "line 1: latitude nan is not within"),
    ],
)
def test_a_place_that_is_not_on_earth_is_refused(tmp_path: Path, made_up: str, old: str, new: str, reason: str) -> None:
    path = tmp_path / "nowhere.epw"
    text = Path(made_up).read_text(encoding="latin-1")
    path.write_text(text.replace(old, new, 1), encoding="latin-1")
    with pytest.raises(ValueError, match=reason):
        load(str(path), start="01-02")


@pytest.mark.parametrize("start", ["13-01", "02-30", "20 January", "2019-01-20", ""])
def test_a_start_that_is_no_day_is_refused(start: str) -> None:
    with pytest.raises(ValidationError, match=f"'{start}' is not a day of the year as MM-DD"):
        Epw.Parameters(path="year.epw", start=start)


# --- a real year -----------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def helsinki() -> str:
    path = DATA / "weather" / "FIN_Helsinki.029740_IWEC.epw"
    if not path.is_file():
        pytest.skip(f"no {path.name} in WAXSTUDY_DATA")
    return str(path)


def test_direct_sun_explains_global_less_diffuse_in_the_middle_of_the_hour(helsinki: str) -> None:
    columns = pd.read_csv(helsinki, skiprows=8, header=None).loc[:, [13, 14, 15]].to_numpy(dtype=float)
    total, direct, diffuse = columns.T
    hours = pd.date_range("2001-01-01", periods=8760, freq="h", tz="Etc/GMT-2")

    def unexplained_W_m2(minutes: int) -> float:
        sun = sun_at(hours + pd.Timedelta(minutes=minutes), 60.32, 24.97)
        height = np.maximum(np.cos(np.radians(sun.zenith_deg)), 0.0)
        return float(np.sqrt(np.mean((total - diffuse - direct * height)[direct > 50.0] ** 2)))

    early, middle, late = (unexplained_W_m2(minutes) for minutes in (0, 30, 60))
    assert middle < 3.0
    assert min(early, late) > 10.0

    flat = Epw.load(Epw.Parameters(path=helsinki, start="01-01", days=365), {"flat": Facade(180.0, tilt_deg=0.0)})
    assert np.sqrt(np.mean((flat.irradiance_W_m2["flat"] - total)[direct > 50.0] ** 2)) < 3.0


def test_a_real_year_on_the_four_facades_is_plausible(helsinki: str) -> None:
    year = load(helsinki, start="01-01", days=365)
    south, west, north, east = (year.irradiance_W_m2[name].sum() / 1000.0 for name in FACADES)
    assert 750.0 < south < 950.0  # kWh/m2; maps of the region give 800 to 900
    assert east == pytest.approx(west, rel=0.1)
    assert north < 0.5 * south < east < south
    for irradiance in year.irradiance_W_m2.values():
        assert irradiance.min() >= 0.0
        assert irradiance.max() < 1100.0


def test_a_week_in_january_of_a_real_year_is_read(helsinki: str) -> None:
    record = load(helsinki, start="01-20", days=7)
    assert (record.interval_s, len(record.outdoor_C)) == (3600.0, 168)
    assert -30.0 < record.outdoor_C.mean() < 8.0
    assert all(np.all(by_day(irradiance)[:, :7] == 0.0) for irradiance in record.irradiance_W_m2.values())
