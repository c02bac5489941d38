"""A healthy record of the same loop, as `waxstudy diagnose` and `waxstudy calibrate` take it, and refuse it."""

from __future__ import annotations

import json
import shutil
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import waxstudy as wx
from tests.cli.conftest import Entry
from tests.conftest import SMALL, call
from tests.report.test_diagnosis import page_text, untraced
from waxstudy.study.problems import StudyError

USAGE, INVALID = 2, 3
DAYS_BEFORE = 30


@pytest.fixture(scope="session")
def loop(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Seven days of a loop as believed, its room included, and in `before` a month earlier the same."""
    folder = tmp_path_factory.mktemp("baseline")
    (folder / "small.toml").write_text(SMALL)
    chosen = ("--case", "O_WM", "--believed", "O_WM", "--days", "7", "--interval-s", "300")
    done = call(folder, "reality", "small.toml", *chosen, "--out", "loop")
    assert done.returncode == 0, done.stderr
    shifted(folder / "loop", folder / "before")
    return folder


def shifted(loop: Path, place: Path, without: tuple[str, ...] = (), first: int = 0, **factors: float) -> Path:
    """Copy a dataset to a month before, without some channels, from a row on, some of them times a factor."""
    shutil.copytree(loop, place)
    data = pd.read_csv(place / "data.csv").drop(columns=list(without)).iloc[first:]
    data["time"] = pd.to_datetime(data["time"]) - pd.Timedelta(days=DAYS_BEFORE)
    for channel, factor in factors.items():
        data[channel] *= factor
    data.to_csv(place / "data.csv", index=False)
    described = (place / "dataset.toml").read_text()
    for channel in without:
        described = "".join(line for line in described.splitlines(True) if not line.startswith(f"{channel} ="))
    (place / "dataset.toml").write_text(described)
    return place


def chain_alone(loop: Path, place: Path, *beside: str, **how: object) -> Path:
    """Such a copy without what the room shows, which is quick to judge."""
    of_room = [name for name in pd.read_csv(loop / "data.csv") if name.endswith("temperature_C")]
    keep = ("sensor_temperature_C", "outdoor_temperature_C", "supply_temperature_C", *beside)
    without = (*(name for name in of_room if name not in keep), *how.pop("without", ()))  # type: ignore[misc]
    return shifted(loop, place, without=without, **how)  # type: ignore[arg-type]


def meaned(place: Path, every: str = "1h") -> Path:
    """Put means over an interval of all channels in the place of a dataset's samples."""
    data = pd.read_csv(place / "data.csv", parse_dates=["time"]).set_index("time")
    data.groupby(data.index.ceil(every)).mean().round(3).iloc[1:-1].to_csv(place / "data.csv")
    replaced(place, "interval_s = 300", f"interval_s = {pd.Timedelta(every).total_seconds():g}")
    return place


def replaced(folder: Path, old: str, new: str) -> None:
    path = folder / "dataset.toml"
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new))


# --- refused -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            "dead_band_K = 0.5",
            "dead_band_K = 0.8",
            "controller dead_band_K is 0.8 in the baseline and 0.5 in the record",
        ),
        ("window_g = 0.3", "window_g = 0.2", "room window_g is 0.2 in the baseline and 0.3 in the record"),
        (
            "[room.facade_m]\nsouth = 4.0",
            "[room.facade_m]\nsouth = 4.5",
            "room facade_m south is 4.5 in the baseline and 4.0 in the record",
        ),
    ],
    ids=["chain", "room", "a table of the room"],
)
def test_a_baseline_of_another_loop_says_what_differs(
    loop: Path, entry: Entry, tmp_path: Path, old: str, new: str, said: str
) -> None:
    other = shutil.copytree(loop / "before", tmp_path / "other")
    replaced(other, old, new)
    done = entry("diagnose", loop / "loop", "--baseline", other)
    assert (done.code, done.stdout) == (INVALID, "")
    assert f"{other}/dataset.toml: [baseline]: another loop: {said}" in done.stderr


def test_one_that_overlaps_with_the_record_says_from_when_to_when(loop: Path, entry: Entry, tmp_path: Path) -> None:
    same = shutil.copytree(loop / "loop", tmp_path / "same")
    done = entry("diagnose", loop / "loop", "--baseline", same)
    assert done.code == INVALID
    first = pd.read_csv(same / "data.csv")["time"].iloc[0]
    assert "it overlaps with the record, from " in done.stderr
    assert str(pd.Timestamp(first)) in done.stderr


