"""A block of a study may come from a file that a fit, or a colleague, has written."""

from __future__ import annotations

import hashlib
from pathlib import Path

import pytest

from tests.conftest import SMALL
from waxstudy.plugin.registry import installed
from waxstudy.simulation.run import prepare, provenance
from waxstudy.study.model import Study
from waxstudy.study.read import StudyError, read_study

TIMES = {"dead_a_s": -180.0, "dead_b_s": 200.0, "dead_tau_s": 700.0, "rise_a_s": -20.0, "rise_b_s": 130.0}
TIMES |= {"rise_tau_s": 1000.0, "hold_a_s": 90.0, "hold_b_s": 50.0, "hold_tau_s": 500.0, "fall_s": 140.0}
FRAGMENT = '[actuator]\nuse = "variable-times"\n' + "".join(f"{name} = {value}\n" for name, value in TIMES.items())
FITTED = '[fit]\nsimulated = true\n\n[[fit.records]]\nfile = "a.csv"\n'
HERE = '{ use = "variable-times" }'


def study(folder: Path, actuator: str, fragment: str = FRAGMENT + FITTED) -> Study:
    (folder / "motors").mkdir(exist_ok=True)
    (folder / "motors" / "mine.toml").write_text(fragment)
    (folder / "x.toml").write_text(SMALL.replace(HERE, actuator))
    return read_study(folder / "x.toml", installed())


def problems(folder: Path, actuator: str, fragment: str = FRAGMENT) -> str:
    with pytest.raises(StudyError) as refused:
        study(folder, actuator, fragment)
    return str(refused.value)


def test_a_block_is_taken_from_the_file_with_changes_upon_it(tmp_path: Path) -> None:
    actuator = study(tmp_path, '{ from = "motors/mine.toml", fall_s = 150.0 }').cases["O_WM"].blocks["actuator"]
    assert actuator.described() == {"use": "variable-times", "form": "continuous", **TIMES, "fall_s": 150.0}


def test_it_replaces_the_block_before_it(tmp_path: Path) -> None:
    before = SMALL.replace(HERE, '{ use = "variable-times", product = "A" }')
    steps = before.removesuffix("]\n") + '  { id = "mine", actuator = { from = "motors/mine.toml" } },\n]\n'
    study(tmp_path, HERE)
    (tmp_path / "y.toml").write_text(steps)
    mine = read_study(tmp_path / "y.toml", installed()).cases["mine"].blocks["actuator"].described()
    assert "product" not in mine
    assert mine["fall_s"] == 140.0


def test_the_resolved_study_needs_the_file_no_more(tmp_path: Path) -> None:
    resolved = study(tmp_path, '{ from = "motors/mine.toml" }').described()
    assert resolved["ladder"]["on-off"]["steps"][1]["actuator"]["dead_a_s"] == -180.0
    assert "mine.toml" not in str(resolved)


def test_a_run_tells_which_file_it_was_and_that_its_records_were_simulated(tmp_path: Path) -> None:
    found = study(tmp_path, '{ from = "motors/mine.toml" }')
    digest = hashlib.sha256((tmp_path / "motors" / "mine.toml").read_bytes()).hexdigest()
    assert provenance(prepare(found), [])["fragments"] == {"motors/mine.toml": f"sha256 {digest}, simulated"}
    measured = study(tmp_path, '{ from = "motors/mine.toml" }', FRAGMENT)
    assert not measured.fragments["motors/mine.toml"].endswith("simulated")
    assert "fragments" not in provenance(prepare(study(tmp_path, HERE)), [])


@pytest.mark.parametrize(
    ("actuator", "fragment", "said"),
    [
        ('{ from = "motors/yours.toml" }', FRAGMENT, 'actuator.from = "motors/yours.toml": no such file'),
        ("{ from = 3 }", FRAGMENT, "actuator.from = 3: must be the name of a file in quotes"),
        (
            '{ from = "motors/mine.toml" }',
            '[valve]\nuse = "linear"\n',
            "describes no actuator: it has no table [actuator]",
        ),
        ('{ from = "motors/mine.toml" }', "actuator = ", "line 1: not valid TOML: a value is expected here"),
        ('{ from = "motors/mine.toml" }', f"x = {'1' * 5000}", "whole numbers go up to"),
        (r'{ from = "a\u0000b" }', FRAGMENT, "no file can have this name"),
        ('{ from = "motors" }', FRAGMENT, "this is a folder; a TOML file is expected"),
        (
            '{ from = "motors/mine.toml" }',
            FRAGMENT + "fall_S = 1.0\n",
            "from.fall_S: unknown key; did you mean 'fall_s'?",
        ),
        ('{ from = "motors/mine.toml", fall_s = -1.0 }', FRAGMENT, "case O_WM: actuator.fall_s = -1.0"),
    ],
)
def test_what_is_wrong_with_it_is_told_at_its_place(tmp_path: Path, actuator: str, fragment: str, said: str) -> None:
    told = problems(tmp_path, actuator, fragment)
    assert said in told
    assert len(told.splitlines()) == 1
    assert told.startswith(f"{tmp_path / 'x.toml'}:19: case O_WM: actuator")
