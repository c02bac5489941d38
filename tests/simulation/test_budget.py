"""Claims about what a run is told to take before it begins."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.cli.folders import contents
from waxstudy.plugin.registry import installed
from waxstudy.simulation.budget import Needs, TooLarge
from waxstudy.simulation.run import part_intervals, prepare, run
from waxstudy.study.read import read_study

GB = 1e9


@given(worker=st.floats(1e6, 20 * GB), memory=st.floats(0.0, 64 * GB))
def test_workers_fit_into_the_memory_and_are_told_if_fewer(worker: float, memory: float) -> None:
    said: list[str] = []
    try:
        workers = Needs(worker, 0.0).workers(memory, GB, said.append)
    except TooLarge:
        assert worker > 0.9 * memory
        return
    assert 1 <= workers <= 4
    assert workers * worker <= 0.9 * memory
    usual = Needs(1.0, 0.0).workers(memory, GB, said.append)
    assert bool(said) == (workers < usual)


def test_what_cannot_fit_is_refused_with_the_figures_and_a_way_out() -> None:
    with pytest.raises(
        TooLarge, match="takes about 12 GB of memory, 4 GB are free: take a longer step_s or fewer days"
    ):
        Needs(12 * GB, 0.0).workers(4 * GB, GB, print)
    with pytest.raises(
        TooLarge, match=r"traces take about 3 GB, 1 GB are free on the disk: keep traces of fewer members"
    ):
        Needs(GB, 3 * GB).workers(4 * GB, GB, print)


def test_the_disk_is_asked_for_what_is_still_to_be_computed_only(small_study: Path) -> None:
    study = read_study(small_study, installed())
    plan = prepare(study)
    jobs = plan.jobs()
    all_, one = Needs.of(study, plan.driven, jobs), Needs.of(study, plan.driven, jobs[:1])
    assert all_.disk == pytest.approx(len(jobs) * one.disk)
    assert Needs.of(study, plan.driven, []) == Needs(0.0, 0.0)
    assert one.disk == pytest.approx(7 * 24 * 60 * 40.0)


@pytest.mark.parametrize(
    ("step_s", "row_s", "part_h"), [(5.0, 60.0, 48), (5.0, 86400.0, 48), (1.0, 60.0, 9), (1.0, 7200.0, 8)]
)
def test_of_a_run_of_any_length_two_days_at_5_s_are_held_at_a_time(
    small_study: Path, step_s: float, row_s: float, part_h: int
) -> None:
    """Or as many steps, in whole rows of its trace."""
    driven = next(iter(prepare(read_study(small_study, installed())).driven.values()))
    assert driven.weather.interval_s == 3600.0
    assert part_intervals(replace(driven, step_s=step_s), row_s) == part_h


def test_a_study_that_cannot_fit_takes_no_folder_from_another(
    small_study: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    registry, folder = installed(), tmp_path / "run"
    run(read_study(small_study, registry), folder)
    before = contents(folder)
    other = tmp_path / "other.toml"
    other.write_text(small_study.read_text().replace("dead_band_K = 0.5", "dead_band_K = 0.7"))
    monkeypatch.setattr("waxstudy.simulation.run.free_disk", lambda folder: 1000.0)
    with pytest.raises(TooLarge, match="are free on the disk"):
        run(read_study(other, registry), folder, replaces=True)
    assert contents(folder) == before
