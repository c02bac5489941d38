"""Long samples hide pulses: what they show of a switch is a share of time, and only a room can be judged by it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.diagnosis.realities import belief, dataset, effects, plain, rows, with_effects
from tests.diagnosis.test_remains import segment_at
from waxstudy.dataset.interval import coarser
from waxstudy.dataset.levels import as_levels
from waxstudy.dataset.notes import Notes
from waxstudy.diagnosis.diagnose import record_of
from waxstudy.diagnosis.model.segments import FLOW, Segment, segments
from waxstudy.diagnosis.model.shares import hidden_pulses
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.select.testability import too_short
from waxstudy.plugin import Belief, Choice, FloatArray
from waxstudy_paper.actuators import VariableTimes
from waxstudy_paper.modulators import Pwm
from waxstudy_paper.valves import LinearValve

OUTPUT = np.repeat([0.0, 0.3, 0.7, 1.0], 12)


def logged(interval_s: float, signal: FloatArray = OUTPUT) -> Record:
    return plain({"control_output": OUTPUT, "heating_signal": signal, "displacement": signal}, interval_s)


def chain() -> Belief:
    blocks = {"modulator": Choice.of(Pwm, {}), "actuator": Choice.of(VariableTimes, {})}
    return Belief({**blocks, "valve": Choice.of(LinearValve, {})})


@pytest.mark.parametrize(
    ("interval_s", "signal", "without", "hidden"),
    [
        (3600.0, OUTPUT, "", {"heating_signal", "displacement"}),
        (600.0, OUTPUT, "", {"heating_signal", "displacement"}),
        (300.0, OUTPUT, "", set()),  # as short as a stroke
        (3600.0, np.round(OUTPUT), "", set()),  # on or off
        (3600.0, OUTPUT, "modulator", set()),  # nobody says that it switches
    ],
)
def test_pulses_are_hidden_where_long_samples_show_a_signal_between_off_and_on(
    interval_s: float, signal: FloatArray, without: str, hidden: set[str]
) -> None:
    believed = chain()
    blocks = {kind: block for kind, block in believed.blocks.items() if kind != without}
    assert hidden_pulses(logged(interval_s, signal), replace(believed, blocks=blocks)) == hidden


def test_links_of_hidden_pulses_are_not_judged_and_the_room_is() -> None:
    whole = dataset(rows("PWM", days=6), "PWM")
    hourly = coarser(whole, 3600.0, are_means=True)
    hourly = replace(hourly, values=as_levels(hourly.values, hourly.nominal, Notes("")))
    seen = record_of(hourly)
    believed = belief("PWM", seen)
    cut = segments(seen, believed)
    reasons = {each.name: too_short(each, seen, believed) for each in cut if not each.is_supply}
    told = "was logged as means of 60 min, which hide its pulses; samples of a minute show them"
    assert {name: reason.split()[0] for name, reason in reasons.items() if reason.endswith(told)} == {
        "modulator": "heating_signal",
        "actuator": "heating_signal",
        "valve": "displacement",
    }
    assert reasons["emitter+room"] == ""
    assert reasons[segment_at("controller", cut).name] == ""


@pytest.mark.parametrize("let_by", [0.0, 0.1])
def test_flow_by_a_hidden_signal_is_shared_between_that_of_a_shut_and_of_an_open_valve(let_by: float) -> None:
    believed = with_effects(chain(), effects(let_by={"fraction": let_by}) if let_by else ())
    link = Segment(("actuator", "valve"), "heating_signal", (FLOW,), by_shares=True)
    record = plain({"heating_signal": OUTPUT, FLOW: 100.0 * OUTPUT}, 3600.0)
    flow = link.predict(record, believed)[FLOW]
    full = flow[OUTPUT == 1.0][0]
    assert flow[OUTPUT == 0.0] == pytest.approx(let_by * full, abs=1e-6)
    assert flow == pytest.approx(full * (let_by + (1.0 - let_by) * OUTPUT))
