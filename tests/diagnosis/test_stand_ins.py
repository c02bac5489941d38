"""Claims about rooms that something drives which nobody recorded: it is never taken for nothing."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.diagnosis.realities import EFFECTS, belief, dataset, effects, estimator, rows, study
from waxstudy.dataset.stand_ins import FIELDS, GAINS, SUN, own_gains_W, why_dark
from waxstudy.dataset.sunlight import (
    DIFFUSE,
    GLOBAL,
    PANELS,
    PANELS_YIELD,
    _on_facade,
    _sky,
    clear_sky_W,
    recorded_sun_W,
)
from waxstudy.dataset.tables import Site
from waxstudy.diagnosis.criteria import Question, limit
from waxstudy.diagnosis.diagnose import diagnose, record_of
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.model.as_built import AsBuilt, knobs
from waxstudy.diagnosis.model.edits import Edits
from waxstudy.diagnosis.model.nuisance import Nuisance, habits, nuisances, of_record
from waxstudy.diagnosis.model.room_response import built
from waxstudy.diagnosis.model.segments import segments
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.select.search import select
from waxstudy.diagnosis.select.unexplained import done_by_drives, unexplained
from waxstudy.plugin import Belief, Choice, Effect, Facade, Room, changed
from waxstudy_paper.weather import sun as weather_sun

TALLINN = Site(latitude=59.4, longitude=24.7, timezone="Europe/Tallinn")
DAYS = 4


@pytest.mark.slow
@pytest.mark.parametrize("without", [(SUN,), (SUN, GAINS)])
def test_a_healthy_room_whose_sun_or_gains_nobody_recorded_is_no_gap_without_a_cause(without: tuple[str, ...]) -> None:
    said = diagnose(dataset(rows("REAL", DAYS, without=without), "REAL"), quick=True)
    assert (said.verdict, list(said.effects)) == ("none", [])
    assert [each.what for each in said.next_measurements[: len(without)]] == [f"record {name}" for name in without]
    for name in without:
        assert any(sentence.startswith(f"{name} was not recorded") for sentence in said.assumptions)


def test_a_record_with_all_drives_has_nothing_in_their_place() -> None:
    assert record_of(dataset(rows("REAL", DAYS), "REAL")).stand_ins == {}


def test_the_gains_of_the_believed_room_stand_in_for_gains_that_nobody_recorded() -> None:
    data = rows("REAL", DAYS)
    seen = record_of(dataset(data.drop(columns=GAINS), "REAL"))
    assert seen.inputs.gains_W == pytest.approx(data[GAINS].to_numpy(), abs=0.1)
    assert seen.inputs.stand_ins == {"gains_W"}


def test_a_healthy_record_tells_the_next_one_of_the_hours_at_which_people_heat_a_room() -> None:
    before, later = (record_of(dataset(rows("REAL", days, without=(GAINS,)), "REAL")) for days in (DAYS, DAYS - 1))
    known = list(habits(before))
    departures, covariance = np.linspace(-1.0, 1.0, len(known)), np.diag(np.linspace(0.1, 0.2, len(known)))
    there = AsBuilt(tuple(known), departures, covariance).seen_in(later)
    documented = belief("REAL", later)
    believed = there.believed(documented)
    assert documented.inputs
    assert believed.inputs
    own_W, shapes = documented.inputs.gains_W, later.stand_ins[GAINS].shapes
    hours_W = sum(at * each.heat_W for at, each in zip(departures[1:], shapes, strict=True))
    assert believed.inputs.gains_W == pytest.approx(np.exp(departures[0]) * own_W + hours_W)
    room = next(each for each in segments(later, believed) if each.with_room and not each.is_supply)
    problem = SegmentProblem(room, later, documented, as_built=there)
    unknowns = problem.nuisances
    assert [each.name for each in unknowns[: len(known)]] == [each.name for each in known]
    assert [each.sd for each in unknowns[: len(known)]] == pytest.approx(np.diag(covariance) ** 0.5)
    assert not {each.name for each in known} & {each.name for each in unknowns[len(known) :]}
    further = problem.edited((), np.array([0.3, *np.zeros(len(unknowns) - 1)])).inputs  # on from where the factor is
    assert further
    assert further.gains_W == pytest.approx(np.exp(departures[0] + 0.3) * own_W + hours_W)


def test_a_later_record_departs_from_the_documents_and_not_on_top_of_how_a_room_was_built() -> None:
    """An edit on top of another is not both at once: above the pipes lies most already, and little is left to move."""
    seen = record_of(dataset(rows("REAL", DAYS), "REAL"))
    documented = with_pipes(belief("REAL", seen))
    room = next(each for each in segments(seen, documented) if each.with_room and not each.is_supply)
    once = {each.name for each in of_record(documented, seen, room.driven_by)}
    lasting = tuple(each for each in nuisances(documented, seen, room.driven_by) if each.name not in once)
    sd = np.array([each.sd for each in lasting])
    (valve,) = (each for each in knobs([EFFECTS["max-flow"]], ["valve"], documented))
    known = AsBuilt(lasting, 2.0 * sd, np.diag(sd**2), chain=((valve, np.log(0.4)),))
    problem = SegmentProblem(room, seen, documented, as_built=known)
    assert problem.belief.room == problem.edited((), np.zeros(len(problem.sd))).room != documented.room
    as_drawn = problem.edited((), np.concatenate((-2.0 * sd, np.zeros(len(once)))))
    assert as_drawn.room == known.with_chain(documented).room
    further = problem.edited((), np.concatenate((sd, np.zeros(len(once)))))
    assert further.room == replace(known, departures=3.0 * sd).believed(documented).room


def with_pipes(believed: Belief) -> Belief:
    """The same with a floor that takes up heat by the resistances of its pipes, which the flow changes."""
    assert believed.room
    assert issubclass(believed.room.component, Room)
    edited = believed.room.component.uncertainties(believed.room.parameters)[0].apply(believed.room, 1e-9)
    about: Any = edited.parameters
    return replace(
        believed, room=Choice(edited.component, changed(about, circuit=changed(about.circuit, exchange="pipe")))
    )


def test_departures_come_to_the_same_whatever_was_asked_before() -> None:
    seen = record_of(dataset(rows("REAL", DAYS, without=(GAINS,)), "REAL"))
    believed = belief("REAL", seen)
    room = next(each for each in segments(seen, believed) if each.with_room and not each.is_supply)
    problem = SegmentProblem(room, seen, believed)
    assert {each.is_of_inputs for each in problem.nuisances} == {True, False}
    values: dict[type[Effect], dict[str, float]] = {
        EFFECTS["thermal-mass"]: {"factor": 2.0},
        EFFECTS["solar-factor"]: {"factor": 1.5},
    }
    some = 0.1 * problem.sd
    moved = [some + step for step in np.diag(0.5 * problem.sd)]
    for departures in (some, *moved, np.zeros(len(some)), *moved[::-1]):
        for edits in ((), tuple(values.items())):
            absorbed = {name for effect, _ in edits for name in effect.absorbs}
            expected = believed
            for nuisance, departure in zip(problem.nuisances, departures.tolist(), strict=True):
                expected = nuisance.apply(expected, 0.0 if nuisance.name in absorbed else departure)
            for effect, parameters in edits:
                expected = effect.apply(expected, effect.Parameters(**parameters))
            found = problem.edited(edits, departures)
            assert (found.blocks, found.room) == (expected.blocks, expected.room)
            assert found.inputs
            assert expected.inputs
            for field in fields(found.inputs):
                assert np.array_equal(getattr(found.inputs, field.name), getattr(expected.inputs, field.name))


def test_a_record_with_gains_needs_no_habits_of_a_healthy_one_without() -> None:
    known = list(habits(record_of(dataset(rows("REAL", DAYS, without=(GAINS,)), "REAL"))))
    other = Nuisance("other", 1.0, lambda believed, departure: believed)
    as_built = AsBuilt((known[0], other, *known[1:]), np.arange(len(known) + 1.0), np.eye(len(known) + 1))
    there = as_built.seen_in(record_of(dataset(rows("REAL", DAYS), "REAL")))
    assert (there.knobs, there.departures.tolist(), there.covariance.tolist()) == ((other,), [1.0], [[1.0]])


@pytest.mark.parametrize("put_in", [{}, {"gain_shift": {"shift_h": 2.0, "factor": 1.5}}])
def test_what_heat_adds_by_itself_is_what_a_room_makes_of_it_beside_all_else(put_in: dict[str, Any]) -> None:
    """An effect may move it; the first day is repeated with it."""
    problem = without_sun_and_gains()
    there = departed(problem, [(EFFECTS[name], dict(values)) for name, values in effects(**put_in)])
    found = problem.added_heat_slopes(there, range(len(problem.sd)))
    shapes = {shape.name for each in problem.record.stand_ins.values() for shape in each.shapes}
    assert {problem.nuisances[place].name for place in found} == shapes
    for place in list(found)[::3]:
        departures = there.departures.copy()
        departures[place] += 0.1 * problem.sd[place]
        moved = problem.at(there.effects, departures, there.convention)
        assert moved
        slope = (moved.whitened - there.whitened) / (0.1 * problem.sd[place])
        assert found[place] == pytest.approx(slope, abs=1e-4 * np.abs(slope).max())


def without_sun_and_gains() -> SegmentProblem:
    seen = record_of(dataset(rows("REAL", DAYS, without=(SUN, GAINS)), "REAL"))
    believed = belief("REAL", seen)
    room = next(each for each in segments(seen, believed) if each.with_room and not each.is_supply)
    return SegmentProblem(room, seen, believed)


def departed(problem: SegmentProblem, edits: Edits) -> Hypothesis:
    found = problem.at(edits, np.linspace(-0.5, 0.5, len(problem.sd)) * problem.sd, problem.conventions[0])
    assert found
    return found


def test_heat_that_an_effect_takes_the_place_of_has_no_slope_and_what_becomes_of_it_otherwise_is_not_its_own() -> None:
    problem = without_sun_and_gains()
    shape = next(each for each in problem.nuisances if each.is_added_heat)
    extra = EFFECTS["extra-heat"]
    values = {"heat_W": 20.0, "radiant_share": 0.0}

    class Instead(extra):  # type: ignore[valid-type,misc]
        absorbs = (shape.name,)

    class Vented(extra):  # type: ignore[valid-type,misc]
        """A part of the gains leaves with the air."""

        @classmethod
        def apply(cls, belief: Belief, p: Any) -> Belief:
            assert belief.inputs
            warmer_C = belief.inputs.outdoor_C + 0.01 * belief.inputs.gains_W
            return replace(belief, inputs=replace(belief.inputs, outdoor_C=warmer_C))

    place = problem.nuisances.index(shape)
    (slope,) = problem.added_heat_slopes(departed(problem, [(Instead, values)]), [place]).values()
    assert (slope == 0.0).all()
    gains = [n for n, each in enumerate(problem.nuisances) if each.is_added_heat and each.name.startswith("gains")]
    assert gains
    assert problem.added_heat_slopes(departed(problem, [(Vented, values)]), gains) == {}


@pytest.mark.parametrize(("before", "later"), [((), (GAINS,)), ((GAINS,), ())])
def test_what_a_healthy_record_cannot_tell_of_gains_is_as_unknown_as_without_it(
    before: tuple[str, ...], later: tuple[str, ...]
) -> None:
    healthy, seen = (record_of(dataset(rows("REAL", DAYS, without=each), "REAL")) for each in (before, later))
    believed = belief("REAL", seen)
    room = next(each for each in segments(seen, believed) if each.with_room and not each.is_supply)
    known = nuisances(belief("REAL", healthy), healthy, "flow_L_h")
    there = AsBuilt(tuple(known), np.zeros(len(known)), np.eye(len(known))).seen_in(seen)
    alone = {each.name: each.sd for each in nuisances(believed, seen, "flow_L_h")}
    unknowns = SegmentProblem(room, seen, believed, as_built=there).nuisances
    told = {each.name: each.sd for each in unknowns}
    of_gains = {name: sd for name, sd in alone.items() if "gains" in name}
    assert of_gains
    assert {name: told.get(name) for name in of_gains} == of_gains


def test_of_a_record_without_what_drives_a_room_a_healthy_one_tells_nothing() -> None:
    healthy = record_of(dataset(rows("REAL", DAYS), "REAL"))
    known = nuisances(belief("REAL", healthy), healthy, "flow_L_h")
    as_built = AsBuilt(tuple(known), np.ones(len(known)), np.eye(len(known)))
    seen = record_of(dataset(rows("REAL", DAYS, without=("outdoor_temperature_C",)), "REAL"))
    assert as_built.seen_in(seen).knobs == ()


def test_no_factor_is_claimed_of_what_only_stands_in() -> None:
    site = replace(dataset(rows("REAL", DAYS, without=(SUN, GAINS)), "REAL"), site=TALLINN)
    seen = record_of(site)
    believed = belief("REAL", seen)
    assert believed.inputs
    assert believed.inputs.solar_W.any()
    for name in ("solar-factor", "gain-shift"):
        assert EFFECTS[name].hindrance(believed)


def test_a_gap_beyond_what_a_missing_sun_could_make_is_a_finding() -> None:
    """The floor's surface reads 3 K too warm at night: no sun does that."""
    data = rows("REAL", DAYS, without=(SUN,))
    night = pd.DatetimeIndex(data["time"]).hour < 6
    data.loc[night, "floor_surface_temperature_C"] += 3.0
    seen = record_of(dataset(data, "REAL"))
    believed = belief("REAL", seen)
    segment = next(each for each in segments(seen, believed) if each.with_room)
    selection = select(estimator(segment, seen, believed, 0.2), [], 1, lambda name: None)
    floor = selection.after.residual_of("floor_surface_temperature_C")
    most = limit(Question.EXCUSED, "of_drives")
    assert floor.gap() > most * done_by_drives(selection, floor) > 0.0
    assert any(each.is_finding for each in unexplained(selection, 1) if each.channel == floor.channel)


