"""`waxstudy report`: every format, and what it says of a run that it cannot read."""

from __future__ import annotations

import csv
import json
import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from tests.cli.conftest import Entry
from tests.cli.folders import contents
from tests.cli.test_bad_input import INVALID, assert_clear
from tests.conftest import WAXSTUDY

FIGURES = ("setpoint_shift_K", "mae_K", "heat_kWh_m2_week", "heat_vs_most_detailed_percent")
CORRECTED = ("heat_corrected_kWh_m2_week", "heat_corrected_vs_most_detailed_percent")
STARTS_WITH = {
    "table": "january: 2 members",
    "csv": "case,week,",
    "md": "# small",
    "json": "{",
    "html": "<!DOCTYPE html>",
}


@pytest.mark.parametrize("form", STARTS_WITH)
def test_every_format_is_printed_or_written_to_a_file(entry: Entry, small_run: Path, form: str) -> None:
    printed = entry("report", "run", "--format", form)
    assert (printed.code, printed.stderr) == (0, "")
    assert printed.stdout.startswith(STARTS_WITH[form])
    written = entry("report", "run", "--format", form, "--out", "report.txt")
    assert written == (0, "", "")
    assert (small_run.parent / "report.txt").read_text(encoding="utf-8") == printed.stdout


@pytest.mark.parametrize(
    ("name", "options", "form"),
    [
        ("page.html", (), "html"),
        ("table.CSV", (), "csv"),
        ("a.json", (), "json"),
        ("a.md", (), "md"),
        ("a.txt", (), "table"),
        ("a.html", ("--format", "csv"), "csv"),
        ("a.csv", ("--json",), "json"),
    ],
)
def test_the_suffix_of_out_says_the_format_unless_it_is_given(
    entry: Entry, small_run: Path, name: str, options: tuple[str, ...], form: str
) -> None:
    assert entry("report", "run", "--out", name, *options).code == 0
    assert Path(name).read_text().startswith(STARTS_WITH[form])


def test_a_pipe_or_device_is_written_to_and_not_replaced(entry: Entry, small_run: Path) -> None:
    pipe = small_run.parent / "pipe"
    os.mkfifo(pipe)
    with ThreadPoolExecutor(1) as reader:
        read = reader.submit(pipe.read_text, encoding="utf-8")
        assert entry("report", "run", "--json", "--out", "pipe") == (0, "", "")
        assert read.result(timeout=30) == entry("report", "run", "--json").stdout
    assert pipe.is_fifo()


def test_the_csv_has_the_columns_of_table_5_each_with_its_spread(entry: Entry, small_run: Path) -> None:
    rows = list(csv.DictReader(entry("report", "run", "--format", "csv").stdout.splitlines()))
    pairs = [name for figure in FIGURES for name in (figure, f"{figure}_sd")]
    corrected = [name for figure in CORRECTED for name in (figure, f"{figure}_sd")]
    columns = ["case", "week", *pairs, "cycles_per_week", "resolved", "single_run_share"]
    assert list(rows[0]) == [*columns, *corrected, "corrected_resolved", "corrected_single_run_share"]
    assert [(row["case"], row["week"]) for row in rows] == [(case, "january") for case in ("O_0", "O_CP", "O_WM")]
    assert all(float(row[name]) == float(row[name]) for row in rows for name in (*pairs, *corrected, "cycles_per_week"))
    assert [row["resolved"] in ("yes", "no") for row in rows] == [True, True, False]
    assert rows[2]["resolved"] == ""


def test_json_is_the_same_by_either_option(entry: Entry, small_run: Path) -> None:
    short, long = entry("report", "run", "--json"), entry("report", "run", "--format", "json")
    assert short == long
    assert json.loads(short.stdout)["run"] == "run"


def test_a_report_changes_nothing_in_the_run_folder(entry: Entry, small_run: Path) -> None:
    before = contents(small_run)
    for form in STARTS_WITH:
        assert entry("report", "run", "--format", form).code == 0
    assert contents(small_run) == before


def test_piping_into_head_is_quiet(small_run: Path) -> None:
    command = f"set -o pipefail; '{WAXSTUDY}' report '{small_run}' --format html | head -n 1"
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "<!DOCTYPE html>\n", "")


# --- runs that cannot be read -----------------------------------------------------------------------


def cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size * 2 // 3])


def a_case(run: Path) -> Path:
    return sorted((run / "cases").iterdir())[1]


