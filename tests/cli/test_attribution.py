"""`waxstudy report --attribution`: the order-free ladder of a run, end to end."""

from __future__ import annotations

import csv
import json
import shutil
import signal
import time
from pathlib import Path
from typing import Any

import pytest

from tests.cli.conftest import Entry
from tests.cli.folders import computed_at, contents, finished_cases, resum
from tests.cli.test_bad_input import INVALID, assert_clear
from tests.cli.test_interruption import INTERRUPTED, start
from tests.conftest import SMALL, Waxstudy

FIGURES = (
    "heat_kWh_m2_week",
    "heat_vs_most_detailed_percent",
    "heat_corrected_vs_most_detailed_percent",
    "setpoint_shift_K",
    "mae_K",
)
STARTS_WITH = {
    "table": "ladder on-off, january: what each step adds, O_0 to O_WM",
    "csv": "ladder,week,figure,step,in_ladder,",
    "md": "# small",
    "json": "{",
    "html": "<!DOCTYPE html>",
}
NEW = "on-off.01_january"  # the one set that the small ladder does not go through


@pytest.fixture
def attributed(finished: Path, tmp_path: Path, entry: Entry) -> dict[str, Any]:
    """The small study's attribution as JSON; its run folder, with what was computed, is `run`."""
    shutil.copytree(finished, tmp_path / "run")
    ended = entry("report", "run", "--attribution", "--json")
    assert (ended.code, ended.stderr) == (0, "")
    printed: dict[str, Any] = json.loads(ended.stdout)
    return printed


def test_every_format_is_printed_or_written_to_a_file(entry: Entry, attributed: dict[str, Any], tmp_path: Path) -> None:
    for form, begins in STARTS_WITH.items():
        printed = entry("report", "run", "--attribution", "--format", form)
        assert (printed.code, printed.stderr) == (0, "")
        assert printed.stdout.startswith(begins)
        assert entry("report", "run", "--attribution", "--format", form, "--out", "report.txt") == (0, "", "")
        assert (tmp_path / "report.txt").read_text(encoding="utf-8") == printed.stdout


def test_the_shares_sum_to_the_difference_that_the_comparison_tells(entry: Entry, attributed: dict[str, Any]) -> None:
    rows = {row["case"]: row for row in json.loads(entry("report", "run", "--json").stdout)["rows"]}
    (of,) = attributed["attribution"]
    for figure in FIGURES:
        told = of["figures"][figure]
        total = rows["O_WM"][figure]["mean"] - rows["O_0"][figure]["mean"]
        assert told["total"]["mean"] == pytest.approx(total, abs=1e-12)
        assert told["sum_of_shares"] == pytest.approx(total, abs=1e-12)
        for kind in ("in_ladder", "order_free"):
            assert sum(share[kind]["mean"] for share in told["shares"]) == pytest.approx(total, abs=1e-12)


def test_the_ladder_s_order_is_what_each_case_adds_to_the_one_before(entry: Entry, attributed: dict[str, Any]) -> None:
    rows = {row["case"]: row for row in json.loads(entry("report", "run", "--json").stdout)["rows"]}
    (of,) = attributed["attribution"]
    for figure in FIGURES:
        first, second = of["figures"][figure]["shares"]
        assert (first["step"], second["step"]) == ("O_CP", "O_WM")
        heat = {case: row[figure]["mean"] for case, row in rows.items()}
        assert first["in_ladder"]["mean"] == pytest.approx(heat["O_CP"] - heat["O_0"], abs=1e-12)
        assert second["in_ladder"]["mean"] == pytest.approx(heat["O_WM"] - heat["O_CP"], abs=1e-12)


def test_two_steps_share_as_the_mean_of_both_orders(attributed: dict[str, Any]) -> None:
    (of,) = attributed["attribution"]
    assert of["orders"] == 2
    value = {tuple(chosen["steps"]): chosen["mae_K"] for chosen in of["sets"]}
    adds = [value["O_CP",] - value[()], value["O_CP", "O_WM"] - value["O_WM",]]
    share = of["figures"]["mae_K"]["shares"][0]
    assert share["order_free"]["mean"] == pytest.approx(sum(adds) / 2, abs=1e-12)
    assert [share["least"], share["most"]] == pytest.approx(sorted(adds), abs=1e-12)


