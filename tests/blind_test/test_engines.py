"""Claims about every engine: records that can be read, causes that show, and what they do without them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.blind_test.conftest import DATA
from tests.conftest import Waxstudy
from waxstudy.blind_test.draw import Case, Measured
from waxstudy.blind_test.plan import Plan, available, causes_of, left_out
from waxstudy.blind_test.record import without_noise, write_record
from waxstudy.blind_test.truth import Size, sizes
from waxstudy.dataset.channels import CHANNELS
from waxstudy.dataset.read import Dataset, read_dataset
from waxstudy.plugin import STAGES, trial
from waxstudy.plugin.registry import PluginError
from waxstudy.plugin.trial import Cause, Staged, Unmakeable, engine_of, engines

SIMULATED = ("fast-room", "other-plant", "thin-floor-plant")
TRIES = 30  # draws within which a cause must once show above its noise
DAYS = 3
SOME = ("let-by", "sticking-valve", "drifting-clock")
# the library's own effects are tried on the fast room by the claims about effects; the thin floor has the same causes
CAUSES = [
    (name, cause) for name in SIMULATED for cause in engine_of(name).causes() if cause.name in SOME or cause.is_family
]


def measured(engine: str, days: int = DAYS) -> Measured:
    return Measured("all", engine_of(engine).interval_s or 60.0, days, 1.0, 0.0, 3)


def case_of(engine: str, names: list[str], seed: int, days: int = DAYS) -> Case:
    scene = engine_of(engine).draw(np.random.default_rng(seed), names, days)
    return Case("record", "test", "single", engine, 0, measured(engine, days), scene)


def recorded(case: Case, folder: Path) -> tuple[Staged, Dataset]:
    staged = engine_of(case.engine).make(case.scene)
    write_record(folder / "record", staged, case.measured)
    return staged, read_dataset(folder / "record")


def shows(engine: str, cause: Cause, folder: Path) -> Size:
    """Return the first size above twice its floor."""
    for seed in range(TRIES):
        try:
            case = case_of(engine, [cause.name], seed)
            staged, seen = recorded(case, folder)
        except Unmakeable:
            continue
        (size,) = sizes(case, staged, seen, with_alike=False)
        if size and size.over > 2.0:
            return size
    raise AssertionError(f"{cause.name} never shows")


def marked(name: str, cause: Cause) -> Any:
    marks = () if cause.name in SOME else (pytest.mark.slow,)
    return pytest.param(name, cause, id=f"{name}-{cause.name}", marks=marks)


@pytest.mark.parametrize(("engine", "cause"), [marked(*each) for each in CAUSES])
def test_each_cause_gives_a_valid_record_and_shows_above_its_noise(engine: str, cause: Cause, tmp_path: Path) -> None:
    size = shows(engine, cause, tmp_path)
    assert size.gap > 2.0 * size.floor > 0.0


@pytest.mark.parametrize(
    ("cause", "channels", "judged"),
    [
        ("limited-travel", "no displacement", "flow_L_h"),
        ("let-by", "no flow", "floor_surface_temperature_C"),
        ("dead-band", "temperatures only", "floor_surface_temperature_C"),
    ],
)
def test_a_cause_shows_further_on_where_the_channel_behind_it_was_not_recorded(
    cause: str, channels: str, judged: str
) -> None:
    case = case_of("other-plant", [cause], 3)
    case = replace(case, measured=replace(case.measured, channels=channels))
    staged = engine_of(case.engine).make(case.scene)
    (size,) = sizes(case, staged, without_noise(staged, case.measured), with_alike=False)
    assert size
    assert (size.channel, size.over > 2.0) == (judged, True)


@pytest.mark.parametrize("engine", SIMULATED)
def test_a_null_is_a_valid_record_with_all_channels_that_the_stages_need(engine: str, tmp_path: Path) -> None:
    case = case_of(engine, ["let-by"], 1)
    case.scene["causes"] = []
    staged, seen = recorded(case, tmp_path)
    assert sizes(case, staged, seen) == []
    needed = {
        "sensor_temperature_C",
        "air_temperature_C",
        "control_output",
        "heating_signal",
        "displacement",
        "flow_L_h",
    }
    assert needed <= set(seen.values.columns)
    assert seen.room is not None
    assert len(seen.time) == DAYS * 1440


@pytest.mark.parametrize("engine", ["other-plant", "thin-floor-plant"])
def test_a_plant_driven_by_its_own_record_gives_it_again(engine: str) -> None:
    """So what a stage would do without a cause differs by that cause alone."""
    from waxstudy_trials.plant.engine import OtherPlant
    from waxstudy_trials.plant.loop import COLUMNS, READING, simulate
    from waxstudy_trials.plant.weather import weather

    plant = engine_of(engine)
    assert issubclass(plant, OtherPlant)
    course = weather(np.random.default_rng(1), 3, -3.0, 40.0, 6.0)
    free = simulate(plant.base, course, 21.0)
    for stage in ("sensor", "actuator", "room"):
        differs = np.abs(free - simulate(plant.base, course, 21.0, free, stage)).max(axis=0)
        assert [n for n, d in zip(COLUMNS, differs, strict=True) if d > 0.0] in ([], [COLUMNS[READING]])
        assert differs[READING] < 1e-3  # of the very first second


def test_a_plant_s_floor_and_air_keep_their_energy() -> None:
    """Water heat less what leaves through floor, walls and panes is what is stored, over a week, within 2 %."""
    from waxstudy_trials.plant.description import Plant
    from waxstudy_trials.plant.loop import COLUMNS, simulate
    from waxstudy_trials.plant.weather import Weather

    parts = 96 * 40
    still = np.zeros(parts)
    course = Weather(still - 5.0, still, still, still, still + 0.5, still + 30.0, still + 20.0)
    plant = Plant()._replace(ventilation_L_s=0.0, authority=0.5)
    found = simulate(plant, course, 35.0)[-86_400:]  # never warm enough: the valve stays open
    mean = dict(zip(COLUMNS, found.mean(axis=0), strict=True))
    water_W = mean["flow_L_h"] / 3600.0 * 4180.0 * (mean["supply_C"] - mean["return_C"])
    ends_K = np.abs(found[-1] - found[0]).max()
    assert ends_K < 0.01
    outside_W_K = 0.12 * plant.wall_m2 + 1.206 * plant.leak_L_s + plant.bridge_W_K
    # the boards are no warmer than the air, and the floor's underside no warmer than the water
    least = outside_W_K * (mean["air_C"] + 5.0) * 0.9 + plant.floor_U_W_m2K * plant.area_m2 * (mean["air_C"] + 5.0)
    most = (outside_W_K + 0.75 * plant.window_m2) * (mean["air_C"] + 5.0) * 1.1 + 0.08 * plant.area_m2 * 36.0
    assert least < water_W < most


def test_ten_families_lie_outside_the_library_in_every_stage_and_the_logger_half_of_them_kept() -> None:
    found = [cause for cause in engine_of("fast-room").causes() if cause.is_family]
    assert len(found) >= 10
    assert 2 * sum(cause.is_kept for cause in found) >= len(found)
    first = {cause.stages[0] for cause in found}
    assert first == set(STAGES)
    assert all(set(cause.stages) <= set(STAGES) for cause in found)
    library = {cause.name for cause in engine_of("fast-room").causes() if not cause.is_family}
    assert not library & {cause.name for cause in found}


def test_what_is_kept_is_drawn_in_judged_runs_only() -> None:
    kept = {name for name, engine in engines().items() if engine.is_kept}
    assert kept == {"thin-floor-plant"}
    assert not kept & set(available(is_judged=False))
    families = causes_of(engine_of("fast-room"), "family", is_judged=False)
    assert not {c.name for c in engine_of("fast-room").causes() if c.is_kept} & set(families)


def test_a_judged_run_has_what_it_must_and_a_share_of_it_every_stratum() -> None:
    from waxstudy.blind_test.key import Key

    key, names = Key(1, 32 * "a"), (*SIMULATED, "measured-house")
    slots = Plan(engines=names).slots(key)
    count = {stratum: sum(slot.stratum == stratum for slot in slots) for stratum in {slot.stratum for slot in slots}}
    effects = [cause.name for cause in engine_of("fast-room").causes() if not cause.is_family]
    goal = [slot.cause for slot in slots if slot.stratum == "goal"]
    assert {goal.count(name) for name in effects} == {8}
    assert (count["null"], count["pair"], count["other-null"], count["other-single"]) == (150, 50, 80, 80)
    assert (count["family"], count["semi-real"], count["spread"]) == (80, 40, 150)
    part = Plan(share=0.1, engines=names).slots(key)
    assert {slot.stratum for slot in part} == set(count)
    assert {slot.cause for slot in part if slot.stratum == "goal"} == set(effects)
    assert len(part) < 0.2 * len(slots)


def test_other_physics_is_no_effect_s_own_doing() -> None:
    """The plants take nothing from the library of effects, nor from the fast room."""
    folder = Path(__file__).parents[2] / "plugins" / "waxstudy_trials" / "plant"
    text = "".join(path.read_text() for path in folder.glob("*.py"))
    assert "waxstudy_effects" not in text
    assert "waxstudy_paper" not in text
    assert ".apply(" not in text


@pytest.mark.skipif(bool(engine_of("measured-house").hindrance()), reason=engine_of("measured-house").hindrance())
def test_a_late_clock_shows_at_the_first_midnight_what_was_hours_before() -> None:
    """And not what comes days later, at the end of the record."""
    from waxstudy_trials.house import first_midnight, measured

    house, late = measured(), 12  # samples
    engine = engine_of("measured-house")
    scene = {**engine.draw(np.random.default_rng(1), ["late-clock"], 6), "first": 0}
    scene["causes"] = [{"name": "late-clock", "values": {"late_h": late * house.interval_s / 3600.0}}]
    start = first_midnight(house)
    true_C = house.values["air_temperature_C"].to_numpy(dtype=float)[start - late : start]
    np.testing.assert_array_equal(engine.make(scene).channels["air_C"][:late], true_C)


@pytest.mark.skipif(bool(engine_of("measured-house").hindrance()), reason=engine_of("measured-house").hindrance())
def test_the_measured_house_is_altered_by_what_is_said_and_nothing_else(tmp_path: Path) -> None:
    case = case_of("measured-house", ["supply-offset"], 2, days=6)
    staged, seen = recorded(case, tmp_path)
    offset_K = case.scene["causes"][0]["values"]["offset_K"]
    assert list(staged.without[0]) == ["supply_C"]
    np.testing.assert_allclose(staged.without[0]["supply_C"] - staged.channels["supply_C"], offset_K)
    assert len(seen.time) == 6 * 144
    assert not any("night" in warning for warning in seen.warnings)
    assert (seen.noise, seen.room_tolerance, seen.nominal) == ({}, 4.0, {})


def test_without_its_record_the_measured_house_says_what_is_missing(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv(DATA, str(tmp_path))
    assert "WAXSTUDY_DATA" in engine_of("measured-house").hindrance()
    assert "measured-house" not in available(is_judged=True)


def test_channels_that_a_cause_changes_are_channels_of_a_dataset() -> None:
    sources = {channel.source for channel in CHANNELS.values()}
    case = case_of("other-plant", ["let-by"], 4)
    staged = engine_of("other-plant").make(case.scene)
    assert set(staged.without[0]) <= sources
    assert "flow_L_h" in staged.without[0]
    assert "control_output" not in staged.without[0]


# --- engines of strangers ---------------------------------------------------------------------------


def stranger(place: Path, package: str, source: str, points: str) -> None:
    """Install a one-module package with entry points."""
    about = place / f"{package}-1.0.dist-info"
    about.mkdir(parents=True)
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text(points)
    (place / f"{package}.py").write_text(source)


@pytest.fixture
def broken(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A stranger's engine that fails when it is imported."""
    place = tmp_path / "strangers"
    stranger(place, "dear", "raise RuntimeError('no licence')", "[waxstudy.engines]\ndear = dear:Dear\n")
    monkeypatch.syspath_prepend(place)
    trial.installed_engines.cache_clear()
    yield
    trial.installed_engines.cache_clear()


@pytest.mark.usefixtures("broken")
def test_an_engine_that_cannot_be_loaded_is_told_and_left_out() -> None:
    assert "no licence" in left_out(is_judged=False)["dear"]
    assert set(available(is_judged=False)) >= {"fast-room", "other-plant"}
    assert "dear" not in engines()
    with pytest.raises(PluginError, match=r"engine 'dear' is broken: .*no licence"):
        engine_of("dear")


def test_two_baselines_of_one_name_are_refused(waxstudy: Waxstudy, tmp_path: Path) -> None:
    place = tmp_path / "strangers"
    stranger(place, "mine", "def rules(dataset): return {}", "[waxstudy.baselines]\nrules = mine:rules\n")
    asked = waxstudy("blind-test", "baseline", "rules", place, env={"PYTHONPATH": str(place)})
    assert (asked.returncode, "two baselines are called 'rules'" in asked.stderr) == (4, True)