@pytest.mark.parametrize(
    ("place", "rise_h", "set_h"), [(None, 9.5, 14.5), (None, 8.0, 16.0), (None, 7.0, 17.0), (TALLINN, 10.0, 14.5)]
)
@pytest.mark.parametrize("field", ["", "gains_W", "extra_W"])
def test_an_unrecorded_sun_may_shine_at_any_hours_of_the_season_and_fall_anywhere(
    field: str, place: Site | None, rise_h: float, set_h: float
) -> None:
    """Also on a short winter's day, each strength within what is usual."""
    data = rows("REAL", DAYS, without=(SUN,))
    shapes = record_of(dataset(data, "REAL", site=place)).stand_ins[SUN].shapes
    shapes = [each for each in shapes if each.field in {field, field or FIELDS[SUN]}]
    time = pd.DatetimeIndex(data["time"])
    hour = time.hour.to_numpy() + time.minute.to_numpy() / 60.0
    sun_W = 400.0 * np.sin(np.pi * np.clip((hour - rise_h) / (set_h - rise_h), 0.0, 1.0))
    ways = np.transpose([each.heat_W * each.sd for each in shapes])
    strength = np.linalg.lstsq(ways, sun_W, rcond=None)[0]
    assert np.std(sun_W - ways @ strength) < 0.2 * np.std(sun_W)
    assert np.abs(strength).max() < 2.0