@pytest.mark.parametrize("command", ["diagnose", "calibrate"])
def test_one_of_less_than_three_days_is_too_short(loop: Path, entry: Entry, tmp_path: Path, command: str) -> None:
    short = shifted(loop / "loop", tmp_path / "short", first=5 * 288)
    options = ("--baseline", short) if command == "diagnose" else ("--out", "room.toml")
    done = entry(command, loop / "loop" if command == "diagnose" else short, *options)
    assert done.code == INVALID
    assert "a baseline of 2.0 days is too short: at least 3 days are needed" in done.stderr


@pytest.mark.parametrize(
    ("every", "rows", "said"),
    [
        ("6h", 2016, "a sample every 360 min is too seldom for a baseline: one every 60 min is needed at least"),
        ("1h", 60, "the baseline has a sample every 60 min, and the record is 5 h long: 24 h are needed to compare"),
    ],
)
def test_a_baseline_that_was_sampled_too_seldom_for_its_record_is_refused(
    loop: Path, entry: Entry, tmp_path: Path, every: str, rows: int, said: str
) -> None:
    record = shutil.copytree(loop / "loop", tmp_path / "record")
    pd.read_csv(record / "data.csv").iloc[:rows].to_csv(record / "data.csv", index=False)
    seldom = meaned(shutil.copytree(loop / "before", tmp_path / "seldom"), every)
    done = entry("diagnose", record, "--baseline", seldom)
    assert (done.code, done.stdout) == (INVALID, "")
    assert said in done.stderr


@pytest.mark.parametrize(
    ("days", "said"),
    [
        ((1, 8), "reaches beyond the record (the record has "),
        ((-1, 4), "reaches beyond the record (the record has "),
        ((8, 12), "lies outside the record (the record has "),
        ((4, 1), ": the days go backwards (the record has "),
        ((0, 1), "a baseline of 2.0 days is too short"),
        ((0, 6), "less than 3 days come after "),
    ],
)
def test_days_that_cannot_be_a_baseline_are_refused(loop: Path, entry: Entry, days: tuple[int, int], said: str) -> None:
    first = pd.Timestamp(pd.read_csv(loop / "loop" / "data.csv")["time"].iloc[0]).normalize()
    chosen = "..".join(str((first + pd.Timedelta(days=day)).date()) for day in days)
    done = entry("diagnose", loop / "loop", "--baseline-days", chosen)
    assert (done.code, done.stdout) == (INVALID, "")
    assert f"{loop / 'loop' / 'dataset.toml'}: --baseline-days: " in done.stderr
    assert said in done.stderr


@pytest.mark.parametrize("days", ["2026-01-01", "2026-01-01..", "..", "a..b", "2026-01-01..2026-02-30", ""])
def test_what_is_no_span_of_days_is_a_mistake_of_usage(loop: Path, entry: Entry, days: str) -> None:
    done = entry("diagnose", loop / "loop", f"--baseline-days={days}")
    assert done.code == USAGE
    assert "is no span of days: write two days as 2026-01-01..2026-01-10" in done.stderr


@pytest.mark.parametrize("days", ["0001-01-01..0001-01-10", "9999-12-01..9999-12-31"])
def test_days_of_another_age_are_outside_the_record(loop: Path, entry: Entry, days: str) -> None:
    done = entry("diagnose", loop / "loop", "--baseline-days", days)
    assert done.code == INVALID
    assert "lies outside the record" in done.stderr


def test_a_folder_and_days_at_once_are_refused(loop: Path, entry: Entry) -> None:
    options = ("--baseline", loop / "before", "--baseline-days", "2026-01-01..2026-01-10")
    done = entry("diagnose", loop / "loop", *options)
    assert done.code == USAGE
    assert "--baseline and --baseline-days: give one of them" in done.stderr


