"""Claims about pairs: a house as it was built, a healthy record of it and a later one; made, solved and scored."""

from __future__ import annotations

import hashlib
import json
import shutil
import sys
import tomllib
from dataclasses import replace
from datetime import date, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.blind_test.conftest import DATA, NONE, answering
from tests.conftest import ROOT, Waxstudy
from waxstudy.blind_test.box import BOX_BYTES, OVERHEAD_BYTES, close_box, open_box
from waxstudy.blind_test.draw import BUILT_SETS, NO_SUN, Case, Measured, drawn
from waxstudy.blind_test.key import Key, canonical
from waxstudy.blind_test.make import Place, begun, make
from waxstudy.blind_test.plan import DRAW, Plan, Slot
from waxstudy.blind_test.record import FILES, PAGE_BYTES, WIDTH, without_noise
from waxstudy.blind_test.shrinkage import true_shrinkage
from waxstudy.blind_test.truth import Size, sizes, told
from waxstudy.dataset.read import read_dataset
from waxstudy.plugin.trial import Staged, engine_of, engines
from waxstudy_trials.as_built import BASELINE_DAYS, EVERY_DAY, SCATTER, Scatter, as_built
from waxstudy_trials.energyplus.description import House
from waxstudy_trials.energyplus.description import built as built_house
from waxstudy_trials.plant.description import Plant
from waxstudy_trials.plant.description import built as built_plant
from waxstudy_trials.plant.people import lived_in
from waxstudy_trials.plant.weather import weather
from waxstudy_trials.when import when

PAIRED = ("energyplus-room", "other-plant", "thin-floor-plant")
KEY = Key(11, 32 * "d")  # no secret
STRATA = ("built-null", "built-pair")
STAMP = len("2021-01-01T00:01:00")
DRAWN_BEFORE = "68ae3ff8c5fa8fb4d1e26f9e27737dc7022925307a310a30291437021542170a"
LOOK = """\
import json, pathlib, sys
folder = pathlib.Path(sys.argv[-1])
seen = sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))
text = (folder / "dataset.toml").read_text()
posterior = {"none": 0.7, "unknown": 0.3}
print(json.dumps({"verdict": "none", "seen": seen, "says": "[baseline]" in text, "posterior": posterior}))
"""


@pytest.fixture(scope="module")
def finished_pairs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a null and a pair of effects, each with its baseline, in `test`, and their key; not to change."""
    folder = tmp_path_factory.mktemp("pairs")
    (folder / "key").write_text(f"{KEY}\n")
    place, plan = Place(folder / "test"), Plan(share=0.01, strata=STRATA, engines=("other-plant",))
    with begun(place, plan, KEY):
        make(place, plan, KEY, 2, lambda *said: None)
    return folder


@pytest.fixture
def place(finished_pairs: Path, tmp_path: Path) -> Place:
    """A copy of the pairs, which may be solved."""
    shutil.copy(finished_pairs / "key", tmp_path / "key")
    return Place(shutil.copytree(finished_pairs / "test", tmp_path / "test"))


def boxes(place: Place) -> dict[str, Any]:
    return {name: open_box(KEY, name, place.box(name).read_bytes()) for name in place.names()}


# --- the house as it was built ---------------------------------------------------------------------


def test_every_number_that_strays_says_why_and_how_far() -> None:
    random = np.random.default_rng(1)
    for name, scatter in {**SCATTER, **EVERY_DAY}.items():
        found = np.array([scatter.drawn(random) for _ in range(4000)])
        assert scatter.reason
        assert scatter.unit
        middle, spread = _middle_and_spread(scatter, found)
        assert middle == pytest.approx(0.0, abs=0.1 * scatter.spread), name
        assert spread == pytest.approx(scatter.spread, rel=0.1), name


def test_the_table_of_the_documentation_is_that_of_the_code() -> None:
    page = (ROOT / "docs" / "blind_test_houses.md").read_text()
    for scatter in SCATTER.values():
        (row,) = (line for line in page.splitlines() if line.endswith(f"| {scatter.reason} |"))
        assert f"{scatter.spread:g}" in row


def _middle_and_spread(scatter: Scatter, found: Any) -> tuple[float, float]:
    if scatter.way == "even":
        return float(found.min()), float(found.max())
    values = np.log(found) if scatter.way == "factor" else found
    return float(np.median(values)), float(values.std())


@pytest.mark.parametrize(("as_drawn", "built"), [(House(product="B"), built_house), (Plant(), built_plant)])
def test_a_house_as_built_differs_in_all_that_is_said_and_without_it_in_nothing(as_drawn: Any, built: Any) -> None:
    found = as_built(np.random.default_rng(2))
    assert built(as_drawn, None) is as_drawn
    differs = {name for name in as_drawn._fields if getattr(built(as_drawn, found), name) != getattr(as_drawn, name)}
    gains = {"gains", "gains_later_h"} if isinstance(as_drawn, Plant) else set()  # of a plant these are in its weather
    assert len(differs) == len(SCATTER) - len(gains)


@pytest.mark.parametrize("engine", PAIRED)
def test_a_cause_is_added_to_the_house_as_built_and_takes_nothing_of_it_away(engine: str) -> None:
    """Whatever a cause sets, a cover, an offset or a mass, the house's own stays beside it."""
    plain, built = (Plant(), built_plant) if "plant" in engine else (House(product="B"), built_house)
    own, bias = as_built(np.random.default_rng(3)), "bias_K"
    wrong = plain._replace(bias_K=0.5, supply_K=-1.0, cover_m2K_W=0.1, mass=1.5)
    assert getattr(built(wrong, own), bias) == pytest.approx(0.5 + own["room_sensor_K"])
    assert built(wrong, own).supply_K == pytest.approx(-1.0 - own["supply_sensor_K"])
    assert built(wrong, own).cover_m2K_W == pytest.approx(0.1 + own["cover_m2K_W"])
    assert built(wrong, own).mass == pytest.approx(1.5 * own["mass"])