DAMAGE = {
    "run.json": lambda run: cut(run / "run.json"),
    "kpis.csv": lambda run: cut(run / "kpis.csv"),
    "study.toml": lambda run: cut(run / "study.toml"),
    "study.toml gone": lambda run: (run / "study.toml").unlink(),
    "traces.parquet": lambda run: cut(a_case(run) / "traces.parquet"),
    "durations.parquet": lambda run: cut(a_case(run) / "durations.parquet"),
    "a case's kpis.csv": lambda run: cut(a_case(run) / "kpis.csv"),
    "a case gone": lambda run: shutil.rmtree(a_case(run)),
    "all cases gone": lambda run: shutil.rmtree(run / "cases"),
}


@pytest.mark.parametrize("form", ["table", "html"])
@pytest.mark.parametrize("what", DAMAGE)
def test_a_run_folder_that_is_cut_off_is_refused_by_the_name_of_the_file(
    entry: Entry, small_run: Path, what: str, form: str
) -> None:
    whole = contents(small_run)
    DAMAGE[what](small_run)
    changed = [name for name in whole if contents(small_run).get(name) != whole[name]]
    ended = entry("report", "run", "--format", form)
    assert_clear(ended, INVALID)
    (line,) = ended.stderr.splitlines()
    named = line.removeprefix("error: ").split(":")[0]
    assert any(f"run/{name}".startswith(named) for name in changed)  # a file, or the folder of a case that is gone
    assert named != "run"


def test_running_the_study_again_mends_what_was_cut_off(entry: Entry, small_study: Path, small_run: Path) -> None:
    whole = contents(small_run)
    for what in DAMAGE:
        DAMAGE[what](small_run)
        assert contents(small_run) != whole
        assert entry("run", "small.toml", "--out", "run").code == 0
        assert contents(small_run) == whole, what


def test_a_run_folder_of_another_version_is_refused_by_name(entry: Entry, small_run: Path) -> None:
    manifest = json.loads((small_run / "run.json").read_text())
    (small_run / "run.json").write_text(json.dumps({**manifest, "format": 99}))
    ended = entry("report", "run")
    assert_clear(ended, INVALID)
    assert ended.stderr == (
        "error: run/run.json: run folder of format 99, this version reads 2; `waxstudy run` the study again\n"
    )


@pytest.mark.parametrize("manifest", ['{"format": 2}', "[]", "null", '{"format": 2, "study": "x", "cases": 3}'])
def test_a_manifest_that_is_none_is_refused_by_name(entry: Entry, small_run: Path, manifest: str) -> None:
    (small_run / "run.json").write_text(manifest)
    ended = entry("report", "run")
    assert_clear(ended, INVALID)
    assert ended.stderr.startswith("error: run/run.json: ")


def test_the_report_of_an_unfinished_run_says_how_to_finish_it(entry: Entry, small_run: Path) -> None:
    (small_run / "run.json").unlink()
    shutil.rmtree(a_case(small_run))
    ended = entry("report", "run")
    assert_clear(ended, INVALID)
    assert ended.stderr == (
        "error: run: this run has not finished (2 cases computed so far); "
        "`waxstudy run STUDY.toml --out run` goes on from there\n"
    )


def test_a_folder_without_a_run_is_said_to_be_one(entry: Entry, tmp_path: Path) -> None:
    ended = entry("report", ".")
    assert_clear(ended, INVALID)
    assert ended.stderr == "error: .: holds no run (no run.json)\n"


def test_a_folder_of_runs_is_answered_with_their_names(entry: Entry, small_run: Path) -> None:
    ended = entry("report", ".")
    assert_clear(ended, INVALID)
    assert ended.stderr == "error: .: holds no run (no run.json); runs in it: run\n"


# --- published figures and other runs ---------------------------------------------------------------


def test_unknown_published_figures_are_refused_with_what_is_installed(entry: Entry, small_run: Path) -> None:
    ended = entry("report", "run", "--against", "papers")
    assert_clear(ended, INVALID)
    assert ended.stderr == (
        "error: no reference 'papers'; did you mean 'paper'? (installed: paper); there is no run folder 'papers'\n"
    )


def test_a_folder_without_a_run_is_no_other_run(entry: Entry, small_run: Path) -> None:
    (small_run.parent / "empty").mkdir()
    ended = entry("report", "run", "--against", "empty")
    assert_clear(ended, INVALID)
    assert ended.stderr == "error: no reference 'empty' (installed: paper); the folder 'empty' holds no run\n"


