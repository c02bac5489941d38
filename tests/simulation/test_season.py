"""Claims about seasons: comfort counts on heating days only, heat is told by month, and a kill loses no case."""

from __future__ import annotations

import json
import signal
import subprocess
import time
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from tests.cli.conftest import Entry, entry
from tests.conftest import ONE_CASE, WAXSTUDY, Waxstudy
from tests.paper.test_weather import row, write
from tests.results.test_parquet import units_in
from waxstudy.plugin import WeatherRecord
from waxstudy.report.season import interval_percent
from waxstudy.simulation.season import heating, running_mean_C
from waxstudy.study.model import Season

__all__ = ["entry"]

INVALID = 3
COARSE = ONE_CASE.replace('"small"\n', '"small"\nstep_s = 60\n').replace("members = 2", "members = 1")
SPRING = COARSE.replace(
    'use = "tallinn-week"\nmonth = "january"', 'use = "epw"\npath = "year.epw"\nstart = "03-25"\ndays = 14'
)


def weather(daily_C: list[float], first_day: str = "2001-09-28") -> WeatherRecord:
    return WeatherRecord(3600.0, first_day, np.repeat(daily_C, 24).astype(float), {})


def test_a_day_s_running_mean_is_of_the_days_before_it_the_last_counting_a_fifth() -> None:
    means = running_mean_C(weather([10.0] * 7 + [20.0, 0.0, 0.0]))
    assert means == pytest.approx([10.0] * 8 + [12.0, 9.6])


def test_heating_days_are_those_below_the_limit_whole_days_long() -> None:
    days = heating(weather([10.0] * 7 + [20.0, 0.0, 0.0, 0.0]), Season(limit_C=10.0)).reshape(-1, 24)
    assert np.array_equal(days.all(axis=1), [False] * 9 + [True, True])
    assert np.array_equal(days.all(axis=1), days.any(axis=1))


def test_given_days_take_the_place_of_the_rule_and_may_pass_the_new_year() -> None:
    year = weather([30.0] * 365, "2001-07-01")
    days = heating(year, Season(first_day="10-01", last_day="03-31")).reshape(-1, 24)[:, 0]
    assert days.sum() == 182
    assert not days[91]
    assert days[92]
    assert heating(year, Season(first_day="02-01", last_day="02-28")).sum() == 28 * 24


@pytest.mark.parametrize(
    ("stated", "line", "wrong"),
    [
        ("limit_C = -30", "[season]:", "january: no heating day: the running mean outdoor temperature is -"),
        ('first_day = "06-01"\nlast_day = "08-31"', "[season]:", "do not reach 06-01 to 08-31"),
        ('first_day = "06-01"', "[season]:", "first_day and last_day belong together"),
        ('first_day = "02-30"\nlast_day = "08-31"', "[season] first_day", "not a day of the year as MM-DD"),
        ('first_day = ""\nlast_day = ""', "[season] first_day", "not a day of the year as MM-DD"),
        ('first_day = "W01-1"\nlast_day = "03-01"', "[season] first_day", "not a day of the year as MM-DD"),
        (
            'first_day = "01-01"\nlast_day = "02-01"\nlimit_C = 9',
            "[season]:",
            "limit_C is a rule for days that are not",
        ),
        ("limit_K = 9", "[season] limit_K", "did you mean 'limit_C'"),
    ],
)
def test_a_season_without_heating_days_or_of_nonsense_is_told_at_its_line(
    stated: str, line: str, wrong: str, entry: Entry, tmp_path: Path
) -> None:
    (tmp_path / "study.toml").write_text(f"{COARSE}\n[season]\n{stated}\n")
    done = entry("run", "study.toml", "--out", "run")
    assert done.code == INVALID
    missing = [text for text in ("study.toml:", line, wrong) if text not in done.stderr]
    assert not missing, done.stderr
    assert not (tmp_path / "run").exists()