def test_people_live_differently_every_day_and_as_much_on_the_whole() -> None:
    assumed = weather(np.random.default_rng(1), 60, -3.0, 60.0, 6.0)
    days = lived_in(assumed, 7).gains_W.reshape(60, -1).mean(axis=1)
    assert len(np.unique(days.round(3))) > 50
    assert days.mean() == pytest.approx(60.0, rel=0.1)
    np.testing.assert_array_equal(lived_in(assumed, 7).gains_W, lived_in(assumed, 7).gains_W)
    assert not np.array_equal(lived_in(assumed, 7).gains_W, lived_in(assumed, 8).gains_W)


# --- the draw --------------------------------------------------------------------------------------


def pair(engine: str, kind: Any = "single", cause: str = "max-flow", index: int = 4) -> Case:
    return drawn(KEY, Slot("built-single", engine, kind, cause, has_baseline=True), index, 0, is_judged=True)


@pytest.mark.parametrize("engine", PAIRED)
def test_the_baseline_is_the_same_house_on_whole_days_before_the_record_without_a_cause(engine: str) -> None:
    for index in range(20):
        case = pair(engine, index=index)
        before = engine_of(engine).baseline_of(case.scene)
        assert before is not None
        assert case.baseline is not None
        assert before["causes"] == []
        assert BASELINE_DAYS[0] <= before["days"] == case.baseline.days <= BASELINE_DAYS[1]
        assert before["day"] + before["days"] + 3 < case.scene["day"]  # nor does its warm-up reach into it
        assert before["seed"] != case.scene["seed"]
        assert case.baseline.seed != case.measured.seed
        own = [name for name in case.scene if name not in ("days", "day", "seed", "outdoor_C", "causes", "baseline")]
        assert {name: before[name] for name in own} == {name: case.scene[name] for name in own}
        assert {"as_built", "setpoint_C", "gains_W"} <= set(own)
        assert (case.baseline.channels, case.baseline.interval_s) == (case.measured.channels, case.measured.interval_s)


@pytest.mark.parametrize("engine", PAIRED)
def test_a_null_is_the_same_pair_without_its_cause(engine: str) -> None:
    single, null = pair(engine), pair(engine, kind="null")
    assert null.measured == single.measured
    assert null.baseline == single.baseline
    assert {**single.scene, "causes": []} == null.scene


def test_most_pairs_have_all_channels_and_some_neither_sun_nor_gains() -> None:
    found = [pair("other-plant", index=index).measured for index in range(300)]
    assert 0.6 < np.mean([each.channels == "all" for each in found]) < 0.8
    assert {each.channels for each in found} == set(BUILT_SETS)
    lacking = next(each for each in found if each.channels == NO_SUN)
    assert {"solar_gain_W", "internal_gain_W"} <= set(lacking.instruments().without)


def test_earlier_keys_draw_what_they_did_before() -> None:
    """The digest was made once the setpoint was an effect; what is added must leave the draws of a key alone."""
    plan = Plan(
        strata=("other-null", "other-single", "other-pair", "family", "spread"),
        engines=("other-plant", "thin-floor-plant", "energyplus-room"),  # no library of effects can change these
    )
    found = hashlib.sha256()
    for index, slot in enumerate(plan.slots(key := Key(5, 32 * "b"))):
        try:
            found.update(canonical(drawn(key, slot, index, 0, is_judged=True).described()))
        except ValueError:
            found.update(b"-")
    assert found.hexdigest() == DRAWN_BEFORE


