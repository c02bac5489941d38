"""Whatever is wrong with the input: an exit code, a line that says where and what, and no harm to earlier results."""

from __future__ import annotations

import re
import shutil
from datetime import datetime, timedelta
from pathlib import Path

import pytest

from tests.cli.conftest import Ended, Entry
from tests.cli.folders import contents
from tests.conftest import SMALL

USAGE, INVALID, FAILED = 2, 3, 6
# what only a library or a traceback would say
FOREIGN = re.compile(
    r"traceback|pydantic|tomllib|validation error|https?://|errno|input_value|<class|/site-packages/", re.I
)


def assert_clear(ended: Ended, code: int) -> None:
    assert (ended.code, ended.stdout) == (code, "")
    assert not FOREIGN.search(ended.stderr), ended.stderr


def line_of(text: str, part: str) -> int:
    return text[: text.index(part)].count("\n") + 1


# what is changed in the small study, and what the line says after its place
MISTAKES = {
    "syntax": ('name = "small"', "name = small", "not valid TOML: a value is expected here"),
    "no quote at the end": ('"tallinn-week"', '"tallinn-week', "not valid TOML: a text is not closed"),
    "key twice": ("members = 2", "members = 2\nmembers = 3", "this key is given twice"),
    "unknown key": ("members = 2", "memebrs = 2", "[ensemble] memebrs: unknown key; did you mean 'members'?"),
    "unknown table": ("[ensemble]", "[ensembel]", "ensembel: unknown key; did you mean 'ensemble'?"),
    "wrong type": ("members = 2", 'members = "two"', '[ensemble] members = "two": must be a whole number'),
    "number as text": ("dead_band_K = 0.5", 'dead_band_K = "0.5"', 'controller.dead_band_K = "0.5": must be a number'),
    "not a table": ('valve = { use = "linear" }', 'valve = "linear"', 'must be a table such as { use = "linear" }'),
    "unknown block": ("quick-opening", "quick", "no valve 'quick' (installed: linear, quick-opening)"),
    "unknown parameter": ("dead_band_K", "dead_band", "controller.dead_band: unknown key; did you mean 'dead_band_K'?"),
    "out of range": ("dead_band_K = 0.5", "dead_band_K = -1", "controller.dead_band_K = -1: must be at least 0"),
    "not finite": ("members = 2", "[comfort]\nsetpoint_C = nan", "[comfort] setpoint_C = nan: must be a finite number"),
    "duplicate id": ('id = "O_CP"', 'id = "O_0"', "there is a case of this name in line 16"),
    "no reference": ('[ladder.on-off]\nreference = "O_WM"', "[ladder.on-off]", "reference: missing: the case that"),
    "wrong reference": ('reference = "O_WM"', 'reference = "O_MW"', "is no case of this ladder; did you mean 'O_WM'?"),
    "misspelt steps": ("steps = [", "step = [", "[ladder.on-off] step: unknown key; did you mean 'steps'?"),
    "name with a path": (
        'name = "small"',
        'name = "../small"',
        '[study] name = "../small": must be at most 64 letters',
    ),
    "unknown published figures": (
        'name = "small"',
        'name = "small"\nagainst = "papr"',
        "no reference 'papr'; did you mean 'paper'?",
    ),
}


@pytest.mark.parametrize(("old", "new", "says"), MISTAKES.values(), ids=MISTAKES)
def test_a_mistake_in_the_study_is_answered_with_its_file_and_line(
    entry: Entry, small_study: Path, small_run: Path, old: str, new: str, says: str
) -> None:
    before = contents(small_run)
    small_study.write_text(SMALL.replace(old, new, 1))
    ended = entry("run", "small.toml", "--out", "run")
    assert_clear(ended, INVALID)
    line = line_of(SMALL, old) + new.count("\n")
    told = [told for told in ended.stderr.splitlines() if says in told]
    assert [told.split(" ")[0] for told in told] == [f"small.toml:{line}:"], ended.stderr
    assert contents(small_run) == before


