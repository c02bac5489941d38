"""Every problem of a study file: one exact line each, all at once."""

import pickle
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from waxstudy.plugin.registry import Registry, installed
from waxstudy.study.model import Study
from waxstudy.study.read import StudyError, problem_at, read_study

Problems = Callable[[str], list[str]]
Read = Callable[[str], Study]

GOOD = """\
[study]
name = "s"
[room]
use = "nzeb"
[weather.january]
use = "tallinn-week"
month = "january"
[ladder.a]
reference = "C_1"
start = { id = "C_0", controller = { use = "on-off" } }
steps = [
  { id = "C_1", sensor = { use = "delay" } },
]
"""


def test_a_small_study_reads(read: Read) -> None:
    assert list(read(GOOD).cases) == ["C_0", "C_1"]


TABLE = 'must be a table such as { id = "...", controller = { use = "..." } }'

# what is changed in the good study -> the only line that is printed
CHANGES = {
    "a value beyond its bound": (
        'use = "delay"',
        'use = "delay", delay_s = -5.0',
        "x.toml:12: case C_1: sensor.delay_s = -5.0: must be at least 0 (delay; unit s)",
    ),
    "a misspelled key of a table": (
        "[room]",
        "[ensemble]\nmemebrs = 16\n[room]",
        "x.toml:4: [ensemble] memebrs: unknown key; did you mean 'members'? (allowed: members, seed)",
    ),
    "a misspelled table": (
        "[room]",
        "[ensembel]\n[room]",
        "x.toml:3: ensembel: unknown key; did you mean 'ensemble'? "
        "(allowed: study, room, weather, comfort, season, ensemble, output, ladder, activation)",
    ),
    "a misspelled block": (
        "sensor = {",
        "sensr = {",
        "x.toml:12: case C_1: sensr: unknown key; did you mean 'sensor'? "
        "(allowed: id, sensor, controller, modulator, actuator, valve)",
    ),
    "a misspelled component": (
        '"delay"',
        '"delya"',
        "x.toml:12: case C_1: sensor.use = \"delya\": no sensor 'delya'; did you mean 'delay'? "
        "(installed: delay, fragile, ideal)",
    ),
    "a misspelled choice": (
        'month = "january"',
        'month = "janury"',
        "x.toml:7: [weather.january] month = \"janury\": must be 'january' or 'february'; did you mean 'january'? "
        "(month of the paper)",
    ),
    "a missing parameter": (
        'month = "january"',
        "",
        "x.toml:5: [weather.january] month: missing (month of the paper)",
    ),
    "a text for a number": (
        'use = "delay"',
        'use = "delay", delay_s = "5"',
        'x.toml:12: case C_1: sensor.delay_s = "5": must be a number (delay; unit s)',
    ),
    "infinity": (
        'use = "delay"',
        'use = "delay", delay_s = inf',
        "x.toml:12: case C_1: sensor.delay_s = inf: must be a finite number (delay; unit s)",
    ),
    "a broken number of members": (
        "[room]",
        "[ensemble]\nmembers = 1.5\n[room]",
        "x.toml:4: [ensemble] members = 1.5: must be a whole number, such as 1 (initial states)",
    ),
    "a step that does not divide the hour": (
        'name = "s"',
        'name = "s"\nstep_s = 7',
        "x.toml:3: [study] step_s = 7: must divide the hour, as 1, 2, 5, 10 or 60 s do",
    ),
    "a name that is no folder": (
        'name = "s"',
        'name = "../s"',
        "x.toml:2: [study] name = \"../s\": must be at most 64 letters a to z, digits, '_', '-' or '.', "
        "with a letter or digit at both ends",
    ),
    "a trace interval between steps": (
        "[room]",
        "[output]\ntrace_interval_s = 7\n[room]",
        "x.toml:4: [output] trace_interval_s = 7.0: must be a multiple of step_s = 5",
    ),
    "more traces than members": (
        "[room]",
        "[output]\ntrace_members = 17\n[room]",
        "x.toml:4: [output] trace_members = 17: must be at most [ensemble] members = 16",
    ),
    "a week without a name": (
        "[weather.january]",
        "[weather]\nuse = 3\n[weather.january]",
        "x.toml:6: [weather] use = 3: must be a table, written as [weather.NAME]",
    ),
    "a week whose name is no file name": (
        "[weather.january]",
        '[weather."a/b"]',
        "x.toml:5: [weather.a/b]: the name must be at most 64 letters a to z, digits, '_', '-' or '.', "
        "with a letter or digit at both ends",
    ),
    "no week": (
        '[weather.january]\nuse = "tallinn-week"\nmonth = "january"\n',
        "",
        "x.toml:1: [weather]: missing: at least one table [weather.NAME]",
    ),
    "no room": (
        '[room]\nuse = "nzeb"\n',
        "",
        "x.toml:1: [room] use: missing: no room is chosen yet (installed: nzeb)",
    ),
    "a room that is no table": (
        '[study]\nname = "s"\n[room]\nuse = "nzeb"\n',
        'room = 3\n[study]\nname = "s"\n',
        "x.toml:1: [room] = 3: must be a table, written as [room]",
    ),
    "a step that changes nothing yet there": (
        '{ use = "delay" }',
        "{ delay_s = 5.0 }",
        "x.toml:12: case C_1: sensor.use: missing: no sensor is chosen yet (installed: delay, fragile, ideal)",
    ),
    "a component's name that is none": (
        'use = "delay"',
        "use = 3",
        "x.toml:12: case C_1: sensor.use = 3: must be a name in quotes (installed: delay, fragile, ideal)",
    ),
    "a block that is no table": (
        '{ use = "delay" }',
        '"delay"',
        'x.toml:12: case C_1: sensor = "delay": must be a table such as { use = "delay" }',
    ),
    "a chain without a controller": (
        'controller = { use = "on-off" }',
        'valve = { use = "linear" }',
        "x.toml:10: case C_0: controller: missing: a chain needs a controller (installed: on-off, pi)",
    ),
    "no id": ('id = "C_0", ', "", "x.toml:10: [ladder.a] start.id: missing: every case needs one"),
    "an id that is no file name": (
        'id = "C_0"',
        'id = "C/0"',
        "x.toml:10: [ladder.a] start.id = \"C/0\": must be at most 64 letters a to z, digits, '_', '-' or '.', "
        "with a letter or digit at both ends",
    ),
    "the same id twice": (
        'id = "C_0"',
        'id = "c_1"',
        "x.toml:12: case C_1: id: there is a case of this name in line 10 (capitals do not count)",
    ),
    "a reference to no case": (
        'reference = "C_1"',
        'reference = "D_1"',
        "x.toml:9: [ladder.a] reference = \"D_1\": is no case of this ladder; did you mean 'C_1'? (cases: C_0, C_1)",
    ),
    "a reference among steps under a misspelt key": (
        "steps =",
        "step =",
        "x.toml:11: [ladder.a] step: unknown key; did you mean 'steps'? (allowed: reference, start, steps)",
    ),
    "no reference": (
        'reference = "C_1"\n',
        "",
        "x.toml:8: [ladder.a] reference: missing: the case that the others are compared with (cases: C_0, C_1)",
    ),
    "no start": (
        'start = { id = "C_0", controller = { use = "on-off" } }\n',
        "",
        f"x.toml:8: [ladder.a] start: missing: {TABLE}",
    ),
    "a start that is no table": (
        '{ id = "C_0", controller = { use = "on-off" } }',
        "5",
        f"x.toml:10: [ladder.a] start = 5: {TABLE}",
    ),
    "steps that are no list": (
        'reference = "C_1"',
        'reference = "B"\nsteps = 3\nstart = { id = "B", controller = { use = "pi" } }\n[ladder.b]\nreference = "C_1"',
        "x.toml:10: [ladder.a] steps = 3: must be a list of tables: [ { id = ... }, ... ]",
    ),
    "a step that is no table": (
        "steps = [\n",
        "steps = [\n  7,\n",
        'x.toml:12: [ladder.a] steps[0] = 7: must be a table such as { id = "...", sensor = { use = "..." } }',
    ),
    "a nested value": (
        'use = "nzeb"',
        'use = "nzeb"\n[[room.surfaces]]\narea_m2 = 4\n[[room.surfaces]]\narea_m2 = 0\n',
        "x.toml:8: [room] surfaces[1].area_m2 = 0: must be greater than 0 (area; unit m2)",
    ),
    "a nested key": (
        'use = "nzeb"',
        'use = "nzeb"\nsurfaces = [{ area_m2 = 4, layers = [\n  { thickness_m = 0.1, materal = "wood" },\n]}]',
        "x.toml:6: [room] surfaces[0].layers[0].materal: unknown key; did you mean 'material'? "
        "(allowed: thickness_m, material)",
    ),
    "a nested key that is missing": (
        'use = "nzeb"',
        'use = "nzeb"\nsurfaces = [\n  { },\n]',
        "x.toml:6: [room] surfaces[0].area_m2: missing (area; unit m2)",
    ),
    "a table where a list is due": (
        'use = "nzeb"',
        'use = "nzeb"\nsurfaces = { area_m2 = 3 }',
        "x.toml:5: [room] surfaces: must be a list in [ ]",
    ),
    "a list with one entry too few": (
        'use = "nzeb"',
        'use = "nzeb"\ncurve = [1.0]',
        "x.toml:5: [room] curve[1]: missing",
    ),
    "a switch that is a number": (
        'use = "nzeb"',
        'use = "nzeb"\nheated = 1',
        "x.toml:5: [room] heated = 1: must be true or false",
    ),
    "neither of two allowed types": (
        'use = "nzeb"',
        'use = "nzeb"\nflow = "desing"',
        "x.toml:5: [room] flow = \"desing\": must be a number, or must be 'design'; did you mean 'design'?",
    ),
    "a validator's own words": (
        'use = "tallinn-week"\nmonth = "january"',
        'use = "epw"\npath = "x.toml"\nstart = "0120"',
        'x.toml:8: [weather.january] start = "0120": must be MM-DD, e.g. 01-20',
    ),
    "a plugin that breaks on a value": (
        'use = "delay"',
        'use = "fragile", size = 2.0',
        "x.toml:12: case C_1: sensor: sensor 'fragile' of test 1 failed: KeyError: 2.0",
    ),
}