# --- the sun of a clear sky ------------------------------------------------------------------------------


def clear_W(site: Site, day: str = "2023-03-20") -> np.ndarray:
    time = pd.date_range(day, periods=96, freq="15min") + pd.Timedelta("15min")
    return clear_sky_W(built(study().room), time, 900.0, site)


@given(latitude=st.floats(-60.0, 60.0))
def test_a_clear_sky_shines_by_day_and_never_at_night(latitude: float) -> None:
    sun_W = clear_W(Site(latitude=latitude))
    assert (sun_W >= 0.0).all()
    assert not sun_W[:20].any()
    assert not sun_W[-20:].any()
    assert sun_W[40:56].min() > 0.0


@pytest.mark.parametrize("timezone", ["Europe/Tallinn", None])
def test_the_sun_of_a_site_is_that_of_its_clock(timezone: str | None) -> None:
    """Windows to south and west: the heat's middle lies after noon, which comes at 12.35 h there."""
    sun_W = clear_W(Site(latitude=59.4, longitude=24.7, timezone=timezone))
    middle_h = float(np.sum(sun_W * (np.arange(96) + 0.5) / 4.0) / np.sum(sun_W))
    assert 12.4 < middle_h < 14.5


def test_a_room_without_gains_has_none_of_its_own() -> None:
    room = built(study().room)
    hour = np.arange(24.0)
    assert own_gains_W(room, hour).mean() > 0.0