def test_all_problems_are_told_at_once_one_line_each_in_the_order_of_the_file(entry: Entry, small_study: Path) -> None:
    text = SMALL.replace("members = 2", "members = 0").replace("dead_band_K", "dead_band").replace('january"', 'june"')
    small_study.write_text(text)
    ended = entry("run", "small.toml")
    assert_clear(ended, INVALID)
    lines = [int(line.split(":")[1]) for line in ended.stderr.splitlines()]
    parts = ('"june"', "members = 0", "dead_band")
    assert lines == [line_of(text, part) for part in parts]


def test_a_study_that_is_a_folder_or_no_text_is_refused(entry: Entry, tmp_path: Path) -> None:
    ended = entry("run", ".")
    assert_clear(ended, INVALID)
    assert ended.stderr == ".: this is a folder; a TOML file is expected\n"
    (tmp_path / "binary.toml").write_bytes(b"[study]\nname = \xff\xfe\x00")
    ended = entry("run", "binary.toml")
    assert_clear(ended, INVALID)
    assert ended.stderr.startswith("binary.toml:2: not UTF-8 text")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["run"], "Missing argument 'STUDY.toml'"),
        (["run", "nosuch.toml"], "'nosuch.toml' does not exist.\n"),
        (["run", "smal.toml"], "'smal.toml' does not exist. Did you mean 'small.toml'?"),
        (["run", "small.toml", "--ouT", "x"], "No such option '--ouT'"),
        (["report"], "Missing argument 'RUN'"),
        (["report", "nosuch"], "'nosuch' does not exist"),
        (["report", "small.toml"], "'small.toml' is a file"),
        (["report", "run", "--format", "xls"], "'xls' is not one of 'table', 'csv', 'md', 'html', 'json'"),
        (["report", "run", "--out", "run"], "'run' is a directory"),
        (["rnu", "small.toml"], "No such command 'rnu'"),
        ([], "Usage: waxstudy"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_a_wrong_command_line_is_a_matter_of_usage(
    entry: Entry, small_study: Path, small_run: Path, arguments: list[str], says: str
) -> None:
    ended = entry(*arguments)
    assert_clear(ended, USAGE)
    assert says in ended.stderr


# --- weather files ----------------------------------------------------------------------------------

HEADER = ["LOCATION,Nowhere,-,EST,made up,0,59.4,24.8,2.0,34.0", *["DATA PERIODS"] * 7]


def january(days: int = 10) -> list[str]:
    """Rows of a cold, dark January, as EPW has them."""
    rows = []
    for hour in range(24 * days):
        start = datetime(2001, 1, 1) + timedelta(hours=hour)
        figures = ["-5.0", "-6.0", "90", "101325", "0", "0", "250", "0", "0", "0", *["0"] * 19]
        rows.append(f"2001,{start.month},{start.day},{start.hour + 1},60,made up,{','.join(figures)}")
    return rows


EPW = '[weather.january]\nuse = "epw"\npath = "weather/cold.epw"\nstart = "01-02"\n'
WITH_EPW = SMALL.replace('[weather.january]\nuse = "tallinn-week"\nmonth = "january"\n', EPW)
GAP = "hours are missing, doubled or out of order"


def write_epw(folder: Path, rows: list[str]) -> None:
    (folder / "weather").mkdir()
    (folder / "weather" / "cold.epw").write_text("\n".join([*HEADER, *rows]) + "\n")
    (folder / "small.toml").write_text(WITH_EPW)


def test_a_weather_file_is_needed_for_the_run_and_not_for_its_report(entry: Entry, tmp_path: Path) -> None:
    write_epw(tmp_path, january())
    ended = entry("run", "small.toml")
    assert (ended.code, ended.stderr) == (0, "")
    shutil.rmtree(tmp_path / "weather")
    assert entry("report", "results/small").code == 0  # a finished run needs it no more


@pytest.mark.parametrize(
    ("rows", "line", "says"),
    [
        ([*january()[:50], *january()[51:]], 59, f"01-03 hour 4 follows 01-03 hour 2: {GAP}"),
        ([*january()[:50], *january()[49:]], 59, f"01-03 hour 2 follows 01-03 hour 2: {GAP}"),
        ([*january()[:48], *january()[72:96], *january()[48:72], *january()[96:]], 57, GAP),
        ([*january()[:60], january()[60].replace("-5.0", "99.9"), *january()[61:]], 69, "temperature is missing"),
        ([*january()[:60], "2001,1,3,13,60,made up,-5.0", *january()[61:]], 69, "radiation is missing"),
        ([*january()[:60], "half a ro"], 69, "not a row of year, month, day, hour 1 to 24"),
        (january(days=5), None, "which is less than 7 days from 01-02"),
        ([], None, "ends after line 8, before any hour of weather"),
    ],
    ids=["gap", "doubled", "out of order", "missing value", "short row", "cut off", "too short", "empty"],
)
def test_a_weather_file_that_cannot_be_used_is_named_with_the_study_s_line_and_its_own(
    entry: Entry, small_run: Path, rows: list[str], line: int | None, says: str
) -> None:
    before = contents(small_run)
    write_epw(small_run.parent, rows)
    ended = entry("run", "small.toml", "--out", "run")
    assert_clear(ended, INVALID)
    assert ended.stderr.startswith(f"small.toml:{line_of(WITH_EPW, '[weather')}: [weather.january]: ")
    assert ended.stderr.count("\n") == 1
    assert says in ended.stderr
    assert f"cold.epw line {line}: " in ended.stderr or line is None
    assert contents(small_run) == before


def test_a_weather_file_that_does_not_exist_is_named_where_the_study_names_it(entry: Entry, tmp_path: Path) -> None:
    (tmp_path / "small.toml").write_text(WITH_EPW)
    ended = entry("run", "small.toml")
    assert_clear(ended, INVALID)
    place = f"small.toml:{line_of(WITH_EPW, 'path =')}: [weather.january] path"
    looked = tmp_path / "weather" / "cold.epw"
    assert ended.stderr == f'{place} = "weather/cold.epw": no such file (looked for {looked})\n'


# --- where results cannot go ------------------------------------------------------------------------


@pytest.mark.parametrize("out", ["file", "file/below", "/dev/null", "/proc/waxstudy"])
def test_a_run_folder_that_cannot_be_made_is_a_failed_run(entry: Entry, small_study: Path, out: str) -> None:
    (small_study.parent / "file").write_text("not a folder\n")
    ended = entry("run", "small.toml", "--out", out)
    assert_clear(ended, FAILED)
    assert ended.stderr.startswith(f"error: {out}: the results cannot be written: ")
    assert ended.stderr.count("\n") == 1
    assert (small_study.parent / "file").read_text() == "not a folder\n"


@pytest.mark.parametrize("out", ["small.toml/below", "nosuch/table.csv", "/dev/null/table.csv"])
def test_a_report_that_cannot_be_written_is_a_failure_too(
    entry: Entry, small_study: Path, small_run: Path, out: str
) -> None:
    ended = entry("report", "run", "--out", out)
    assert_clear(ended, FAILED)
    assert ended.stderr.startswith(f"error: {out}: cannot be written: ")


def test_a_link_that_leads_nowhere_is_told_as_such(entry: Entry) -> None:
    Path("study.toml").symlink_to("study.toml")
    Path("room").symlink_to("gone")
    for name, target, command in (("study.toml", "study.toml", "run"), ("room", "gone", "diagnose")):
        ended = entry(command, name)
        assert_clear(ended, USAGE)
        assert f"'{name}' is a link to '{target}', which is not there or leads back to it." in " ".join(
            ended.stderr.split()
        )
        assert "Did you mean" not in ended.stderr


def test_no_command_writes_through_a_link_that_leads_back_to_itself(entry: Entry, small_study: Path) -> None:
    Path("loop").symlink_to("loop")
    Path("gone").symlink_to("nowhere")
    run = ("run", "small.toml", "--out")
    made = ("reality", "small.toml", "--case", "O_WM", "--days", "2", "--out")
    brought = ("import", "small.toml", "--timezone", "UTC", "--out")
    for words in (run, made, brought, ("rig",), ("tune", "small.toml", "--case", "O_WM", "--out")):
        for link, leads_to in (("loop", "loop"), ("gone", "nowhere")):
            for out in (link, f"{link}/x"):
                ended = entry(*words, out)
                assert_clear(ended, USAGE)
                told = f"'{link}' is a link to '{leads_to}', which is not there or leads back to it."
                assert told in " ".join(ended.stderr.split()), words
    assert "'loop' is a link to 'loop'" in " ".join(entry("report", "loop/run").stderr.split())
    assert not Path("nowhere").exists()