@pytest.fixture(scope="module")
def year(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Cold until 31 March, then mild, with a sun that heats the room, and cold again from 5 April."""
    from datetime import datetime, timedelta

    folder = tmp_path_factory.mktemp("year")
    rows = [row(datetime(2019, 1, 1) + timedelta(hours=i), 0) for i in range(24 * 120)]
    for i, each in enumerate(rows):
        parts = each.split(",")
        warm = 24 * 90 <= i < 24 * 94
        parts[6] = "16.0" if warm else "-3.0"
        parts[13:16] = ("400", "300", "200") if warm and 8 <= i % 24 < 18 else ("0", "0", "0")
        rows[i] = ",".join(parts)
    write(folder / "year.epw", rows)
    return folder


def run(entry: Entry, year: Path, folder: Path, more: str = "") -> pd.DataFrame:
    (folder / "year.epw").write_bytes((year / "year.epw").read_bytes())
    (folder / "study.toml").write_text(SPRING + more)
    done = entry("run", "study.toml", "--out", "run")
    assert done.code == 0, done.stderr
    return pd.read_csv(folder / "run" / "kpis.csv")


def test_comfort_counts_on_heating_days_alone(entry: Entry, year: Path, tmp_path: Path) -> None:
    (figures,) = run(entry, year, tmp_path, "[season]\nlimit_C = 5\n").to_dict("records")
    trace = pd.read_parquet(next((tmp_path / "run" / "cases").glob("*/traces.parquet")))
    stated = weather([-3.0] * 7 + [16.0] * 4 + [-3.0] * 3)
    days = heating(stated, Season(limit_C=5.0)).reshape(-1, 24)[:, 0]
    assert 0 < days.sum() == figures["counted_days"] < 14
    counted = days[((trace["time_s"] - 1.0) // 86400).astype(int)]
    below = trace["operative_C"] < 21.0
    hours = (below & counted).sum() / 60.0 * 7.0 / days.sum()
    assert figures["hours_below_per_week"] == pytest.approx(hours, abs=0.2)
    assert hours == pytest.approx(33.0, abs=0.6)
    assert abs((below).sum() / 60.0 / 2.0 - hours) > 1.0  # not what all days have
    for category, low in (("I", 21.0), ("II", 20.0), ("III", 18.0)):
        share = trace["operative_C"][counted].between(low, 25.0).mean()
        assert figures[f"in_category_{category}_share"] == pytest.approx(share, abs=2e-3)


def test_a_season_of_all_days_changes_no_figure(entry: Entry, year: Path, tmp_path: Path) -> None:
    without, (first, last) = run(entry, year, tmp_path), ("03-01", "05-01")
    with_it = run(entry, year, tmp_path, f'[season]\nfirst_day = "{first}"\nlast_day = "{last}"\n')
    pd.testing.assert_frame_equal(with_it[without.columns], without, check_exact=True)


def test_heat_of_the_months_is_the_record_s_heat_and_is_shown_in_every_format(
    entry: Entry, year: Path, tmp_path: Path
) -> None:
    (figures,) = run(entry, year, tmp_path, "[season]\n").to_dict("records")
    march, april = figures["heat_2019-03_kWh_m2"], figures["heat_2019-04_kWh_m2"]
    assert march + april == pytest.approx(2.0 * figures["heat_kWh_m2_week"])
    assert march > april > 0.0
    shown = entry("report", "run").stdout
    assert "heat by month" in shown
    assert f"{march:.2f}" in shown
    assert "14 heating days" in shown
    (row,) = json.loads(entry("report", "run", "--format", "json").stdout)["months"]
    assert row["heat_kWh_m2"] == pytest.approx({"2019-03": march, "2019-04": april})
    listed = entry("report", "run", "--format", "csv").stdout.splitlines()
    assert float(dict(zip(*(line.split(",") for line in listed), strict=True))["heat_2019-03_kWh_m2"]) == (
        pytest.approx(march, abs=1e-5)
    )
    assert entry("report", "run", "--format", "html", "--out", "page.html").code == 0
    page = (tmp_path / "page.html").read_text()
    assert "Months and season" in page
    assert 'id="figure-months"' in page


def test_a_sweep_of_a_season_has_months_and_categories_with_units(entry: Entry, year: Path, tmp_path: Path) -> None:
    run(entry, year, tmp_path, "[season]\n")
    (tmp_path / "sweep.toml").write_text("[vary]\nseason.limit_C = [5.0, 20.0]\nroom.shading.passes = [0.2]\n")
    done = entry("run", "study.toml", "--sweep", "sweep.toml", "--out", "swept")
    assert done.code == 0, done.stderr
    swept = pd.read_parquet(tmp_path / "swept" / "sweep.parquet")
    assert swept["counted_days"].tolist() == [11.0, 14.0]
    assert units_in(tmp_path / "swept" / "sweep.parquet")["heat_2019-03_kWh_m2"] == "kWh/m2"


def test_the_interval_over_months_grows_with_what_months_differ_by() -> None:
    other = np.array([10.0, 12.0, 11.0, 9.0])
    assert interval_percent(1.05 * other, other) == pytest.approx(0.0, abs=1e-9)
    narrow, wide = (interval_percent(other + by * np.array([0.1, -0.1, 0.1, -0.1]), other) for by in (1.0, 3.0))
    assert 0.0 < narrow < wide
    assert np.isnan(interval_percent(other[:2], other[:2]))


def test_data_are_looked_for_in_the_folder_that_the_environment_names(
    entry: Entry, year: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "study.toml").write_text(SPRING.replace('"year.epw"', '"$WAXSTUDY_DATA/year.epw"'))
    monkeypatch.delenv("WAXSTUDY_DATA", raising=False)
    done = entry("run", "study.toml", "--out", "run")
    assert done.code == INVALID
    assert '[weather.january] path = "$WAXSTUDY_DATA/year.epw": WAXSTUDY_DATA is not set' in done.stderr
    monkeypatch.setenv("WAXSTUDY_DATA", str(year))
    assert entry("run", "study.toml", "--out", "run").code == 0


def test_a_season_that_is_killed_loses_no_finished_case(waxstudy: Waxstudy, year: Path, tmp_path: Path) -> None:
    (tmp_path / "year.epw").write_bytes((year / "year.epw").read_bytes())
    more = [f'{{ id = "O_{n}", controller = {{ dead_band_K = {0.5 + n / 10} }} }}' for n in range(1, 5)]
    long = SPRING.replace("days = 14", "days = 60").replace("03-25", "02-20").replace("step_s = 60", "step_s = 20")
    (tmp_path / "study.toml").write_text(f"{long}steps = [{', '.join(more)}]\n[season]\n")
    process = subprocess.Popen([WAXSTUDY, "run", "study.toml", "--out", "run"], cwd=tmp_path, stderr=subprocess.DEVNULL)
    kept: dict[Path, int] = {}
    while not kept and process.poll() is None:
        kept = {file: file.stat().st_mtime_ns for file in tmp_path.glob("run/cases/[!.]*/kpis.csv")}
        time.sleep(0.01)
    process.send_signal(signal.SIGKILL)
    assert process.wait() == -signal.SIGKILL, "it ended before it could be killed"
    assert 0 < len(kept) < 5
    done = waxstudy("run", "study.toml", "--out", "run")
    assert done.returncode == 0, done.stderr
    assert {file: file.stat().st_mtime_ns for file in kept} == kept
    assert len(pd.read_csv(tmp_path / "run" / "kpis.csv")) == 5
