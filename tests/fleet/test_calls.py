"""Claims about calls: loops answer as their actuators do, and without a call they are what a run gives."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from tests.fleet.conftest import FLEET, study
from waxstudy.api.activating import activate
from waxstudy.fleet.course import Course, copied
from waxstudy.fleet.draw import Blocks, members
from waxstudy.fleet.folder import BATCHES
from waxstudy.fleet.prepare import prepared
from waxstudy.fleet.response import response
from waxstudy.fleet.result import Activated
from waxstudy.report.activation import activation
from waxstudy.simulation.chain import Chain
from waxstudy.simulation.engine import Loop
from waxstudy.study.model import Choice


def of_state(called: Activated, state: str) -> pd.DataFrame:
    loops = called.loops
    return loops[loops["state"] == state].set_index("loop")


def test_cold_loops_open_when_their_actuator_does_after_that_pause(called: Activated, tmp_path: Path) -> None:
    cold, blocks = of_state(called, "cold"), study(tmp_path).cases["P_WM"].blocks
    assert set(cold["actuator.product"]) == {"A", "B"}
    for product, rows in cold.groupby("actuator.product"):
        actuator = Choice.of(blocks["actuator"].component, {"product": product})
        alone = activation("alone", actuator, blocks["valve"], [113.0])  # closed for 113 to 120 min of the two hours
        assert np.allclose(rows["opening_s"], alone.opening_s[0], atol=10.0)
        assert np.allclose(rows["flow_s"], alone.flow_s[0], atol=10.0)
        assert (rows["opening_s"] > 300.0).all()


def test_pulses_and_a_word_ahead_bring_all_within_the_limit(called: Activated) -> None:
    for state in ("standby", "preheated"):
        assert (of_state(called, state)["opening_s"] <= 300.0).all()
    ahead = of_state(called, "cold")["opening_s"] - of_state(called, "preheated")["opening_s"]
    assert np.allclose(ahead, 120.0)


def test_states_have_the_same_loops_and_pauses(called: Activated) -> None:
    drawn = ["setpoint_C", "flow_share", "actuator.product", "room.window_g", "pause_s"]
    cold, standby = (of_state(called, state)[drawn] for state in ("cold", "standby"))
    pd.testing.assert_frame_equal(cold, standby)
    assert cold["setpoint_C"].nunique() == 10


def test_a_product_that_is_drawn_brings_its_times(tmp_path: Path) -> None:
    """Also in a study that was written out with all times of another product."""
    plain = study(tmp_path)
    resolved = study(tmp_path, FLEET.replace('product = "B" }', 'product = "B", fall_s = 123.0, hold_b_s = 58.0 }'))
    for each in (plain, resolved):
        blocks = [Blocks(each).of(each.cases["P_WM"], member)["actuator"] for member in members(each)]
        stated = {Choice.of(choice.component, {"product": choice.parameters.product}) for choice in blocks}  # type: ignore[attr-defined]
        assert {choice.parameters.fall_s for choice in blocks} == {180.0, 123.0}  # type: ignore[attr-defined]
        assert {repr(choice.described()) for choice in blocks} == {repr(choice.described()) for choice in stated}


@pytest.mark.parametrize(("jit", "step_s"), [(True, 10.0), (False, 60.0)])
def test_a_loop_left_to_itself_is_that_of_a_run_however_it_is_cut(tmp_path: Path, jit: bool, step_s: float) -> None:
    fleet = prepared(study(tmp_path, FLEET.replace("step_s = 10", f"step_s = {step_s}")))
    member, stop = fleet.members[0], np.zeros(1, dtype=np.int64)
    driven = fleet.driven(member, "january")
    blocks = fleet.blocks.of(fleet.study.cases["P_SB"], member)
    course = Course(blocks, driven, 21.3, 1.0, 0.0, jit, stop)
    state = course.warm(member.start)
    hour = round(3600.0 / step_s)
    cuts = (0, 7, hour - 1, hour, 3 * hour, 3 * hour + 20, 4 * hour)
    trace = np.concatenate([course.run(state, a, b) for a, b in pairwise(cuts)])
    week = next(Loop(Chain(blocks, step_s), driven, 21.0, jit).weeks(21.3, [member.start], trace=True))
    assert np.array_equal(trace, week.trace[: len(trace)])


def test_an_override_is_obeyed_at_once_and_leaves_the_controller_where_it_was(tmp_path: Path) -> None:
    fleet = prepared(study(tmp_path))
    member, stop = fleet.members[0], np.zeros(1, dtype=np.int64)
    blocks = fleet.blocks.of(fleet.study.cases["P_WM"], member)
    course = Course(blocks, fleet.driven(member, "january"), 21.3, 1.0, 0.0, True, stop)
    state = course.warm(member.start)
    kept = state.blocks[1].tobytes()
    for held in (1.0, 0.0, 1.0):  # each begins within a period of the modulation
        trace = course.run(copied(state), 100, 200, held)
        assert (trace[:, 6] == held).all()
    course.run(state, 100, 200, 1.0)
    assert state.blocks[1].tobytes() == kept


def test_no_loop_is_let_go_while_it_is_called(called: Activated, tmp_path: Path) -> None:
    """A period of the modulation that ends within the call begins again without a gap, wherever clocks stand."""
    fleet = prepared(study(tmp_path))
    for member in fleet.members:
        blocks = fleet.blocks.of(fleet.study.cases["P_WM"], member)
        course = Course(
            blocks, fleet.driven(member, "january"), 21.3, 1.0, member.clock_s, True, np.zeros(1, dtype=np.int64)
        )
        signal = course.run(course.warm(member.start), 0, 400, 1.0)[:, 6]
        assert signal.all()
    assert len({member.clock_s for member in fleet.members}) == 10


def test_what_a_fleet_takes_is_the_sum_of_its_loops(called: Activated) -> None:
    loops, fleet = called.loops, called.response
    for row in called.rows:
        now = fleet[(fleet["state"] == row.state) & fleet["added_W"].notna()]
        later = fleet[(fleet["state"] == row.state) & fleet["later_W"].notna()]
        of = loops[loops["state"] == row.state]
        assert len(now) == 90
        assert now["added_W"].sum() * 10.0 / 3600.0 == pytest.approx(of["added_Wh"].sum(), rel=1e-4)
        whole_Wh = of["added_Wh"].sum() + of["later_Wh"].sum()
        assert later["later_W"].sum() * 300.0 / 3600.0 == pytest.approx(whole_Wh, abs=0.1)
        assert (now["added_W_low"] <= now["added_W"]).all()
        assert (now["added_W"] <= now["added_W_high"]).all()
        assert row.loops_per_MW_electric.value == pytest.approx(3.0e6 / row.firm_W.value)


def test_bands_are_as_wide_as_the_scatter_of_a_mean(called: Activated) -> None:
    """95 % of means of ten lie within 1.96 standard errors, which the band of resampled fleets has to show."""
    batches = pd.read_parquet(next((called.folder / BATCHES).glob("*.parquet")))
    natural = batches[batches["state"] == "natural"]
    row = next(row for row in called.rows if row.state == "natural")
    error = natural["added_Wh"].std(ddof=0) / np.sqrt(len(natural))
    assert (row.added_Wh.high - row.added_Wh.low) / 2.0 == pytest.approx(1.96 * error, rel=0.2)


def test_a_fleet_that_is_switched_off_gives_its_heat_back(tmp_path: Path) -> None:
    text = FLEET.partition("[activation.state")[0].replace("[activation]", '[activation]\nsignal = "off"')
    text += '[activation.state.heated]\ncase = "P_WM"\npreheat_s = 1800\n'
    text += '[activation.state.off]\ncase = "P_WM"\npause_s = [7200]\n'
    text += '[activation.state.pulses]\ncase = "P_SB"\npause_s = [7200]\n'
    heated, off, pulses = activate(study(tmp_path, text), tmp_path / "out", workers=1).rows
    assert heated.opening_before == 1.0
    assert heated.added_Wh.value < -50.0 < 0.0 < heated.firm_W.value
    assert heated.slowest_s > 300.0  # product A holds and falls for seven minutes
    assert 0.0 < heated.opening_share.value < 1.0
    for idle in (off, pulses):  # nothing is to be had of loops that are off, and nothing is changed
        assert (idle.opening_share.value, idle.added_Wh.value, idle.later_Wh.value) == (1.0, 0.0, 0.0)
        assert np.isnan(idle.loops_per_MW_heat.value)


def test_a_response_does_not_depend_on_the_order_of_batches(called: Activated, tmp_path: Path) -> None:
    batches = pd.read_parquet(next((called.folder / BATCHES).glob("*.parquet")))
    call = study(tmp_path).activation.call  # type: ignore[union-attr]
    again = response(batches, call, 10.0)
    assert np.allclose(again["added_W"].dropna().sort_values(), called.response["added_W"].dropna().sort_values())
