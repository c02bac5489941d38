"""Claims about heat that a room stores: what a week's water heat is worth without it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

from waxstudy.plugin import FloatArray
from waxstudy.plugin.registry import installed
from waxstudy.results.kpis import Figures
from waxstudy.simulation import ensemble, kernel
from waxstudy.simulation.engine import DAY_S, SLAB_ABOVE_K, WARM_UP_DAYS, Loop
from waxstudy.simulation.modes import DrivenRoom
from waxstudy.simulation.run import loop_of, member_week, prepare
from waxstudy.study.model import Study
from waxstudy.study.read import read_study

ROOT = Path(__file__).parents[2]
SETPOINT_C = 21.0
NEVER = np.zeros(1, dtype=np.int64)
HEAT = kernel.TRACE.index("water_heat_W")


@pytest.fixture(scope="module")
def study() -> Study:
    return read_study(ROOT / "studies" / "table5.toml", installed())


def loops(study: Study, week: str, *cases: str) -> list[Loop]:
    plan = prepare(study)
    found = [loop_of(study, study.cases[case], plan.driven[week]) for case in cases]
    assert all(isinstance(loop, Loop) for loop in found)
    return found  # type: ignore[return-value]


@pytest.mark.parametrize("week", ["january", "february"])
def test_corrected_heat_hardly_hangs_on_the_start_where_the_water_s_heat_does(study: Study, week: str) -> None:
    starts = ensemble.starts(study.ensemble.model_copy(update={"members": 20}))
    (loop,) = loops(study, week, "O_WM")
    rows = []
    for start in starts:
        figures = Figures()
        for part in loop.parts(SETPOINT_C, start, 10_000, NEVER):
            figures.add(member_week(loop, part, SETPOINT_C, study))
        rows.append(figures.key_figures())
    raw, corrected = (np.array([row[f"heat_{name}kWh_m2_week"] for row in rows]) for name in ("", "corrected_"))
    assert np.std(raw) / np.mean(raw) > 0.003
    assert np.std(corrected) < 0.25 * np.std(raw)
    assert np.mean(corrected) == pytest.approx(np.mean(raw), rel=0.02)


@pytest.mark.slow
@pytest.mark.parametrize("case", ["O_0", "P_CP"])
def test_corrected_heat_is_what_losses_took_less_gains(study: Study, case: str) -> None:
    """The room is run again, node by node, from the water's heat alone: the balance of its week closes to 0.1 %."""
    (loop,) = loops(study, "january", case)
    driven, room = loop.driven, loop.driven.room
    state, week = loop.start(SETPOINT_C), np.arange(len(driven.supply_C))
    warming = np.tile(week[: round(DAY_S / driven.weather.interval_s)], WARM_UP_DAYS)
    warm = loop.advance(state, warming, -WARM_UP_DAYS * DAY_S, SETPOINT_C, trace=True)[1]
    before = state.modes.copy()
    trace = loop.advance(state, week, 0.0, SETPOINT_C, trace=True)[1]
    heat_J = float(trace[:, HEAT].sum()) * driven.step_s
    corrected_J = heat_J - float(driven.stored_J @ (state.modes - before))

    nodes = SETPOINT_C + SLAB_ABOVE_K * (1.0 - room.air_nodes)
    nodes, _ = node_by_node(driven, nodes, warming, warm[:, HEAT])
    _, net_loss_J = node_by_node(driven, nodes, week, trace[:, HEAT])
    assert corrected_J == pytest.approx(net_loss_J, rel=0.001)
    assert heat_J != pytest.approx(net_loss_J, rel=0.001)


def node_by_node(
    driven: DrivenRoom, nodes: FloatArray, intervals: FloatArray, heat_W: FloatArray
) -> tuple[FloatArray, float]:
    """Return the temperatures of all nodes after some intervals, and the losses less the inputs' heat by then [J]."""
    room, step_s = driven.room, driven.step_s
    rates = room.conductance_W_K / room.capacity_J_K[:, None]
    decay = expm(-rates * step_s)
    gain = np.linalg.solve(rates, np.eye(len(nodes)) - decay) / room.capacity_J_K
    from_inputs_W = room.drive(driven.weather)[0][intervals] @ room.input_matrix.T
    leaving_W_K, loss_J = room.conductance_W_K.sum(axis=0), 0.0
    for given_W, of_interval_W in zip(from_inputs_W, heat_W.reshape(len(intervals), -1), strict=True):
        for water_W in of_interval_W:
            later = decay @ nodes + gain @ (given_W + room.floor_heat_share * water_W)
            loss_J += step_s * float(leaving_W_K @ (nodes + later) / 2.0 - given_W.sum())
            nodes = later
    return nodes, loss_J
