"""Claims about the reality behind a dataset: it is the case's own run, and its surroundings add up."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.synthetic.conftest import SETPOINT_C, Simulated
from waxstudy.simulation.run import prepare
from waxstudy.study.model import Study
from waxstudy.synthetic.simulate import RealityError, reality_loop, simulate
from waxstudy_paper.room.corner import describe

STEP_S = 5.0
PER_DAY = 17280


def test_it_lasts_the_days_asked_for_from_the_first_of_the_week(simulated: Simulated, study: Study) -> None:
    reality = simulated("O_WM")
    assert {len(values) for values in reality.week.channels.values()} == {2 * PER_DAY}
    assert reality.first_day == prepare(study).driven["january"].weather.first_day


def test_it_is_the_case_s_own_loop_under_the_week_s_weather(study: Study) -> None:
    """The day put before is one more of the warm-up; a loop's record of that day is left out."""
    loop = reality_loop(study, study.cases["O_WM"], ["january"], 2)
    (week,) = loop.weeks(SETPOINT_C, prepare(study).starts[:1], trace=True)
    channels = simulate(loop, study, SETPOINT_C).week.channels
    assert np.array_equal(channels["air_C"], week.trace[PER_DAY:, 0])
    weather = prepare(study).driven["january"].weather
    assert np.array_equal(channels["outdoor_C"][::720], weather.outdoor_C[:48])


def test_the_reading_of_an_ideal_chain_is_the_air(simulated: Simulated) -> None:
    channels = simulated("O_CP").week.channels
    assert channels["reading_C"] == pytest.approx(channels["air_C"], abs=1e-9)


def test_a_delayed_reading_is_the_air_of_then_from_the_first_sample_on(simulated: Simulated) -> None:
    channels = simulated("O_D").week.channels
    reading, air = channels["reading_C"], channels["air_C"]
    assert reading[120:] == pytest.approx(air[:-120], abs=1e-9)
    assert np.ptp(reading[:120]) > 0.0  # the day before has filled its memory


def test_the_controller_acts_on_the_reading_of_the_step_before(simulated: Simulated) -> None:
    """On/Off with a full width of 0.5 K switches where the reading leaves the dead band, and nowhere else."""
    channels = simulated("O_D").week.channels
    output, below_K = channels["output"], SETPOINT_C - channels["reading_C"]
    on = np.flatnonzero(np.diff(output) > 0.0)
    off = np.flatnonzero(np.diff(output) < 0.0)
    assert len(on) >= 2
    assert all(below_K[on] >= 0.25)
    assert all(below_K[on - 1] < 0.25)
    assert all(below_K[off] <= -0.25)
    assert all(below_K[off - 1] > -0.25)


def test_the_sun_s_heat_is_what_the_windows_let_in(study: Study, simulated: Simulated) -> None:
    room = describe(study.room.parameters)  # type: ignore[arg-type]
    weather = prepare(study).driven["january"].weather
    names = dict(zip(("south", "west"), weather.irradiance_W_m2, strict=True))
    windows = {window.name.split()[0]: window for window in room.windows}
    expected_W = sum(windows[s].area_m2 * windows[s].g * weather.irradiance_W_m2[names[s]] for s in names)
    solar_W = simulated("O_CP").week.channels["solar_gain_W"][::720]
    assert solar_W == pytest.approx(expected_W[:48], rel=2e-3, abs=1e-9)
    assert solar_W.max() > 5.0


def test_the_internal_gains_have_the_daily_mean_of_the_room(simulated: Simulated) -> None:
    assert simulated("O_CP").week.channels["internal_gain_W"].mean() == pytest.approx(4.0 * 10.4, rel=1e-3)


def test_weeks_follow_each_other_in_one_record(study: Study) -> None:
    loop = reality_loop(study, study.cases["O_CP"], ["january", "february"], None)
    channels = simulate(loop, study, SETPOINT_C).week.channels
    driven = prepare(study).driven
    outdoor = np.concatenate([driven[week].weather.outdoor_C for week in ("january", "february")])
    assert np.array_equal(channels["outdoor_C"][::720], outdoor)
    seam = slice(7 * PER_DAY - 1, 7 * PER_DAY + 1)
    assert abs(np.diff(channels["air_C"][seam])[0]) < 0.01


def test_weeks_of_different_intervals_do_not_follow_each_other(study: Study) -> None:
    january = study.weeks["january"]
    quarters = replace(january, parameters=january.parameters.model_copy(update={"interval_s": 900.0}))
    mixed = replace(study, weeks={"january": january, "quarters": quarters})
    with pytest.raises(RealityError, match="weather of different intervals"):
        reality_loop(mixed, study.cases["O_0"], ["january", "quarters"], None)


def test_more_days_than_the_weather_has_are_refused(study: Study) -> None:
    with pytest.raises(RealityError, match="the weather lasts 7 days, less than 8"):
        reality_loop(study, study.cases["O_0"], ["january"], 8)