@pytest.mark.parametrize(("old", "new", "line"), CHANGES.values(), ids=CHANGES.keys())
def test_a_mistake_is_one_exact_line(problems: Problems, old: str, new: str, line: str) -> None:
    assert old in GOOD
    assert problems(GOOD.replace(old, new, 1)) == [line]


def test_all_problems_come_at_once_in_the_order_of_the_file(problems: Problems) -> None:
    text = GOOD.replace('name = "s"', "").replace("nzeb", "nzbe").replace("C_1", "C_9", 1).replace('"delay"', "1")
    assert [line.split(":")[1] for line in problems(text)] == ["1", "4", "9", "12"]


def test_an_empty_file_names_every_table_that_is_needed(problems: Problems) -> None:
    assert [line.split(" ")[1].rstrip(":") for line in problems("")] == [
        "[study]",
        "[room]",
        "[weather]",
        "[ladder]",
    ]


def steps(*entries: str) -> str:
    return GOOD.replace('  { id = "C_1", sensor = { use = "delay" } },', "\n".join(f"  {entry}," for entry in entries))


def test_an_inherited_value_is_reported_where_it_was_written_and_once(problems: Problems) -> None:
    text = steps(
        '{ id = "C_1", sensor = { use = "delay", delay_s = -1.0 } }',
        '{ id = "C_2", valve = { use = "linear" } }',
        '{ id = "C_3", valve = { use = "quick-opening" } }',
    )
    assert problems(text) == ["x.toml:12: case C_1: sensor.delay_s = -1.0: must be at least 0 (delay; unit s)"]