def test_csv_tells_the_same_as_json(entry: Entry, attributed: dict[str, Any]) -> None:
    rows = list(csv.DictReader(entry("report", "run", "--attribution", "--format", "csv").stdout.splitlines()))
    (of,) = attributed["attribution"]
    assert [(row["figure"], row["step"]) for row in rows] == [
        (figure, step) for figure in FIGURES for step in ("O_CP", "O_WM", "total")
    ]
    for row in rows:
        told = of["figures"][row["figure"]]
        shares = {share["step"]: share for share in told["shares"]}
        estimate = told["total"] if row["step"] == "total" else shares[row["step"]]["order_free"]
        for end, key in (("", "mean"), ("_low", "low"), ("_high", "high")):
            assert float(row[f"order_free{end}"]) == pytest.approx(estimate[key], abs=1e-5)
        assert row["resolved"] == ("yes" if estimate["low"] > 0.0 or estimate["high"] < 0.0 else "no")


def test_only_the_sets_between_the_ladder_s_cases_are_computed_and_each_once(
    entry: Entry, attributed: dict[str, Any], tmp_path: Path, finished: Path
) -> None:
    added = contents(tmp_path / "run").keys() - contents(finished).keys()
    assert {name.split("/")[0] for name in added} == {"attribution"}
    before = computed_at(tmp_path / "run" / "attribution")
    assert {name.split("/")[0] for name in before} == {NEW}
    assert entry("report", "run", "--attribution").code == 0
    assert computed_at(tmp_path / "run" / "attribution") == before


def test_the_run_is_reported_and_run_again_as_before(
    entry: Entry, attributed: dict[str, Any], small_study: Path, tmp_path: Path
) -> None:
    whole = contents(tmp_path / "run")
    assert entry("report", "run").code == 0
    assert entry("run", "small.toml", "--out", "run").code == 0
    assert contents(tmp_path / "run") == whole


def test_a_set_that_was_cut_off_is_computed_again(entry: Entry, attributed: dict[str, Any], tmp_path: Path) -> None:
    whole = contents(tmp_path / "run")
    (place,) = (tmp_path / "run" / "attribution" / "cases").iterdir()
    (place / "kpis.csv").write_bytes((place / "kpis.csv").read_bytes()[:100])
    again = entry("report", "run", "--attribution", "--json")
    assert json.loads(again.stdout) == attributed
    assert contents(tmp_path / "run") == whole


def test_a_step_that_changes_nothing_gets_no_share(entry: Entry, tmp_path: Path) -> None:
    idle = SMALL.replace(
        "steps = [", 'steps = [\n  { id = "O_same", controller = { dead_band_K = 2.0 }, valve = { use = "linear" } },'
    ).replace('"on-off" }', '"on-off", dead_band_K = 2.0 }')
    (tmp_path / "idle.toml").write_text(idle)
    assert entry("run", "idle.toml", "--out", "run").code == 0
    ended = entry("report", "run", "--attribution", "--json")
    printed = json.loads(ended.stdout)
    (of,) = printed["attribution"]
    assert of["orders"] == 6
    for figure in FIGURES:
        share = of["figures"][figure]["shares"][0]
        assert share["step"] == "O_same"
        assert {share[name]["mean"] for name in ("in_ladder", "order_free", "of_its_place")} == {0.0}
        assert (share["least"], share["most"], share["resolved"]) == (0.0, 0.0, False)
    assert "on-off: changes nothing: O_same" in printed["notes"]
    assert len(list((tmp_path / "run" / "attribution" / "cases").iterdir())) == 1


def test_one_member_gives_shares_but_resolves_none(entry: Entry, tmp_path: Path) -> None:
    (tmp_path / "single.toml").write_text(SMALL.replace("members = 2", "members = 1"))
    assert entry("run", "single.toml", "--out", "run").code == 0
    printed = json.loads(entry("report", "run", "--attribution", "--json").stdout)
    shares = [s for of in printed["attribution"] for f in FIGURES for s in of["figures"][f]["shares"]]
    assert {share["resolved"] for share in shares} == {None}
    assert {share["order_free"]["low"] for share in shares} == {None}
    assert any("no share can be called resolved" in note for note in printed["notes"])
    for form in ("table", "html"):
        assert entry("report", "run", "--attribution", "--format", form).code == 0