def test_the_strata_of_pairs_and_a_share_of_them() -> None:
    slots = [slot for slot in Plan(engines=PAIRED).slots(KEY) if slot.has_baseline]
    count = {name: sum(slot.stratum == name for slot in slots) for name in {slot.stratum for slot in slots}}
    assert count == {"built-null": 60, "built-single": 120, "built-pair": 40, "built-family": 40}
    assert {slot.engine for slot in slots} == set(PAIRED) == {n for n, e in engines().items() if e.has_baselines}
    part = Plan(share=0.2, strata=("built-null",), engines=PAIRED).slots(KEY)
    assert len(part) == 12


def test_a_share_has_as_much_of_each_engine_and_causes_that_the_key_draws() -> None:
    def part(key: Key, draw: int = DRAW) -> list[Slot]:
        return Plan(share=0.2, strata=("built-single", "other-single"), engines=PAIRED, draw=draw).slots(key)

    for stratum, many in (("built-single", 8), ("other-single", 6)):
        engines_of = [slot.engine for slot in part(KEY) if slot.stratum == stratum]
        assert {engine: engines_of.count(engine) for engine in PAIRED} == dict.fromkeys(PAIRED, many)
    other = Key(12, 32 * "e")
    assert {slot.cause for slot in part(KEY)} != {slot.cause for slot in part(other)}
    assert sum(slot.engine == "thin-floor-plant" for slot in part(KEY, draw=2)) < 6  # as it was


@pytest.mark.slow
@pytest.mark.parametrize("built_K", [0.0, 0.2, -0.2])
def test_a_change_is_as_large_however_far_the_house_was_off_before(built_K: float) -> None:
    engine = engine_of("other-plant")
    scene = engine.draw_built(np.random.default_rng(3), ["sensor-bias"], 4)
    scene["as_built"] = {**scene["as_built"], "room_sensor_K": built_K}
    scene["causes"] = [{"name": "sensor-bias", "values": {"bias_K": 0.3}}]
    staged, measured = engine.make(scene), Measured("all", 60.0, 4, 1.0, 0.0, 5)
    case = Case("x", "built-single", "single", "other-plant", 0, measured, scene, measured)
    (size,) = sizes(case, staged, without_noise(staged, measured))
    assert size
    assert size.gap == pytest.approx(0.3, rel=0.1)
    assert size.beyond == pytest.approx(size.over, rel=0.1)
    assert size.alike == ()
    box = {**case.described(), "causes": [{"size": {"channel": "sensor_temperature_C"}}]}
    assert true_shrinkage("x", box, "sensor-bias", {"bias_K": 0.3}) == pytest.approx(1.0, abs=0.01)
    assert true_shrinkage("x", box, "sensor-bias", {"bias_K": 0.15}) == pytest.approx(0.75, abs=0.05)


@pytest.mark.slow
def test_a_valve_held_wide_open_is_alike_with_a_large_leak_whatever_the_cause_calls_its_values() -> None:
    """Both are the same flow; of a valve of another form even the effect of the cause's name leaves more than noise."""
    engine = engine_of("thin-floor-plant")
    scene = engine.draw_built(np.random.default_rng(4), ["stuck-open"], 3)
    scene["causes"] = [{"name": "stuck-open", "values": {"lifted": 0.16}}]
    scene["plant"] = {**scene["plant"], "coupling": 0.2}  # other circuits make its flow vary
    staged, measured = engine.make(scene), Measured("all", 60.0, 3, 1.0, 0.0, 5)
    case = Case("x", "built-single", "single", engine.name, 0, measured, scene, measured)
    bare = replace(case, scene={name: value for name, value in scene.items() if name != "baseline"}, baseline=None)
    for each in (case, bare):
        (size,) = sizes(each, staged, without_noise(staged, measured))
        assert size
        assert size.over > 30.0
        assert size.alike == ("let-by",)


# --- when a cause acts -----------------------------------------------------------------------------

HOUR_S = 3600.0
TWO_DAYS = {"outdoor_C": np.repeat([-5.0, 1.0], 24), "solar_gain_W": np.tile([0.0] * 10 + [300.0] * 4 + [0.0] * 10, 2)}