def test_a_value_that_is_wrong_in_two_steps_is_reported_for_both(problems: Problems) -> None:
    text = steps(
        '{ id = "C_1", sensor = { use = "delay", delay_s = -1.0 } }', '{ id = "C_2", sensor = { delay_s = -2.0 } }'
    )
    assert [line.split(": must")[0] for line in problems(text)] == [
        "x.toml:12: case C_1: sensor.delay_s = -1.0",
        "x.toml:13: case C_2: sensor.delay_s = -2.0",
    ]


def test_a_contradiction_is_laid_to_the_step_that_makes_it_and_said_once(problems: Problems) -> None:
    text = steps(
        '{ id = "C_1", actuator = { use = "variable-times", product = "A" } }',
        '{ id = "C_2", actuator = { dead_s = 200.0 } }',
        '{ id = "C_3", actuator = { rise_s = 90.0 } }',
    )
    assert problems(text) == ["x.toml:13: case C_2: actuator: give either product or dead_s"]


def test_a_block_that_was_never_chosen_is_reported_once(problems: Problems) -> None:
    text = steps('{ id = "C_1", sensor = { delay_s = 1.0 } }', '{ id = "C_2", sensor = { delay_s = 2.0 } }')
    assert [line.split(" (")[0] for line in problems(text)] == [
        "x.toml:12: case C_1: sensor.use: missing: no sensor is chosen yet"
    ]


