"""Records as loggers and other people's engines make them: each is odd in one way, and none of it is an effect."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from tests.diagnosis.realities import PERFECT, Effects, belief, dataset, effects, planted, rows, study
from waxstudy.dataset.read import Dataset
from waxstudy.diagnosis.diagnose import diagnose, record_of
from waxstudy.diagnosis.model.segments import segments
from waxstudy.diagnosis.select.testability import too_short
from waxstudy.plugin import Belief

DAYS = 7
ROOM = ("supply_temperature_C", "return_temperature_C", "outdoor_temperature_C", "operative_temperature_C")


def scanned(setpoint_changes: bool = False) -> pd.DataFrame:
    """An on-off loop whose controller decides at the start of each minute; everything is logged at its end."""
    random = np.random.default_rng(1)
    air_C, floor_C, is_on = 20.5, 22.0, 0.0
    logged = []
    for minute in range(DAYS * 1440):
        hour = minute / 60.0 % 24.0
        setpoint_C = 19.0 if setpoint_changes and not 6.0 <= hour < 22.0 else 21.0
        if abs(setpoint_C - air_C) > 0.25:
            is_on = float(setpoint_C > air_C)
        outdoor_C = 5.0 * np.sin(2.0 * np.pi * (hour - 9.0) / 24.0) + 2.0 * np.sin(minute / 3000.0)
        floor_C += is_on * (34.0 - floor_C) / 60.0 + (air_C - floor_C) / 40.0
        air_C += (floor_C - air_C) / 90.0 + (outdoor_C - air_C) / 900.0
        logged.append((round(air_C + random.normal(0.0, 0.03), 2), setpoint_C, is_on))
    time = pd.date_range("2020-01-06T00:01", periods=len(logged), freq="min")
    columns = pd.DataFrame(logged, columns=["sensor_temperature_C", "setpoint_C", "control_output"])
    return pd.concat([pd.Series(time, name="time"), columns], axis=1)


def of_chain(data: pd.DataFrame, case: str, *kinds: str) -> Dataset:
    """A record of which some blocks of a case are believed, and no room."""
    blocks = study().cases[case].blocks
    return replace(dataset(data, case), nominal={kind: blocks[kind] for kind in kinds}, room=None)


def test_a_controller_that_decides_once_a_sample_has_no_delay() -> None:
    diagnosis = diagnose(of_chain(scanned(), "IDEAL", "controller"), quick=True)
    assert (diagnosis.verdict, list(diagnosis.effects)) == ("none", [])
    assert any("once a sample" in sentence for sentence in diagnosis.assumptions)


def test_a_setpoint_that_is_logged_when_it_changes_holds_until_the_next() -> None:
    data = scanned(setpoint_changes=True)
    whole = record_of(of_chain(data, "IDEAL", "controller"))
    data.loc[data["setpoint_C"].diff() == 0.0, "setpoint_C"] = np.nan
    held = record_of(of_chain(data, "IDEAL", "controller"))
    np.testing.assert_array_equal(held.filled("setpoint_C"), whole.filled("setpoint_C"))


def test_without_a_setpoint_what_lies_behind_the_controller_is_still_judged() -> None:
    data = rows("WAX", days=DAYS).drop(columns=[*ROOM, "setpoint_C"], errors="ignore")
    diagnosis = diagnose(replace(dataset(data, "WAX"), setpoint_C=None, room=None), quick=True)
    assert diagnosis.verdict == "none"
    assert {gap.stage for gap in diagnosis.stages} >= {"actuator", "valve"}


def test_a_motor_on_a_bench_needs_no_room_and_no_controller() -> None:
    data = rows("WAX", days=DAYS)[["time", "heating_signal", "displacement"]]
    diagnosis = diagnose(of_chain(data, "IDEAL", "valve"), quick=True)
    assert [effect.name for effect in diagnosis.effects] == ["wax-motor"]
    assert {gap.stage for gap in diagnosis.stages} == {"actuator"}


def test_a_wax_motor_behind_an_output_that_runs_on_is_judged_by_its_gap_alone() -> None:
    """No switch of a signal tells how far a real motor may stray."""
    output = rows("PI", days=DAYS)[["time", "control_output"]]
    far = output.assign(displacement=(np.arange(len(output)) // 137 % 2).astype(float))
    diagnosis = diagnose(of_chain(far, "WAX", "actuator"), quick=True)
    assert "modulator+actuator" in {each.stage for each in diagnosis.unexplained if each.is_finding}


def test_a_return_that_is_blank_without_flow_does_not_hide_the_room() -> None:
    data = rows("REAL", days=DAYS)
    seen = record_of(
        dataset(data.assign(return_temperature_C=data["return_temperature_C"].where(data["flow_L_h"] > 0)), "REAL")
    )
    believed = dataset(data, "REAL")
    expected = Belief(believed.nominal, believed.room, seen.inputs)
    found = segments(seen, expected)
    assert [too_short(segment, seen, expected) for segment in found if segment.with_room] == [""]


def test_stated_noise_is_never_less_than_the_rounding() -> None:
    coarse = rows("REAL", days=DAYS)
    coarse["sensor_temperature_C"] = (2.0 * coarse["sensor_temperature_C"]).round() / 2.0
    seen = record_of(replace(dataset(coarse, "REAL"), noise={"sensor_temperature_C": 0.01}))
    assert seen.noise["sensor_temperature_C"] == pytest.approx(0.5 * 12.0**-0.5)


def test_an_opening_that_is_only_seen_open_or_closed_is_not_rounded() -> None:
    whole = rows("REAL", days=DAYS, **PERFECT)
    data = whole.assign(displacement=whole["displacement"].round())
    seen = record_of(replace(dataset(data, "REAL"), noise={"displacement": 0.01}))
    assert seen.noise["displacement"] == 0.01


def test_what_is_not_measured_is_no_figure_of_the_loop() -> None:
    data = rows("REAL", days=DAYS).drop(columns=["flow_L_h", "displacement", "return_temperature_C"])
    diagnosis = diagnose(dataset(data, "REAL"), quick=True)
    assert "air_mean_C" in diagnosis.closed_loop
    assert "cycles_per_day" not in diagnosis.closed_loop
    assert all({"heat_percent", "air_K"} == set(gap["impact"]) for gap in diagnosis.described()["stages"])


def of_room(days: int, true: Effects, **channels: np.ndarray | float) -> Dataset:
    """A room in which some effects happen under other inputs than a real loop had; flow and channels of it only."""
    data = rows("REAL", days=days)
    seen = record_of(dataset(data, "REAL"))
    driven = replace(
        seen, values={**seen.values, **{name: each * np.ones(len(seen)) for name, each in channels.items()}}
    )
    believed = belief("REAL", driven)
    segment = next(each for each in segments(driven, believed) if each.with_room)
    made = pd.DataFrame({"time": data["time"], **planted(segment, driven, believed, true).values})
    return replace(dataset(made, "REAL"), nominal={})


def test_what_only_the_last_days_show_is_looked_for_in_them_too_and_said_to_be_so() -> None:
    days = 7
    minute = np.arange(days * 1440)
    sun_W = np.where((minute > 4 * 1440) & (minute % 1440 > 540) & (minute % 1440 < 960), 400.0, 0.0)
    lit = of_room(days, effects(solar_factor={"factor": 0.5}), solar_gain_W=sun_W)
    diagnosis = diagnose(lit, quick=True)
    assert [effect.name for effect in diagnosis.effects] == ["solar-factor"]
    assert diagnosis.effects[0].parameters["factor"].value == pytest.approx(0.5, rel=0.1)
    assert not diagnosis.effects[0].is_held_out
    assert set(diagnosis.parts) == {"fit", "select"}  # in turn, as of a room alone
    assert any("solar-factor shows in the last days only" in warning for warning in diagnosis.warnings)


@pytest.mark.parametrize(
    ("setpoint_C", "signal", "is_judged"), [(10.0, 0.0, True), (40.0, 0.0, False), (10.0, 1.0, False)]
)
def test_a_room_that_needs_no_heat_is_judged_without_and_one_that_does_is_not(
    setpoint_C: float, signal: float, is_judged: bool
) -> None:
    """Where it is too cold, or its valve opens, a flow that is always nothing may be a dead meter."""
    chain = dict.fromkeys(("control_output", "heating_signal", "displacement"), signal)
    heated = effects(extra_heat={"heat_W": 150.0})
    warm = of_room(DAYS, heated, flow_L_h=0.0, setpoint_C=setpoint_C, **chain)
    diagnosis = diagnose(warm, quick=True)
    untestable = [each.name for each in diagnosis.untestable if each.reason.endswith("never changes in this record")]
    assert ([each.name for each in diagnosis.effects], "extra-heat" in untestable) == (
        (["extra-heat"], False) if is_judged else ([], True)
    )


def test_a_flow_that_stands_still_is_no_drive_of_a_room() -> None:
    diagnosis = diagnose(of_room(DAYS, (), flow_L_h=50.0), quick=True)
    reasons = {each.name: each.reason for each in diagnosis.untestable}
    assert reasons["infiltration"] == "flow_L_h never changes in this record"