# --- what is refused --------------------------------------------------------------------------------


def test_it_stands_in_place_of_the_comparison_and_goes_with_no_other(entry: Entry, small_run: Path) -> None:
    ended = entry("report", "run", "--attribution", "--against", "paper")
    assert (ended.code, ended.stdout) == (2, "")
    assert "--attribution stands in place of the comparison and goes with no --against" in ended.stderr


def test_a_run_of_other_versions_is_not_mixed_with_new_cases(entry: Entry, small_run: Path) -> None:
    manifest = json.loads((small_run / "run.json").read_text())
    old = manifest["cases"][0]
    place = small_run / "cases"
    (place / f"O_0_january_{old['key']}").rename(place / f"O_0_january_{'0' * 16}")
    old["key"] = "0" * 16
    (small_run / "run.json").write_text(json.dumps(manifest))
    resum(small_run)
    ended = entry("report", "run", "--attribution")
    assert_clear(ended, INVALID)
    assert "`waxstudy run run/study.toml --out run`" in ended.stderr
    assert not (small_run / "attribution").exists()
    assert entry("run", "run/study.toml", "--out", "run").code == 0
    assert entry("report", "run", "--attribution").code == 0


def test_a_study_without_steps_has_nothing_to_share(entry: Entry, tmp_path: Path) -> None:
    start_only = SMALL[: SMALL.index("steps = [")].replace('reference = "O_WM"', 'reference = "O_0"')
    (tmp_path / "start.toml").write_text(start_only)
    assert entry("run", "start.toml", "--out", "run").code == 0
    ended = entry("report", "run", "--attribution")
    assert_clear(ended, INVALID)
    assert ended.stderr == "error: no ladder of this study has a step\n"


# --- killed and interrupted -------------------------------------------------------------------------

LONG = """\
[study]
name = "long"
step_s = 4
[room]
use = "nzeb"
[weather.january]
use = "tallinn-week"
month = "january"
[ensemble]
members = 2
[ladder.on-off]
reference = "wax"
start = { id = "simple", controller = { use = "on-off" }, valve = { use = "linear" } }
steps = [
  { id = "precise", controller = { dead_band_K = 0.5 } },
  { id = "delay", sensor = { use = "delay", delay_s = 120.0 } },
  { id = "valve", valve = { use = "quick-opening" } },
  { id = "wax", actuator = { use = "variable-times" } },
]
"""
REPORT = ("report", "run", "--attribution", "--json")


def begun(folder: Path) -> Any:
    """The command as soon as it has finished a set."""
    process = start(folder, *REPORT)
    while process.poll() is None and not finished_cases(folder / "run" / "attribution"):
        time.sleep(0.01)
    return process


@pytest.mark.slow
def test_one_that_is_killed_or_interrupted_goes_on_to_the_same_bytes(waxstudy: Waxstudy, tmp_path: Path) -> None:
    (tmp_path / "long.toml").write_text(LONG)
    assert waxstudy("run", "long.toml", "--out", "run").returncode == 0
    shutil.copytree(tmp_path / "run", tmp_path / "once" / "run")
    killed = begun(tmp_path)
    killed.kill()
    killed.communicate()
    kept = finished_cases(tmp_path / "run" / "attribution")
    assert kept
    interrupted = start(tmp_path, *REPORT)
    while interrupted.poll() is None and len(finished_cases(tmp_path / "run" / "attribution")) == len(kept):
        time.sleep(0.01)
    interrupted.send_signal(signal.SIGINT)
    stdout, stderr = interrupted.communicate()
    assert (interrupted.returncode, stdout) == (INTERRUPTED, "")
    assert stderr.strip() == "interrupted; what was finished is kept, the same command goes on from there"
    place = tmp_path / "run" / "attribution"
    inodes = {name: (place / name).stat().st_ino for name in finished_cases(place)}
    resumed = waxstudy(*REPORT)
    assert (resumed.returncode, resumed.stderr) == (0, "")
    assert {name: (place / name).stat().st_ino for name in inodes} == inodes
    whole = start(tmp_path / "once", *REPORT)
    assert whole.communicate()[0] == resumed.stdout
    assert contents(tmp_path / "once" / "run") == contents(tmp_path / "run")