def test_weeks_that_differ_only_in_capitals_are_refused(problems: Problems) -> None:
    text = GOOD + '[weather.January]\nuse = "tallinn-week"\nmonth = "january"\n'
    assert problems(text) == [
        "x.toml:14: [weather.January]: there is a week of this name in line 5 (capitals do not count)"
    ]


@pytest.mark.parametrize("value", ["nope.epw", "", "a\\u0000b", "a" * 5000, "."])
def test_a_file_that_is_not_there_is_a_problem_of_the_study(read: Read, value: str) -> None:
    wrong = "this is a folder, not a file" if value in ("", ".") else "no such file"
    text = GOOD.replace('use = "tallinn-week"\nmonth = "january"', f'use = "epw"\npath = "{value}"')
    with pytest.raises(StudyError, match=rf"x\.toml:7: \[weather\.january\] path = .*: {wrong}") as caught:
        read(text)
    assert not caught.value.is_plugin_fault


SYNTAX = {
    'name = "s': (1, "a text is not closed"),
    "[study\n": (1, "this table heading is not closed"),
    "[a]\n[a]": (2, "this table is given twice"),
    "a = 1\na = 2\n": (2, "this key is given twice"),
    "a = { b = 1, b = 2 }": (1, "this key is given twice"),
    "a = 1 K": (1, "numbers without a unit"),
    "a = True": (1, "a value is expected here"),
    "a = 5.": (1, "one key per line"),
    "a = [1 2]": (1, "a comma is missing in this list"),
    "a = { b = 1 c = 2 }": (1, "a comma is missing in this table"),
    "a\n": (1, "'=' is expected after a key"),
    "x = { band = 1,5 }": (1, "a decimal number has a point, no comma"),
    "\n= 1": (2, "a key or a [table] is expected here"),
    'path = "C:\\Users"': (1, "a backslash in a text"),
    'path = "C:\\data"': (1, "a backslash in a text"),
    "a = '\x01'": (1, "control character"),
    "a = { b = 1, }": (1, "a key is expected here"),
    "a = { b = 1 }\na.c = 2": (2, "this table was finished further up"),
    "a = 2020-13-45T00:00:00": (1, "TOML"),
}


@pytest.mark.parametrize("text", SYNTAX)
def test_a_mistake_in_the_notation_is_placed_and_said_in_our_words(problems: Problems, text: str) -> None:
    line, words = SYNTAX[text]
    [printed] = problems(text)
    assert printed.startswith(f"x.toml:{line}: not valid TOML: ")
    assert words in printed
    assert not re.search(r"http|toml\.io|Invalid|Expected|at line|namespace", printed)


@pytest.mark.parametrize("text", ["a = " + "[" * 5000, "a = " + "9" * 5000, ".".join("a" * 3000) + " = 1"])
def test_extremes_are_problems_too(problems: Problems, text: str) -> None:
    [printed] = problems(text)
    assert "may be nested 20 deep" in printed or "whole numbers go up to" in printed