# --- the sun by light that was recorded ------------------------------------------------------------------

HERE = Site(latitude=59.4, longitude=24.7, timezone="Europe/Tallinn", panels_peak_W=5000.0)


def level_W_m2(day: str = "2023-03-20") -> tuple[pd.DatetimeIndex, np.ndarray]:
    """Return the light of a clear day on level ground."""
    time = pd.date_range(day, periods=96, freq="15min") + pd.Timedelta("15min")
    sky = _sky(time, 900.0, HERE)
    return time, sky.global_W_m2


def sun_of(light: dict[str, np.ndarray], time: pd.DatetimeIndex) -> np.ndarray:
    return recorded_sun_W(built(study().room), time, 900.0, HERE, light)


def test_the_light_of_a_clear_day_gives_the_room_a_clear_sky() -> None:
    """Within a fifth: a clear sky of pvlib has less diffuse light than that of Erbs."""
    time, light = level_W_m2()
    found, clear = sun_of({GLOBAL: light}, time), clear_sky_W(built(study().room), time, 900.0, HERE)
    assert found.sum() == pytest.approx(clear.sum(), rel=0.2)
    assert not found[:20].any()


def test_a_night_of_winter_that_lasts_all_day_has_no_sun() -> None:
    time = pd.date_range("2023-12-20", periods=96, freq="15min")
    there = Site(latitude=78.0, longitude=15.0)
    room = built(study().room)
    assert not recorded_sun_W(room, time, 900.0, there, {GLOBAL: np.zeros(96)}).any()
    assert not clear_sky_W(room, time, 900.0, there).any()


