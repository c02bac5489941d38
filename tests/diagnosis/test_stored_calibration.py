"""Calibrations that are kept: a second record of a loop does not wait for its baseline again."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from tests.diagnosis.realities import EFFECTS, belief, dataset, record, rows
from waxstudy.diagnosis.calibration import stored
from waxstudy.diagnosis.diagnose import diagnose
from waxstudy.diagnosis.model.conventions import AFTER, BEFORE
from waxstudy.diagnosis.model.segments import segments
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.results.json_text import json_text

OF_ROOM = (
    "operative_temperature_C",
    "floor_surface_temperature_C",
    "return_temperature_C",
    "supply_temperature_C",
    "outdoor_temperature_C",
)


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[str]:
    """Return a list that gets longer with each calibration that is computed, none of them kept before."""
    computed: list[str] = []
    whole = stored.calibrate

    def counted(*how, **more):
        computed.append("a calibration")
        return whole(*how, **more)

    monkeypatch.setattr(stored, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(stored, "calibrate", counted)
    return computed


def told() -> str:
    healthy, now = (dataset(rows("REAL", 3, interval_s=300.0, seed=seed), "REAL") for seed in (1, 7))
    return json_text(diagnose(now, baseline=healthy, quick=True).described())


def calibrated(seed: int = 1, room_tolerance: float = 1.0) -> str:
    healthy = record("REAL", 3, without=OF_ROOM, interval_s=300.0, seed=seed)
    effects = [EFFECTS["sensor-lag"], EFFECTS["slow-actuator"]]
    return str(stored._kept(stored.calibrated(healthy, belief("REAL", healthy), effects, 0.3, room_tolerance)))


def files(folder: Path) -> list[Path]:
    return sorted((folder / stored.FOLDER).iterdir())


def test_a_second_record_gets_the_same_without_computing_it_again(made: list[str], tmp_path: Path):
    first, second = told(), told()
    assert (len(made), len(files(tmp_path))) == (1, 1)
    assert first == second


def test_what_is_damaged_or_foreign_is_computed_again(made: list[str], tmp_path: Path):
    first = calibrated()
    (kept,) = files(tmp_path)
    whole = kept.read_text()
    for damaged in (whole[:100], "[]", '{"departures": {}}', ""):
        kept.write_text(damaged)
        assert calibrated() == first
        assert kept.read_text() == whole
    assert len(made) == 5


def test_ways_to_read_a_log_that_a_healthy_record_does_not_tell_apart_are_kept_for_the_next(made: list[str]):
    healthy = record("REAL", 3, without=OF_ROOM, interval_s=300.0)
    believed, effects = belief("REAL", healthy), [EFFECTS["sensor-lag"]]
    first, *others = (each for each in segments(healthy, believed) if not each.is_supply)
    found = stored.calibrated(healthy, believed, effects, 0.3, 1.0)
    known = replace(found.as_built, as_good={first.name: (BEFORE,), **{each.name: () for each in others}})
    kept = json.loads(json.dumps(stored._kept(replace(found, as_built=known))))
    again = stored._recalled(kept, healthy, believed, effects, 1.0)
    assert again.as_built.as_good == known.as_good
    read = [SegmentProblem(first, healthy, believed, as_built=again.as_built, unknowns=each) for each in (None, ())]
    assert [list(each.conventions) for each in read] == [[AFTER, BEFORE], [AFTER]]  # the healthy one has one reading


def test_another_baseline_is_calibrated_by_itself(made: list[str], tmp_path: Path):
    calibrated()
    calibrated(seed=2)
    calibrated(room_tolerance=4.0)  # of a room that was guessed
    assert (len(made), len(files(tmp_path))) == (3, 3)


def test_a_cache_that_cannot_be_written_is_done_without(made: list[str], tmp_path: Path):
    (tmp_path / stored.FOLDER).write_text("no folder")
    assert calibrated() == calibrated()
    assert len(made) == 2