@pytest.mark.parametrize(
    ("name", "values", "spans"),
    [
        ("setpoint-offset", {"from_h": 22.0, "to_h": 6.0}, [(0.0, 6.0), (22.0, 30.0), (46.0, 48.0)]),
        ("setpoint-offset", {"from_h": 0.0, "to_h": 24.0}, [(0.0, 48.0)]),
        ("weak-at-night", {"less": 0.5}, [(17.0, 23.0), (41.0, 47.0)]),
        ("window-opening", {"from_h": 23.0, "hours": 2.0}, [(0.0, 1.0), (23.0, 25.0), (47.0, 48.0)]),
        ("window-opening", {"from_h": 23.0, "to_h": 1.0}, [(0.0, 1.0), (23.0, 25.0), (47.0, 48.0)]),
        ("stove", {"heat_W": 500.0}, [(18.0, 22.0)]),
        ("cold-ventilation", {"flow_W_K": 5.0}, [(0.0, 24.0)]),
        ("air-lock", {"less": 0.5}, [(24.0, 48.0)]),
        ("sunlit-sensor", {"K_kW": 2.0}, [(10.0, 14.0), (34.0, 38.0)]),
        ("sunlit-sensor", {"peak_K": 2.0}, [(13.0, 17.0), (37.0, 41.0)]),
        ("max-flow", {"factor": 0.5}, None),
    ],
)
def test_what_comes_and_goes_has_its_hours(name: str, values: dict[str, float], spans: Any) -> None:
    assert when(name, values, TWO_DAYS, HOUR_S) == spans


def test_a_pump_pauses_twelve_times_a_day() -> None:
    spans = when("pump-pauses", {"pause_s": 600.0}, {"outdoor_C": np.zeros(8640)}, 10.0)
    assert spans is not None
    assert spans[:2] == [(0.0, 0.167), (2.0, 2.167)]
    assert len(spans) == 12


def test_every_cause_with_a_time_of_its_own_is_one_of_an_engine() -> None:
    from waxstudy_trials.when import ACTS

    assert set(ACTS) <= {cause.name for engine in engines().values() for cause in engine.causes()}


def test_the_longest_truth_fits_its_box() -> None:
    """A pump that pauses every second hour of thirteen days has the most spans."""
    case = pair("other-plant", "family", "pump-pauses")
    spans = [(2.0 * n, 2.0 * n + 0.667) for n in range(12 * 13)]
    staged = Staged({}, 10.0, "", {}, [None], [{}], when=[spans])
    size = Size("valve", "flow_L_h", 1.0, 1.0, 1.0, tuple(f"an-effect-{n}" for n in range(25)))
    box = close_box(KEY, case.name, {**told(case, staged, [size]), "files": 64 * "a"})
    assert len(box) == BOX_BYTES + OVERHEAD_BYTES


# --- make, solve, score ----------------------------------------------------------------------------


def test_a_record_lies_beside_its_baseline_and_both_can_be_read(finished_pairs: Path) -> None:
    place = Place(finished_pairs / "test")
    for name, box in boxes(place).items():
        later = read_dataset(place.record(name))
        assert later.baseline == place.record(name) / "baseline"
        before = read_dataset(later.baseline)
        assert before.baseline is None
        assert list(before.values.columns) == list(later.values.columns)
        assert before.interval_s == later.interval_s == box["measured"]["interval_s"]
        assert (before.nominal, before.room, before.noise) == (later.nominal, later.room, later.noise)
        assert before.time[-1].date() + timedelta(days=3) < later.time[0].date()
        assert (before.time[0].date() - date(2022, 1, 1)).days > 0
        assert len(before.time) * before.interval_s == 86_400 * box["baseline"]["days"]


def test_files_of_a_pair_tell_no_more_by_their_times_and_sizes_than_those_of_one_record(finished_pairs: Path) -> None:
    place = Place(finished_pairs / "test")
    files = [path for folder in place.records.iterdir() for path in (folder, *folder.rglob("*"))]
    assert len({path.stat().st_mtime for path in files}) == 1
    tables = [path for path in files if path.name == "dataset.toml"]
    assert {path.stat().st_size for path in tables} == {PAGE_BYTES}
    for path in (path for path in files if path.name == "data.csv"):
        header, *rows = path.read_text().splitlines()
        assert {len(row) for row in rows} == {STAMP + (len(header.split(",")) - 1) * (WIDTH + 1)}
    assert {place.box(name).stat().st_size for name in place.names()} == {BOX_BYTES + OVERHEAD_BYTES}