def test_a_folder_without_a_dataset_is_told_where_it_was_looked_for(loop: Path, entry: Entry, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    done = entry("diagnose", loop / "loop", "--baseline", "empty")
    assert (done.code, done.stderr) == (INVALID, "empty/dataset.toml: no such file\n")
    named = shutil.copytree(loop / "loop", tmp_path / "named")
    for path, said in (("../empty", "no such dataset"), (".", "a record cannot be its own baseline")):
        (named / "dataset.toml").write_text((loop / "loop" / "dataset.toml").read_text())
        with (named / "dataset.toml").open("a") as file:
            file.write(f'\n[baseline]\npath = "{path}"\n')
        done = entry("diagnose", "named")
        assert done.code == INVALID
        assert f'[baseline] path = "{path}": {said}' in done.stderr
    itself = entry("diagnose", "named", "--baseline", "named")
    assert (itself.code, "a record cannot be its own baseline" in itself.stderr) == (INVALID, True)
    assert entry("diagnose", loop / "loop", "--baseline", "nowhere").code == USAGE


def test_a_baseline_that_is_given_goes_before_the_one_that_the_file_names(
    loop: Path, entry: Entry, tmp_path: Path
) -> None:
    named = shutil.copytree(loop / "loop", tmp_path / "named")
    with (named / "dataset.toml").open("a") as file:
        file.write('\n[baseline]\npath = "../moved-away"\n')
    short = shifted(loop / "loop", tmp_path / "short", first=5 * 288)
    for options in (("--baseline", short), ("--baseline-days", "2021-01-01..2021-01-02")):
        done = entry("diagnose", named, *options)
        assert done.code == INVALID
        assert "a baseline of 2.0 days is too short" in done.stderr
        assert "moved-away" not in done.stderr


def test_in_python_a_baseline_that_was_read_is_held_to_the_same(loop: Path, tmp_path: Path) -> None:
    named = shutil.copytree(loop / "loop", tmp_path / "named")
    with (named / "dataset.toml").open("a") as file:
        file.write('\n[baseline]\npath = "../moved-away"\n')
    record, before = wx.Dataset.read(named), wx.Dataset.read(loop / "before")
    for baseline, said in ((record, "it overlaps with the record"), (None, "no such dataset"), ("", "no such dataset")):
        with pytest.raises(StudyError, match=said):
            wx.diagnose(record, baseline=baseline)
    short = replace(before, time=before.time[:300], values=before.values[:300])
    with pytest.raises(StudyError, match=r"a baseline of 1\.0 days is too short"):
        wx.diagnose(record, baseline=short)


def test_the_days_that_a_record_has_are_those_that_it_tells_of(loop: Path, entry: Entry, tmp_path: Path) -> None:
    """A sample at midnight ends the day before, of which it is all that there is."""
    since_midnight = shutil.copytree(loop / "loop", tmp_path / "midnight")
    data = pd.read_csv(loop / "loop" / "data.csv")
    first = pd.Timestamp(data["time"].iloc[0])
    lone = data.iloc[:1].assign(time=str(first.normalize()))
    assert first > first.normalize()
    pd.concat([lone, data]).to_csv(since_midnight / "data.csv", index=False)
    done = entry("diagnose", since_midnight, "--baseline-days", "2020-01-01..2020-01-04")
    last = first.normalize() + pd.Timedelta(days=6)
    assert f"(the record has {first.date()}..{last.date()})" in done.stderr


# --- taken, with a warning ---------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(("more", "hidden"), [("", "displacement"), ("air_temperature_C", "air_temperature_C")])
def test_what_only_the_record_shows_is_not_judged_and_told(
    loop: Path, entry: Entry, tmp_path: Path, more: str, hidden: str
) -> None:
    """What is off there may be as old as the loop: without a baseline it is compared with what is stated."""
    record = chain_alone(loop / "loop", tmp_path / "record", *filter(None, [more]))
    blind = chain_alone(loop / "before", tmp_path / "blind", without=(hidden,))
    done = entry("diagnose", record, "--baseline", blind, "--quick", "--json")
    assert (done.code, done.stderr) == (0, "")
    told = json.loads(done.stdout)
    assert (told["verdict"], told["effects"], told["unexplained"]) == ("none", [], [])
    assert f"The record is read without {hidden}, which the baseline lacks" in " ".join(told["warnings"])


@pytest.mark.slow
def test_a_baseline_that_is_itself_faulty_is_doubted(loop: Path, entry: Entry, tmp_path: Path) -> None:
    record = chain_alone(loop / "loop", tmp_path / "record")
    faulty = chain_alone(loop / "before", tmp_path / "faulty", flow_L_h=0.5)
    done = entry("diagnose", record, "--baseline", faulty, "--quick", "--json")
    assert (done.code, done.stderr) == (0, "")
    told = json.loads(done.stdout)
    (doubt,) = [each for each in told["warnings"] if "is it healthy?" in each]
    assert doubt.startswith("the baseline shows max-flow too")
    (half,) = [each for each in told["as_built"] if each["name"] == "max-flow factor"]
    assert half["value"]["value"] == pytest.approx(0.5, rel=0.02)
    assert half["sentence"] == "With the valve open, 0.50 times the believed flow passes."
    assert half["is_clear"]


# --- what a baseline says ----------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("of", ["a folder", "its first days"])
def test_a_loop_that_is_as_it_was_has_no_effect_and_every_figure_is_traced(
    loop: Path, entry: Entry, tmp_path: Path, of: str
) -> None:
    record = chain_alone(loop / "loop", tmp_path / "record")
    first = pd.Timestamp(pd.read_csv(record / "data.csv")["time"].iloc[0]).normalize()
    last = (first + pd.Timedelta(days=3)).date()
    healthy = chain_alone(loop / "before", tmp_path / "healthy")
    said = ("--baseline", healthy) if of == "a folder" else ("--baseline-days", f"{first.date()}..{last}")
    done = entry("diagnose", record, *said, "--quick", "--out", "found")
    assert (done.code, done.stderr) == (0, "")
    told = json.loads(Path("found/diagnosis.json").read_text())
    assert told["verdict"] == "none"
    # beside the folder the switches are known to a quarter of an hour: a sensor's lag would not show
    judged, others = ("", "sensor, ") if of == "a folder" else ("sensor, ", "")
    nothing = f"Of {judged}controller, actuator and valve, no change shows since the baseline"
    assert told["summary"] == f"{nothing}; {others}emitter and room could not be judged."
    assert sum(told["posterior"].values()) == pytest.approx(1.0)
    assert {"compared_with", "as_built", "baseline"} <= set(told)
    assert told["compared_with"] in " ".join(done.stdout.split())
    assert "p = " not in done.stdout
    page = page_text(Path("found/report.html").read_text(encoding="utf-8"))
    assert untraced(done.stdout, told) + untraced(page, told) == []


@pytest.mark.slow
def test_a_baseline_of_which_only_hourly_means_were_kept_is_no_change(loop: Path, entry: Entry, tmp_path: Path) -> None:
    """As home automation keeps them: read as they are, they would be another motor and another flow.

    What pulses do within an hour cannot be judged by them.
    """
    record = chain_alone(loop / "loop", tmp_path / "record")
    hourly = meaned(chain_alone(loop / "before", tmp_path / "hourly"))
    done = entry("diagnose", record, "--baseline", hourly, "--quick", "--json")
    assert (done.code, done.stderr) == (0, "")
    told = json.loads(done.stdout)
    assert (told["verdict"], told["effects"], told["unexplained"]) == ("untestable", [], [])
    assert "was logged as means of 60 min, which hide its pulses" in told["summary"]
    (said,) = [each for each in told["warnings"] if each.startswith("The baseline has a sample every 60 min")]
    assert "so the record is read as means of 60 min" in said


@pytest.mark.slow
def test_a_logger_that_rounds_with_a_dead_meter_and_a_thermometer_that_stands_still_is_no_change(
    loop: Path, entry: Entry, tmp_path: Path
) -> None:
    record = Path(shutil.copytree(loop / "loop", tmp_path / "record"))
    data = pd.read_csv(record / "data.csv")
    rounded = [name for name in ("sensor_temperature_C", "air_temperature_C", "operative_temperature_C")]
    data[rounded] = (2.0 * data[rounded]).round() / 2.0
    data["flow_L_h"] = 0.0
    half = len(data) // 2
    data.loc[half:, "outdoor_temperature_C"] = data["outdoor_temperature_C"].iloc[half]
    data.to_csv(record / "data.csv", index=False)
    done = entry("diagnose", record, "--baseline", loop / "before", "--quick", "--json")
    assert (done.code, done.stderr) == (0, "")
    told = json.loads(done.stdout)
    assert (told["verdict"], told["effects"], told["unexplained"]) == ("none", [], [])
    said = "\n".join(told["warnings"])
    assert "rounded to 0.5 K in the record and to 0.01 K in the baseline: sensor_temperature_C, air" in said
    assert "samples are 0 though the valve opens, as of a dead meter, pump or valve" in said
    assert "outdoor_temperature_C: " in said
    assert "of one value for " in said


# --- a room for studies ------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_record_that_lacks_a_channel_of_its_baseline_is_no_change(loop: Path, entry: Entry, tmp_path: Path) -> None:
    """The stretch that spans what it lacks would be compared with the documents."""
    record = chain_alone(loop / "loop", tmp_path / "record", without=("displacement",))
    done = entry("diagnose", record, "--baseline", chain_alone(loop / "before", tmp_path / "b"), "--quick", "--json")
    assert (done.code, done.stderr) == (0, "")
    told = json.loads(done.stdout)
    assert (told["verdict"], told["effects"], told["unexplained"]) == ("none", [], [])
    assert "The baseline is read without displacement, which the record lacks." in told["assumptions"]
    assert not [each for each in told["warnings"] if "what is stated is compared" in each]


@pytest.mark.slow
def test_a_calibrated_room_runs_in_a_study(loop: Path, entry: Entry, tmp_path: Path) -> None:
    done = entry("calibrate", loop / "before", "--out", "room.toml")
    assert (done.code, done.stderr) == (0, "")
    assert done.stdout.splitlines()[-1] == "room.toml"
    written = tomllib.loads(Path("room.toml").read_text())
    fit = written["fit"]
    assert {"floor-cover resistance_m2K_W", "film-floor"} <= fit["intervals"].keys() <= fit["values"].keys()
    assert all(low <= fit["values"][name] <= high for name, (low, high) in fit["intervals"].items())
    air = fit["channels"]["air_temperature_C"]
    assert 0.0 < air["cv_rmse_percent"] < 2.0
    assert abs(air["nmbe_percent"]) < 1.0
    (tmp_path / "small.toml").write_text(SMALL.replace('use = "nzeb"', 'from = "room.toml"'))
    done = entry("run", "small.toml", "--out", "run")
    assert done.code == 0, done.stderr
    kept = json.loads(Path("run/run.json").read_text())
    assert "room.toml" in str(kept)


def test_a_record_without_a_room_has_none_to_calibrate(loop: Path, entry: Entry, tmp_path: Path) -> None:
    place = chain_alone(loop / "before", tmp_path / "chain")
    done = entry("calibrate", place, "--out", "room.toml")
    assert (done.code, done.stdout) == (INVALID, "")
    assert "the record does not show what the room does" in done.stderr
    assert not Path("room.toml").exists()


def test_a_room_that_was_seen_on_one_day_is_not_calibrated(loop: Path, entry: Entry, tmp_path: Path) -> None:
    place = shutil.copytree(loop / "before", tmp_path / "seldom")
    data = pd.read_csv(place / "data.csv")
    of_room = ["air_temperature_C", "operative_temperature_C", "floor_surface_temperature_C", "return_temperature_C"]
    data.loc[288:, [name for name in of_room if name in data]] = np.nan
    data.to_csv(place / "data.csv", index=False)
    done = entry("calibrate", place, "--out", "room.toml")
    assert (done.code, done.stdout) == (INVALID, "")
    assert "the record does not show what the room does: only 1 day of " in done.stderr
    assert not Path("room.toml").exists()


@pytest.mark.parametrize("out", ["room", "nowhere/room.toml"])
def test_a_place_that_cannot_be_written_is_told_before_the_work(loop: Path, entry: Entry, out: str) -> None:
    done = entry("calibrate", loop / "before", "--out", out)
    assert (done.code, done.stdout) == (USAGE, "")
    assert out in done.stderr


def test_what_is_read_is_never_written_over(loop: Path, entry: Entry, tmp_path: Path) -> None:
    place = shutil.copytree(loop / "before", tmp_path / "before")
    done = entry("calibrate", place, "--out", place / "dataset.toml")
    assert done.code == USAGE
    assert "this file is read; choose another name with --out" in done.stderr