def test_a_whole_number_beyond_64_bits_is_refused_with_its_line(problems: Problems) -> None:
    assert problems("\n\na.b = [1, 0x1ffffffffffffffffff]") == ["x.toml:3: whole numbers go up to 9223372036854775807"]


def test_a_file_that_cannot_be_read_says_why(tmp_path: Path, registry: Registry) -> None:
    (tmp_path / "utf16.toml").write_text("[study]\n", encoding="utf-16")
    (tmp_path / "latin.toml").write_bytes(b"[study]\nname = 's'\n# f\xfcr\n")
    expected = {
        "missing.toml": ": no such file",
        ".": ": this is a folder; a TOML file is expected",
        "utf16.toml": ":1: not UTF-8 text: save the file with the encoding UTF-8",
        "latin.toml": ":3: not UTF-8 text: save the file with the encoding UTF-8",
    }
    for name, words in expected.items():
        with pytest.raises(StudyError) as caught:
            read_study(tmp_path / name, registry)
        assert str(caught.value) == f"{tmp_path / name}{words}"


def test_a_byte_order_mark_is_no_mistake(read: Read) -> None:
    assert read("\ufeff" + GOOD).name == "s"


def test_lines_of_another_system_are_counted_alike(tmp_path: Path, registry: Registry) -> None:
    path = tmp_path / "x.toml"
    path.write_bytes(GOOD.replace("nzeb", "nzbe").replace("\n", "\r\n").encode())
    with pytest.raises(StudyError, match=r"x\.toml:4: "):
        read_study(path, registry)


def test_what_a_file_says_stays_on_one_line_and_off_the_terminal(problems: Problems) -> None:
    [printed] = problems('"a\\n\\u001b[31mb" = 1\n' + GOOD)
    assert printed.startswith("x.toml:1: a \\x1b[31mb: unknown key")


def test_an_unknown_name_is_a_plugins_fault_only_where_a_plugin_is_broken(tmp_path: Path, registry: Registry) -> None:
    path = tmp_path / "x.toml"
    path.write_text(GOOD.replace('"delay"', '"enthalpy"'))
    with pytest.raises(StudyError) as caught:
        read_study(path, registry)
    assert not caught.value.is_plugin_fault

    broken = Registry(registry.components, {"wax": "ImportError: no module\nnamed 'x'"})
    with pytest.raises(StudyError, match="'wax' is broken: ImportError: no module named 'x'") as caught:
        read_study(path, broken)
    assert caught.value.is_plugin_fault

    path.write_text(GOOD.replace('"delay"', '"enthalpy"').replace("C_1", "C_9", 1))
    with pytest.raises(StudyError) as caught:
        read_study(path, broken)
    assert not caught.value.is_plugin_fault, "the file has a mistake of its own"


def test_a_broken_plugin_does_not_matter_to_a_study_that_does_without_it(tmp_path: Path, registry: Registry) -> None:
    path = tmp_path / "x.toml"
    path.write_text(GOOD)
    assert read_study(path, Registry(registry.components, {"wax": "ImportError"})).name == "s"


def test_a_problem_that_shows_later_is_placed_at_its_table(tmp_path: Path) -> None:
    path = tmp_path / "x.toml"
    path.write_text(GOOD)
    assert str(problem_at(path, ("weather", "january"), "no sun")) == f"{path}:5: [weather.january]: no sun"
    assert str(problem_at(path, ("room",), "no floor")) == f"{path}:3: [room]: no floor"
    path.unlink()
    assert str(problem_at(path, ("room",), "no floor")) == f"{path}: [room]: no floor"


def test_the_papers_study_reads_with_the_installed_plugins() -> None:
    study = read_study(Path(__file__).parents[2] / "studies" / "table5.toml", installed())
    assert len(study.cases) == 11
    assert list(study.weeks) == ["january", "february"]


def test_problems_come_whole_out_of_another_process(tmp_path: Path, registry: Registry) -> None:
    path = tmp_path / "s.toml"
    path.write_text(GOOD.replace("on-off", "onoff"))
    with pytest.raises(StudyError) as refused:
        read_study(path, registry)
    again = pickle.loads(pickle.dumps(refused.value))
    assert (str(again), again.problems) == (str(refused.value), refused.value.problems)
