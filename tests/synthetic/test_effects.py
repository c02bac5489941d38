"""Claims about realities with effects: what happens has them, and what is recorded as known does not."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.synthetic.conftest import SETPOINT_C, Simulated
from waxstudy.plugin import Belief, Choice, FloatArray
from waxstudy.plugin.registry import installed
from waxstudy.simulation.recorded import driven_by, respond
from waxstudy.study.model import Study
from waxstudy.synthetic.effects import EffectError, applied, believed_inputs, with_effects
from waxstudy.synthetic.instruments import Instruments
from waxstudy.synthetic.simulate import Reality, reality_loop
from waxstudy.synthetic.write import Telling, truth_beside, write

KNOWN = ("outdoor_C", "supply_C", "solar_gain_W", "internal_gain_W", "ventilation_supply_C", "setpoint_C")
STRONG: dict[str, dict[str, float]] = {
    "let-by": {"fraction": 0.1},
    "max-flow": {"factor": 0.5},
    "thermal-mass": {"factor": 3.0},
    "supply-offset": {"offset_K": 3.0},
    "pipe-delay": {"volume_L": 10.0},
    "solar-factor": {"factor": 3.0},
    "gain-shift": {"shift_h": 6.0, "factor": 2.0},
    "window-opening": {"flow_L_s": 15.0},
    "neighbour-heat": {"conductance_W_K": 12.0},
    "extra-heat": {"heat_W": 40.0, "radiant_share": 0.5},
}
OF_INPUTS = (
    "supply-offset",
    "pipe-delay",
    "solar-factor",
    "gain-shift",
    "window-opening",
    "neighbour-heat",
    "extra-heat",
)


def effect(name: str, **values: float) -> Choice:
    return Choice.of(installed().components["effect", name].component, values)


def happened(study: Study, *effects: Choice, case: str = "O_CP") -> Reality:
    return with_effects(study, study.cases[case], ["january"], 2, SETPOINT_C, effects)[1]


@pytest.mark.parametrize("name", STRONG)
def test_the_air_is_another_and_what_drives_the_room_is_recorded_as_believed(
    study: Study, simulated: Simulated, name: str
) -> None:
    true, believed = happened(study, effect(name, **STRONG[name])).week.channels, simulated("O_CP").week.channels
    assert set(true) == set(believed)
    assert np.max(np.abs(true["air_C"] - believed["air_C"])) > 0.05
    assert all(np.array_equal(true[channel], believed[channel]) for channel in KNOWN)


@pytest.mark.parametrize("name", OF_INPUTS)
def test_an_effect_of_no_size_changes_nothing(study: Study, simulated: Simulated, name: str) -> None:
    true, believed = happened(study, effect(name)).week.channels, simulated("O_CP").week.channels
    assert all(np.allclose(true[channel], believed[channel], rtol=0.0, atol=1e-9, equal_nan=True) for channel in true)


# A constant heat also moves the state from which a run starts, and the floor's part
# of that lasts for weeks: the two runs of `extra-heat` differ by it alone.
@pytest.mark.parametrize("name", [name for name in OF_INPUTS if name != "extra-heat"])
def test_the_room_under_the_recorded_flow_and_the_effect_does_what_happened(study: Study, name: str) -> None:
    """An effect on the room's air or flow is given those of the record here, which are its own."""
    loop = reality_loop(study, study.cases["O_CP"], ["january"], 2)
    inputs = believed_inputs(loop, SETPOINT_C)
    chosen, day = effect(name, **STRONG[name]), 1440
    week = happened(study, chosen).week.channels
    air_C, flow_L_h = with_first_day(week["air_C"][11::12]), with_first_day(week["flow_L_h"].reshape(-1, 12).mean(1))
    true = applied([chosen], Belief({}, study.room, replace(inputs, air_C=air_C, flow_L_h=flow_L_h)))
    assert true.inputs
    found = respond(driven_by(loop.driven.room, true.inputs), true.inputs, flow_L_h)["air_C"]
    assert np.max(np.abs(found[2 * day :] - air_C[2 * day :])) < 0.03


def with_first_day(values: FloatArray) -> FloatArray:
    return np.concatenate((values[:1440], values))


def test_the_circuit_gets_warmer_water_than_recorded(study: Study) -> None:
    """The heat that the water loses is that of the true supply."""
    water_J_L_K = reality_loop(study, study.cases["O_CP"], ["january"], 1).driven.room.water_J_L_K
    week = happened(study, effect("supply-offset", offset_K=2.0)).week.channels
    flowing = week["flow_L_h"] > 0.0
    heat_W = 10.4 * week["water_heat_W_m2"][flowing]
    stream_W_K = week["flow_L_h"][flowing] / 3600.0 * water_J_L_K
    assert week["supply_C"][flowing] - week["return_C"][flowing] == pytest.approx(heat_W / stream_W_K - 2.0)


def test_two_effects_are_both_there(study: Study) -> None:
    leak, late = effect("let-by", fraction=0.1), effect("sensor-delay", delay_s=900.0)
    case, reality = with_effects(study, study.cases["O_CP"], ["january"], 2, SETPOINT_C, [leak, late])
    assert set(case.blocks) == {"sensor", "controller", "valve"}
    channels = reality.week.channels
    assert channels["flow_L_h"].min() == pytest.approx(0.1 * channels["flow_L_h"].max())
    assert channels["reading_C"][180:] == pytest.approx(channels["air_C"][:-180], abs=1e-9)


def test_the_truth_names_the_effects_and_the_folder_does_not(tmp_path: Path, study: Study) -> None:
    said: list[dict[str, Any]] = []
    texts = set()
    for effects in ([], [effect("let-by", fraction=0.1)]):
        case, reality = with_effects(study, study.cases["O_CP"], ["january"], 1, SETPOINT_C, effects)
        folder = tmp_path / str(len(effects)) / "room-7"
        write(
            folder, Telling(study, case, study.cases["O_CP"], ["january"], SETPOINT_C, effects), reality, Instruments()
        )
        texts.add((folder / "dataset.toml").read_bytes())
        said.append(json.loads(truth_beside(folder).read_text(encoding="utf-8")))
    assert len(texts) == 1
    assert set(said[1]) - set(said[0]) == {"effects"}
    assert said[1]["effects"] == [{"name": "let-by", "parameters": {"fraction": 0.1}}]
    assert list(said[1]["differences"]) == ["valve"]


def test_an_outside_room_may_have_effects_in_its_chain_only(study: Study) -> None:
    outside = replace(study, room=Choice.of(installed().components["room", "nzeb-energyplus"].component, {}))
    belief = Belief(outside.cases["O_CP"].blocks, outside.room, believed_inputs(loop_of_two_days(study), SETPOINT_C))
    assert applied([effect("let-by", fraction=0.1)], belief).blocks != belief.blocks
    with pytest.raises(EffectError, match="room 'nzeb-energyplus' keeps to its own engine; take a fast room"):
        applied([effect("supply-offset", offset_K=1.0)], belief)


def loop_of_two_days(study: Study) -> Any:
    return reality_loop(study, study.cases["O_CP"], ["january"], 2)


def test_an_effect_that_cannot_be_says_why(study: Study) -> None:
    with pytest.raises(EffectError, match="effect 'pwm-period': no modulator with a period is believed"):
        happened(study, effect("pwm-period", period_s=1800.0))