def test_half_the_light_gives_less_than_half_of_the_sun_through_upright_windows() -> None:
    time, light = level_W_m2()
    assert sun_of({GLOBAL: 0.5 * light}, time).sum() < 0.5 * sun_of({GLOBAL: light}, time).sum()


def test_light_that_is_known_to_be_diffuse_comes_from_everywhere() -> None:
    time, light = level_W_m2()
    assert sun_of({GLOBAL: light, DIFFUSE: light}, time).sum() < 0.7 * sun_of({GLOBAL: light}, time).sum()


def test_panels_that_lie_level_tell_what_a_pyranometer_does() -> None:
    time, light = level_W_m2()
    site = HERE.model_copy(update={"panels_tilt_deg": 0.0})
    power_W = light * PANELS_YIELD * 5.0
    found = recorded_sun_W(built(study().room), time, 900.0, site, {PANELS: power_W})
    assert found.sum() == pytest.approx(sun_of({GLOBAL: light}, time).sum(), rel=0.1)  # two models of diffuse light


def test_a_schedule_of_shading_goes_by_the_clock_wherever_the_record_begins() -> None:
    component = study().room.component
    shaded = component.build(component.Parameters(shading={"passes": 0.0, "above_W_m2": 0.0, "from_hour": 12.0}))
    time, light = level_W_m2()
    whole = recorded_sun_W(shaded, time, 900.0, HERE, {GLOBAL: light})
    late = recorded_sun_W(shaded, time[24:], 900.0, HERE, {GLOBAL: light[24:]})
    assert whole[:48].any()
    assert not whole[48:].any()
    assert late == pytest.approx(whole[24:], abs=1.0)


