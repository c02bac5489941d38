"""The virtual bench makes records of any actuator, marked as simulated, and keeps the truth apart."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from tests.cli.conftest import Entry
from tests.cli.conftest import entry as entry
from tests.rig import regenerate_bench
from waxstudy.plugin.registry import installed
from waxstudy.rig.bench import Motors, run_trial
from waxstudy.rig.instruments import Bench, displacement_mm
from waxstudy.rig.programme import Trial, read_programme, table_a1
from waxstudy.study.problems import StudyError

SHORT = """\
combination,product,exemplar,valve,on_min,off_min,duration_min,measured
B1,B,1,no,15,15,95,displacement
B2v,B,2,yes,5-15,5-15,95,displacement
B2m,B,2,yes,15,15,95,flow
"""
SILENT = Bench(
    exemplar_scatter=0.0,
    record_scatter=0.0,
    cycle_scatter=0.0,
    slack_mm=0.0,
    friction_mm=0.0,
    noise_mm=0.0,
    resolution_mm=0.0,
    drift_mm_day=0.0,
    spikes_per_day=0.0,
)
TRIAL = Trial("B1", "B", "1", False, (15.0, 15.0), (15.0, 15.0), 120.0, "displacement")


def motors(bench: Bench = SILENT, seed: int = 1, actuator: str = "variable-times") -> Motors:
    return Motors(actuator, {}, "quick-opening", bench, seed)


@pytest.fixture
def programme(tmp_path: Path) -> Path:
    path = tmp_path / "short.csv"
    path.write_text(SHORT)
    return path


def test_the_command_writes_records_their_description_and_beside_them_the_truth(entry: Entry, programme: Path) -> None:
    done = entry("rig", "bench", "--programme", programme, "--seed", 3)
    assert (done.code, done.stderr) == (0, "")
    assert done.stdout == "bench-truth.json\nbench\n"
    assert sorted(path.name for path in Path("bench").iterdir()) == [
        *("B1_15-15.csv", "B2m_15-15.csv", "B2v_5to15-5to15.csv", "records.toml"),
    ]
    truth = json.loads(Path("bench-truth.json").read_text())
    assert truth["actuator"]["B"]["dead_a_s"] == -192.0
    assert [each["record"] for each in truth["records"]] == ["B1_15-15", "B2v_5to15-5to15", "B2m_15-15"]
    paces = {each["record"]: each["pace"]["exemplar"] for each in truth["records"]}
    assert paces["B2v_5to15-5to15"] == paces["B2m_15-15"] != paces["B1_15-15"]


def test_everything_it_writes_says_that_it_is_simulated(entry: Entry, programme: Path) -> None:
    entry("rig", "bench", "--programme", programme)
    for path in Path("bench").glob("*.csv"):
        assert path.read_text().startswith("# simulated by waxstudy rig: no motor was measured\n")
    assert tomllib.loads(Path("bench/records.toml").read_text())["simulated"] is True
    assert json.loads(Path("bench-truth.json").read_text())["simulated"] is True


def test_the_programme_is_that_of_table_a1_and_one_record_of_flow() -> None:
    trials = table_a1()
    displacement = [trial for trial in trials if trial.measured == "displacement"]
    assert len(displacement) == 18
    assert sum(trial.duration_min for trial in displacement) == 13_595.0
    assert {(trial.product, trial.exemplar) for trial in trials} == {("A", "1"), *(("B", n) for n in "1234")}


def test_an_ideal_bench_shows_the_opening_itself() -> None:
    made = run_trial(motors(), TRIAL)
    np.testing.assert_allclose((8.0 - made.value) / 2.5, made.opening, atol=1e-12)
    assert made.opening.min() == 0.0
    assert made.opening.max() == 1.0


def test_a_slower_exemplar_is_slower_in_all_of_its_times() -> None:
    slow = Bench(**{**SILENT.model_dump(), "exemplar_scatter": 0.1})
    for seed in (1, 2, 3):
        made, plain = (run_trial(motors(bench, seed, "constant-times"), TRIAL) for bench in (slow, SILENT))
        on = np.flatnonzero(np.diff(plain.signal_V) > 12.0)[1]
        opened = [float(np.argmax(each.opening[on:] > 0.5)) for each in (made, plain)]
        assert opened[0] / opened[1] == pytest.approx(made.pace["exemplar"], abs=0.01)


def test_the_first_cycle_is_not_conditioned() -> None:
    firsts = set()
    for seed in range(4):
        made = run_trial(motors(seed=seed), TRIAL)
        on = np.flatnonzero(np.diff(made.signal_V) > 12.0)
        dead = [int(np.argmax(made.opening[start:] > 0.0)) for start in on[:2]]
        firsts.add(dead[0])
        assert dead[0] > dead[1]
    assert len(firsts) > 1


def test_play_and_friction_hold_the_stem_back_and_noise_drift_and_resolution_show() -> None:
    opening = np.concatenate((np.linspace(0.0, 1.0, 200), np.linspace(1.0, 0.0, 200)))
    ideal = 8.0 - 2.5 * opening

    def shown(**changes: float) -> np.ndarray:
        bench = Bench(**{**SILENT.model_dump(), **changes})
        return displacement_mm(opening, 2.5, bench, np.random.default_rng(1)) - ideal

    assert shown(slack_mm=0.1)[100] == pytest.approx(0.1)
    assert shown(slack_mm=0.1)[399] == pytest.approx(0.0)
    jerks = shown(friction_mm=0.1)
    assert np.ptp(jerks) == pytest.approx(0.2, abs=0.03)
    assert shown(noise_mm=0.01).std() == pytest.approx(0.01, rel=0.2)
    assert np.abs(shown(resolution_mm=0.1)).max() == pytest.approx(0.05, abs=0.002)
    assert shown(drift_mm_day=5.0)[-1] != pytest.approx(0.0, abs=1e-3)


def test_gaps_and_spikes_come_as_often_as_asked_for() -> None:
    bench = Bench(gaps_per_day=50.0, spikes_per_day=500.0)
    trial = Trial("B1", "B", "1", False, (15.0, 15.0), (15.0, 15.0), 1440.0, "displacement")
    value = run_trial(motors(bench), trial).value
    assert 0.05 < np.isnan(value).mean() < 0.4
    assert 200 < np.sum(np.abs(np.diff(value[np.isfinite(value)])) > 0.3) < 2000


def test_the_same_seed_gives_the_same_record_whatever_else_is_on_the_programme() -> None:
    first, again, other = (run_trial(motors(Bench(), seed), TRIAL).value for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert not np.array_equal(first, other)


@pytest.mark.parametrize("name", [name for name in installed().names("actuator")])
def test_every_registered_actuator_can_stand_on_the_bench(name: str) -> None:
    made = run_trial(motors(actuator=name), TRIAL)
    assert 0.0 <= made.opening.min() < 0.1
    assert made.opening.max() > 0.9


def test_flow_follows_the_valve_s_curve() -> None:
    trial = Trial("B2m", "B", "2", True, (15.0, 15.0), (15.0, 15.0), 120.0, "flow")
    made = run_trial(motors(Bench(**{**SILENT.model_dump(), "flow_noise": 0.0})), trial)
    assert made.value.max() == pytest.approx(120.0)
    assert made.value[made.opening > 0.5].min() > 0.85 * 120.0
    assert made.value[made.opening < 0.1].max() < 0.05 * 120.0


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--actuator", "variable-time"), "no actuator 'variable-time'; did you mean 'variable-times'?"),
        (("--valve", "lineal"), "no valve 'lineal'; did you mean 'linear'?"),
        (("--bench", "nois_mm=1"), "--bench nois_mm: the bench has no such parameter; did you mean 'noise_mm'?"),
        (("--bench", "noise_mm=-1"), "--bench noise_mm: must be at least 0"),
        (("--bench", "noise_mm"), "'noise_mm' is not a parameter, '=' and a value"),
        (("--set", "fall_s=-1"), "actuator 'variable-times': fall_s"),
    ],
)
def test_what_the_bench_cannot_do_is_told_and_nothing_is_written(
    entry: Entry, programme: Path, options: tuple[str, ...], said: str
) -> None:
    done = entry("rig", "bench", "--programme", programme, *options)
    assert done.code == 2
    assert said in done.stderr
    assert not Path("bench").exists()
    assert not Path("bench-truth.json").exists()


def test_the_page_lists_every_parameter_of_the_bench_with_its_default() -> None:
    assert regenerate_bench.PAGE.read_text(encoding="utf-8") == regenerate_bench.page()


def test_nothing_is_overwritten(entry: Entry, programme: Path) -> None:
    Path("bench").mkdir()
    done = entry("rig", "bench", "--programme", programme)
    assert (done.code, done.stdout) == (2, "")
    assert "there is something of this name already" in done.stderr


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("15,15,95,displacement", "15,x,95,displacement", ':2: off_min = "x": must be minutes, such as 15'),
        ("15,15,95,displacement", "20-10,15,95,displacement", ':2: on_min = "20-10": must lie within'),
        ("B,1,no", "B,1,maybe", ':2: valve = "maybe": must be one of yes, no'),
        ("95,flow", "95,force", ':4: measured = "force": must be one of displacement, flow'),
        ("B1,B", "../B1,B", ':2: combination = "../B1"'),
        ("off_min,", "", ":1: a programme needs the columns"),
        ("B2v,B,2,yes,5-15,5-15", "B1,B,2,yes,15,15", "these records are there twice: B1_15-15"),
    ],
)
def test_what_is_wrong_with_a_programme_is_told_with_its_line(tmp_path: Path, old: str, new: str, said: str) -> None:
    path = tmp_path / "programme.csv"
    path.write_text(SHORT.replace(old, new, 1))
    with pytest.raises(StudyError) as refused:
        read_programme(path)
    assert said in str(refused.value)


def test_the_enthalpy_motor_moves_unlike_the_empirical_one(tmp_path: Path) -> None:
    ours, theirs = (run_trial(motors(actuator=name), TRIAL).opening for name in ("variable-times", "enthalpy"))
    difference = pd.Series(np.abs(ours - theirs))
    assert 0.0005 < difference.mean() < 0.05
