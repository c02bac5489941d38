"""`waxstudy diagnose` of rooms that were measured beside each other."""

from __future__ import annotations

import json
from pathlib import Path

from tests.conftest import call
from tests.diagnosis.houses import Event, made
from tests.diagnosis.test_neighbours import written


def test_the_command_names_the_room_on_summary_page_and_in_json(tmp_path: Path) -> None:
    event = Event(2, [(100.0, 108.0)], outside_W_K=30.0)
    folder, out = written(tmp_path / "house", made(0, days=8, events=[event]), 5), tmp_path / "out"
    result = call(tmp_path, "diagnose", str(folder), "--out", str(out), "--quick", "--quiet")
    assert result.returncode == 0, result.stderr
    assert "a room departs from its neighbours" in result.stdout
    assert "room2, 15 Jan 04:00 to 12:00: colder" in " ".join(result.stdout.split())
    found = json.loads((out / "diagnosis.json").read_text())
    assert found["verdict"] == "room"
    assert found["neighbours"]["events"][0]["room"] == "room2"
    assert len(found["neighbours"]["rooms"]) == 5
    page = (out / "report.html").read_text()
    assert "what departs from its neighbours" in page.lower()
    assert 'id="figure-rooms' in page


def test_a_refusal_names_the_table_and_the_column(tmp_path: Path) -> None:
    folder = written(tmp_path, made(0, days=4, rooms=3), 3)
    told = folder / "dataset.toml"
    told.write_text(told.read_text().replace('"room1"', '"roam1"'))
    result = call(tmp_path, "diagnose", str(folder), "--quiet")
    assert result.returncode == 3
    assert "[neighbours.room1]" in result.stderr
    assert "roam1" in result.stderr