def test_a_folder_with_a_run_goes_before_a_reference_of_its_name(entry: Entry, small_run: Path) -> None:
    (small_run.parent / "paper").mkdir()
    assert "published" in entry("report", "run", "--against", "paper", "--format", "csv").stdout
    (small_run.parent / "paper").rmdir()
    shutil.copytree(small_run, small_run.parent / "paper")
    header = entry("report", "run", "--against", "paper", "--format", "csv").stdout.splitlines()[0]
    assert "published" not in header
    assert header.endswith("heat_corrected_vs_most_detailed_percent_other_sd")


def test_a_study_s_published_figures_are_never_taken_from_a_folder(
    entry: Entry, small_study: Path, small_run: Path
) -> None:
    small_run.rename(small_run.parent / "paper")
    small_study.write_text(small_study.read_text().replace('"small"', '"small"\nagainst = "paper"'))
    ended = entry("run", "small.toml", "--out", "paper", "--json")
    assert ended.code == 0
    assert {"published", "ours"} <= set(json.loads(ended.stdout)["against"]["cells"][0])


@pytest.mark.parametrize("form", STARTS_WITH)
def test_another_run_is_put_beside_in_every_format(entry: Entry, small_run: Path, form: str) -> None:
    shutil.copytree(small_run, small_run.parent / "second")
    ended = entry("report", "run", "--against", "second", "--format", form)
    assert (ended.code, ended.stderr) == (0, "")
    assert ended.stdout.startswith(STARTS_WITH[form])
    assert ("_other_sd" if form == "csv" else "second") in ended.stdout


@pytest.mark.parametrize("what", ["run.json", "kpis.csv", "a case gone"])
def test_another_run_that_is_cut_off_is_refused_by_the_name_of_the_file(
    entry: Entry, small_run: Path, what: str
) -> None:
    second = shutil.copytree(small_run, small_run.parent / "second")
    DAMAGE[what](second)
    ended = entry("report", "run", "--against", "second")
    assert_clear(ended, INVALID)
    assert ended.stderr.startswith("error: second/")


def test_a_name_that_can_be_no_path_is_an_unknown_reference(entry: Entry, small_run: Path) -> None:
    ended = entry("report", "run", "--against", "x" * 5000)
    assert_clear(ended, INVALID)
    assert ended.stderr.startswith("error: no reference 'xxx")


def test_a_run_without_the_paper_s_cases_is_told_which_the_findings_lack(
    entry: Entry, small_study: Path, small_run: Path
) -> None:
    lacks = "the paper's findings need all its cases and weeks; missing: O_D, O_VC, P_0, P_CP, P_D, P_MC, P_VC, P_WM, "
    reported = entry("report", "run", "--against", "paper", "--json")
    assert (reported.code, reported.stderr) == (0, "")
    printed = json.loads(reported.stdout)
    assert f"{lacks}february" in printed["notes"]
    assert {cell["case"] for cell in printed["against"]["cells"]} == {"O_0", "O_CP", "O_WM"}
    small_study.write_text(small_study.read_text().replace('"small"', '"small"\nagainst = "paper"'))
    assert entry("run", "small.toml", "--out", "run").code == 0


def test_a_file_has_neither_the_colours_nor_the_width_of_the_terminal_it_was_asked_for_on(
    entry: Entry, small_run: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert entry("report", "run", "--out", "plain.txt").code == 0
    monkeypatch.setenv("COLUMNS", "60")
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    assert entry("report", "run", "--out", "typed.txt").code == 0
    assert Path("typed.txt").read_bytes() == Path("plain.txt").read_bytes()


def test_formats_that_contradict_each_other_are_refused_and_htm_is_a_page(entry: Entry, small_run: Path) -> None:
    refused = entry("report", "run", "--json", "--format", "csv")
    assert (refused.code, refused.stdout) == (2, "")
    assert entry("report", "run", "--out", "page.htm").code == 0
    assert Path("page.htm").read_text().startswith("<!DOCTYPE html>")


def test_a_suffix_of_no_format_is_refused_before_anything_is_computed(entry: Entry, small_run: Path) -> None:
    refused = entry("report", "run", "--out", "page.xlsx")
    assert (refused.code, Path("page.xlsx").exists()) == (2, False)
    assert "page.xlsx: a report has no such format" in refused.stderr
    assert entry("report", "run", "--out", "page.xlsx", "--format", "csv").code == 0


def test_a_sweep_is_told_to_be_one(entry: Entry, small_run: Path) -> None:
    sweep = Path("sweep")
    sweep.mkdir()
    (sweep / "sweep.parquet").write_bytes(b"")
    refused = entry("report", "sweep")
    assert (refused.code, "sweep: this is a sweep; sweep.parquet in it has a row" in refused.stderr) == (3, True)