def test_the_documents_state_what_was_drawn_and_not_what_was_built(finished_pairs: Path) -> None:
    place = Place(finished_pairs / "test")
    base = engine_of("other-plant").base  # type: ignore[attr-defined]
    for name in place.names():
        tables = [place.record(name) / part for part in ("dataset.toml", "baseline/dataset.toml")]
        later, before = (tomllib.loads(path.read_text()) for path in tables)
        assert later.pop("baseline") == {"path": "baseline"}
        assert later == before
        assert later["building"]["wall_U_W_m2K"] == base.wall_U_W_m2K
        assert later["building"]["infiltration_L_s"] == base.leak_L_s


def test_the_truth_says_how_the_house_was_built_and_when_each_cause_acts(finished_pairs: Path) -> None:
    found = boxes(Place(finished_pairs / "test"))
    assert sorted(box["stratum"] for box in found.values()) == sorted(STRATA)
    for box in found.values():
        assert set(box["as_built"]) == set(SCATTER)
        for cause in box["causes"]:
            assert cause["size"]["gap"] > 0.0
            assert all(0.0 <= begin < end <= 24.0 * box["measured"]["days"] for begin, end in cause["when"])


def test_a_changed_baseline_is_told(place: Place, waxstudy: Waxstudy, tmp_path: Path) -> None:
    assert waxstudy("blind-test", "solve", "test", "--", *answering(tmp_path, NONE)).returncode == 0
    first = place.names()[0]
    data = place.record(first) / "baseline" / "data.csv"
    data.write_text(data.read_text().replace("1", "2", 1))
    done = waxstudy("blind-test", "score", "test", "--key-file", "key")
    assert done.returncode == 1
    assert f"{first}: its files are not those that were sealed" in done.stderr


def test_a_diagnoser_gets_the_baseline_or_on_request_none_and_both_are_scored(
    place: Place, waxstudy: Waxstudy, tmp_path: Path
) -> None:
    (tmp_path / "look.py").write_text(LOOK)
    command = ("blind-test", "solve", "test", "--name", "mine")
    for more in ((), ("--without-baselines",)):
        assert waxstudy(*command, *more, "--", sys.executable, "look.py").returncode == 0
    for who, is_there in (("mine", True), ("mine-without-baselines", False)):
        paths = [place.folder / "answers" / who / f"{name}.json" for name in place.names()]
        said = [json.loads(path.read_text())["answer"] for path in paths]
        files = sorted([*FILES, "baseline", *(f"baseline/{name}" for name in FILES)]) if is_there else sorted(FILES)
        assert [(each["seen"], each["says"]) for each in said] == [(files, is_there)] * len(STRATA)
    done = waxstudy("blind-test", "score", "test", "--key-file", "key", "--json")
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)["diagnosers"]
    assert set(told) == {"mine", "mine-without-baselines"}
    (found,) = told["mine"]["posterior"].values()
    # of the null 0.3^2 + 0.3^2, of the pair 0.7^2 + 0.3^2 + 1
    assert found["brier"]["value"] == pytest.approx(0.5 * (0.18 + 1.58))
    assert [each["count"] for each in found["every"]] == [0, 2, 0, 2, 0]
    goals = {goal["name"]: goal for goal in told["mine"]["goals"] if goal["where"] == "as built, with a baseline"}
    assert goals["false alarms on nulls"]["of"] == 1
    assert all(goal["value"] is None for goal in told["mine"]["goals"] if goal["where"] == "other physics")
    shown = waxstudy("blind-test", "score", "test", "--key-file", "key").stdout
    assert "probabilities of 2 answers" in shown


def test_without_baselines_there_is_nothing_to_leave_out(small_test: Path, waxstudy: Waxstudy) -> None:
    done = waxstudy("blind-test", "solve", small_test, "--without-baselines", "--", sys.executable)
    assert (done.returncode, "no record has a baseline" in done.stderr) == (2, True)


@pytest.mark.slow
@pytest.mark.parametrize("engine", PAIRED)
def test_the_house_as_built_moves_the_record_more_than_its_noise_and_a_cause_on_top_of_it(engine: str) -> None:
    if hindrance := engine_of(engine).hindrance():
        pytest.skip(f"{hindrance}; {DATA}")
    case = pair(engine, cause="floor-cover")
    short = {**case.scene, "days": 3}
    bare = {**short, "as_built": {name: float(SCATTER[name].way == "factor") for name in SCATTER}}
    staged, as_drawn, healthy = (engine_of(engine).make(scene) for scene in (short, bare, {**short, "causes": []}))
    assert np.abs(staged.channels["floor_surface_C"] - as_drawn.channels["floor_surface_C"]).max() > 0.1
    assert set(staged.without[0]) >= {"floor_surface_C", "air_C"}
    assert not np.array_equal(staged.channels["air_C"], healthy.channels["air_C"])
    assert staged.described == healthy.described == as_drawn.described
