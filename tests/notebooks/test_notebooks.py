"""Claims about the notebooks: they run as they stand, and come to what they say."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.conftest import ROOT
from tests.notebooks.run import NAMES, NOTEBOOKS, PICTURES, code_of, executed


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_each_is_shown_on_the_page_with_its_picture() -> None:
    page = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    assert len(NAMES) == 3
    for name in NAMES:
        assert f"](notebooks/{name}.ipynb)" in page
        assert f"](images/notebook-{name}.svg)" in page
        assert (PICTURES / f"notebook-{name}.svg").is_file()
        assert '"outputs": []' in (NOTEBOOKS / f"{name}.ipynb").read_text(encoding="utf-8")


@pytest.mark.slow
def test_a_ladder_takes_ten_lines(place: Path) -> None:
    assert len(code_of("ladder")[0].splitlines()) <= 12
    names, figures = executed("ladder", place)
    assert set(names["run"].differences.reset_index()["case"]) == {"wide", "narrow", "wax"}
    assert len(figures[0].axes) == 2


@pytest.mark.slow
def test_a_history_ends_in_a_diagnosis_that_names_the_valve(place: Path) -> None:
    names, figures = executed("history", place)
    found = names["found"]
    assert "let-by" in {member for effect in found.diagnosis.effects for member in effect.group}
    assert figures[0].axes


@pytest.mark.slow
def test_a_motor_becomes_a_model_that_follows_it(place: Path) -> None:
    names, figures = executed("actuator", place)
    motor = names["motor"]
    record = motor.records[0]
    missed = record.opening - motor.modelled[record.name]
    assert float((missed**2).mean() ** 0.5) < 0.1
    assert set(names["run"].differences.reset_index()["case"]) == {"at-once", "mine"}
    assert figures[0].axes