@pytest.mark.parametrize("panes", [0, 2, 3])
@pytest.mark.parametrize("azimuth_deg", [90.0, 180.0])
def test_a_facade_gets_what_a_weather_gives_it(panes: int, azimuth_deg: float) -> None:
    time, _ = level_W_m2()
    sky, facade = _sky(time, 900.0, HERE), Facade(azimuth_deg, panes=panes)
    found = _on_facade(facade, sky, (sky.global_W_m2, sky.diffuse_W_m2, sky.direct_W_m2), "perez-driesse")
    light = weather_sun.Sky(sky.direct_W_m2, sky.diffuse_W_m2, sky.global_W_m2)
    there = weather_sun.Sun(sky.zenith_deg, sky.azimuth_deg, sky.extra_W_m2)
    assert found == pytest.approx(weather_sun.on_facade(facade, there, light, 0.2), abs=1e-6)


def test_hours_whose_diffuse_light_is_lost_have_the_share_that_their_light_tells() -> None:
    time, light = level_W_m2()
    lost = np.full(96, np.nan)
    assert sun_of({GLOBAL: light, DIFFUSE: lost}, time) == pytest.approx(sun_of({GLOBAL: light}, time))


def test_a_gap_in_the_light_is_bridged_by_the_hours_beside_it() -> None:
    time, light = level_W_m2()
    gap = light.copy()
    gap[44:52] = np.nan
    assert sun_of({GLOBAL: gap}, time).sum() == pytest.approx(sun_of({GLOBAL: light}, time).sum(), rel=0.05)


@pytest.mark.parametrize(
    ("light", "stated", "spread"), [(GLOBAL, {}, 0.2), (PANELS, {}, 0.3), (GLOBAL, {SUN: 0.5}, 0.5)]
)
def test_the_sun_by_recorded_light_is_uncertain_by_as_much_as_is_said(
    light: str, stated: dict[str, float], spread: float
) -> None:
    seen = dataset(rows("REAL", DAYS, without=(SUN,)), "REAL")
    values = seen.values.assign(**{light: np.where(seen.time.hour.isin(range(10, 15)), 100.0, 0.0)})
    record = record_of(replace(seen, values=values, site=HERE, spreads=stated))
    found = record.stand_ins[SUN]
    assert found.factor_sd == spread
    assert found.values.any()
    assert f"the sun that {light} tells" in found.sentence
    assert f"{spread:.0%}" in found.sentence
    assert record.inputs.stand_ins == {"solar_W"}


@pytest.mark.parametrize(
    ("site", "why"), [(None, "latitude"), (Site(latitude=59.4), "longitude"), (TALLINN, "panels_peak_W")]
)
def test_light_that_tells_nothing_of_the_sun_is_said(site: Site | None, why: str) -> None:
    assert why in why_dark([PANELS], site)
    assert not why_dark([PANELS, SUN], site)
    assert not why_dark([PANELS], HERE)
