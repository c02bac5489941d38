"""The valve's curve comes back from a record of flow, with the authority given or fitted."""

from __future__ import annotations

import tomllib
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from waxstudy.identification import valve
from waxstudy.identification.description import Described
from waxstudy.identification.flow import FlowRecord, read_flow
from waxstudy.identification.models import Value
from waxstudy.identification.performance import block
from waxstudy.identification.valve import (
    BOUNDS,
    PACES,
    _at,
    _cycle_of,
    _delayed,
    _full_flow,
    _is_at_bound,
    _near,
    _notes,
    _openings,
    _polished,
    _Problem,
    _value,
    authority_of,
    curve,
    fit_valve,
)
from waxstudy.plugin import Choice
from waxstudy.rig.bench import Motors, run_trial
from waxstudy.rig.instruments import Bench
from waxstudy.rig.programme import table_a1
from waxstudy.study.problems import StudyError
from waxstudy_paper.valves import QuickOpeningValve

TRUE = {"h_min": 0.17, "h_mid": 0.41, "v_mid": 0.50, "authority": 2.9 / 30.0}
(FLOW,) = (trial for trial in table_a1() if trial.measured == "flow")


@pytest.fixture(scope="module")
def motor() -> Choice:
    return block("actuator", {"use": "variable-times", "product": "B"})


def written(path: Path, bench: Bench, seed: int = 1, hours: float = 6.0) -> FlowRecord:
    made = run_trial(
        Motors("variable-times", {}, "quick-opening", bench, seed), replace(FLOW, duration_min=60.0 * hours)
    )
    table = pd.DataFrame({"time_s": made.time_s, "flow_L_h": made.value, "signal_V": made.signal_V})
    table.to_csv(path, index=False)
    return read_flow(Described(path, "flow"))


@pytest.fixture(scope="module")
def record(tmp_path_factory: pytest.TempPathFactory) -> FlowRecord:
    """The paper's flow: its noise, and an exemplar that is not quite the product."""
    return written(tmp_path_factory.mktemp("flow") / "flow.csv", Bench())


# --- the parts of a fit, without one ------------------------------------------------------------------


def of_openings(authority: float | None = 0.1) -> _Problem:
    """Samples of two cycles, whose flow is the true curve's at the pace in the middle and no delay."""
    opening = np.concatenate((np.linspace(0.0, 1.0, 40), np.linspace(1.0, 0.0, 40)))
    openings = _delayed(np.array([np.clip(opening * pace, 0.0, 1.0) for pace in PACES]))
    flow = curve(opening, 0.17, 0.41, 0.5, 0.1)
    return _Problem(openings, flow, np.repeat([0, 1], 40), authority)


def test_the_true_curve_misses_nothing_and_every_other_one_something() -> None:
    problem, true = of_openings(), np.array([0.17, 0.41, 0.5, 1.0, 0.0])
    assert problem.error(true) == pytest.approx(0.0, abs=1e-12)
    assert of_openings(None).error([*true, 0.1]) == pytest.approx(0.0, abs=1e-12)
    for off in np.diag([0.02, 0.02, 0.02, 0.02, 0.1]):
        assert 1e-4 < problem.error(true + off) < 0.1
        assert 1e-4 < problem.error(true - off) < 0.1


def test_an_error_is_the_mean_over_the_openings_that_are_considered() -> None:
    problem = of_openings()
    opening, true = problem.openings[1, len(PACES) // 2], [0.17, 0.41, 0.5, 1.0, 0.0]
    inner = (opening > 0.05) & (opening < 0.95)
    missed = np.abs(curve(opening, 0.17, 0.41, 0.6, 0.1) - problem.flow)
    assert problem.error([0.17, 0.41, 0.6, 1.0, 0.0]) == pytest.approx(missed[inner].mean())
    last = problem.cycle.astype(float)
    weighed = problem.error([0.17, 0.41, 0.6, 1.0, 0.0], weight=last)
    assert weighed == pytest.approx(missed[inner & (problem.cycle == 1)].mean())
    assert problem.error(true, weight=0.0 * last) == 1.0  # nothing is known of it


@pytest.mark.parametrize(
    ("x", "over"),
    [
        ([0.05, 0.41, 0.5, 1.0, 0.0], 0.05),
        ([0.17, 1.2, 0.5, 1.0, 0.0], 0.2),
        ([0.17, 0.41, 0.5, 0.75, 0.7], 0.3),
        ([0.3, 0.2, 0.5, 1.0, 0.0], 0.11),  # a hundredth apart at least
        ([0.35, 0.41, 0.5, 1.0, 0.0], 0.05),
        ([0.17, 0.05, 0.5, 1.0, 0.0], 0.05 + 0.13),
        ([0.17, 0.41, -0.2, 1.0, 0.0], 0.2),
        ([0.17, 0.41, 1.3, 1.0, 0.0], 0.3),
        ([0.17, 0.41, 0.5, 1.25, 0.0], 0.1),
        ([0.17, 0.41, 0.5, 1.0, -0.6], 0.1),
    ],
)
def test_what_is_out_of_bounds_is_worse_the_farther_it_is(x: list[float], over: float) -> None:
    assert of_openings().error(x) == pytest.approx(1.0 + over)
    assert of_openings(None).error([*x, 1.25]) == pytest.approx(1.25 + over)
    assert of_openings(None).error([*x, 0.005]) == pytest.approx(1.005 + over)


@pytest.mark.parametrize("start", [[0.3, 0.2], [0.1, 0.9]])
def test_a_search_begins_within_the_bounds_and_ends_where_the_error_is_least(start: list[float]) -> None:
    names, asked = ("h_min", "h_mid"), list[np.ndarray]()

    def error(x: np.ndarray) -> float:
        asked.append(np.array(x))
        return float(np.abs(x - [0.17, 0.41]).sum())

    assert _polished(error, np.array(start), names) == pytest.approx([0.17, 0.41], abs=2e-4)
    steps = np.abs(np.array(asked[:3]) - start)
    assert steps == pytest.approx(np.array([[0.0, 0.0], [0.01, 0.0], [0.0, 0.045]]))  # a twentieth of the bounds
    for place, name in enumerate(names):
        assert all(BOUNDS[name][0] <= each[place] <= BOUNDS[name][1] for each in asked[:3])


def test_a_value_is_the_middle_of_the_resampled_ones_and_its_interval_holds_all_but_a_fortieth_at_each_end() -> None:
    again = np.linspace(0.2, 0.6, 41)
    found = _value("h_mid", again)
    assert (found.low, found.value, found.high, found.told) == (*map(pytest.approx, (0.21, 0.4, 0.59)), True)
    at_bound = _value("v_mid", np.minimum(again + 0.7, 1.0))
    assert (at_bound.value, at_bound.told) == (1.0, False)
    (said,) = _notes({"h_mid": found, "v_mid": at_bound, "authority": Value(1.0, 1.0, 1.0, told=False)})
    assert said == "v_mid = 1 lies at the bound of its search: it is not told"


def test_a_delay_is_a_share_of_the_next_sample_and_a_pace_one_of_the_next_pace() -> None:
    openings = _delayed(np.array([[0.0, 0.2, 0.6, 1.0]] * len(PACES)) * PACES[:, None])
    step = PACES[1] - PACES[0]
    assert _at(openings, 1.0, 0.0) == pytest.approx([0.0, 0.2, 0.6, 1.0])
    assert _at(openings, 1.0, 0.25) == pytest.approx([0.0, 0.15, 0.5, 0.9])
    assert _at(openings, 1.0, -0.25) == pytest.approx([0.05, 0.3, 0.7, 1.0])
    assert _at(openings, 1.0 + 0.3 * step, 0.0)[3] == pytest.approx(1.0 + 0.3 * step)
    assert _at(openings, 1.15, 0.0)[3] == pytest.approx(1.15)
    bent = _delayed(np.array([[0.0, 1.0]] * len(PACES)) * PACES[:, None] ** 2)
    assert _at(bent, 1.15, 0.0)[1] == pytest.approx(1.15**2)
    assert _at(openings, 0.7, 0.0)[3] == pytest.approx(0.85)


def test_a_sample_is_near_where_any_pace_puts_it_between_closed_and_open() -> None:
    at_paces = np.array([[0.0, 0.04, 0.5, 0.94, 1.0], [0.05, 0.06, 0.6, 0.95, 1.0]])
    assert _near(at_paces).tolist() == [False, True, True, True, False]


def test_cycles_count_from_the_second_start(record: FlowRecord) -> None:
    on = np.array([False, True, True, False, True, False, True, True])
    assert _cycle_of(replace(record, on=on)).tolist() == [-2, -1, -1, -1, 0, 0, 1, 1]


def test_the_full_flow_is_that_of_the_open_valve_where_little_flows_when_it_is_closed(record: FlowRecord) -> None:
    opening = np.array([0.0, 0.02, 0.5, 0.96, 1.0, 1.0, 1.0])
    missing = np.array([False] * 6 + [True])
    flow = np.array([1.0, 3.0, 20.0, 30.0, 50.0, 40.0, 999.0])
    assert _full_flow(replace(record, flow=flow, missing=missing), opening) == 40.0
    shut = np.array([20.0, 22.0, 20.0, 30.0, 50.0, 40.0, 999.0])
    with pytest.raises(StudyError, match="40 with the valve open, 21 with it closed"):
        _full_flow(replace(record, flow=shut, missing=missing), opening)
    with pytest.raises(StudyError, match="0 with the valve open"):
        _full_flow(replace(record, flow=flow, missing=missing), 0.9 * opening)


def test_a_pace_is_at_its_bound_within_a_hundredth_and_a_delay_never_is() -> None:
    assert [_is_at_bound("pace", value) for value in (0.852, 0.854, 1.0, 1.148)] == [True, False, False, True]
    assert [_is_at_bound("h_mid", value) for value in (0.1005, 0.102, 0.9995)] == [True, False, True]
    assert not _is_at_bound("delay", 0.5)


@pytest.fixture
def searched(monkeypatch: pytest.MonkeyPatch) -> list[_Problem]:
    """What fits are made of; what a search would find is given here."""
    asked: list[_Problem] = []

    def best(problem: _Problem, names: object, seed: int) -> np.ndarray:
        asked.append(problem)
        return np.array([0.17, 0.41, 0.5, 1.0, 0.0])

    monkeypatch.setattr(valve, "_best", best)
    monkeypatch.setattr(valve, "_again", lambda problem, best, names, draw: np.array([best, best]))
    return asked


def test_a_fit_takes_what_was_measured_of_whole_cycles_between_closed_and_open(
    record: FlowRecord, motor: Choice, searched: list[_Problem]
) -> None:
    """Over the flow of the open valve, at the pace in the middle."""
    lost = record.missing | (np.arange(len(record.flow)) % 7 == 0)
    found = fit_valve(replace(record, missing=lost), motor, authority=0.1)
    (problem,) = searched
    openings, cycle = _openings(record, motor), _cycle_of(record)
    opening, near = openings[list(PACES).index(1.0)], _near(openings)
    full = np.median(record.flow[(opening > 0.95) & ~lost])
    taken = [near[n] and not lost[n] and cycle[n] >= 0 for n in range(len(lost))]
    assert found.full_flow == full
    assert problem.flow.tolist() == (record.flow[taken] / full).tolist()
    assert problem.cycle.tolist() == cycle[taken].tolist()
    assert len(set(problem.cycle)) > 3
    assert found.considered.tolist() == [taken[n] and 0.05 < opening[n] < 0.95 for n in range(len(lost))]


def test_a_flow_that_ends_before_its_record_is_over_the_full_flow_that_was_measured(
    tmp_path: Path, motor: Choice, searched: list[_Problem]
) -> None:
    """A logger that died as the valve opened shows part of its flow, with the signal on, till the end."""
    made = run_trial(Motors("variable-times", {}, "quick-opening", Bench(), 1), replace(FLOW, duration_min=360.0))
    opens = np.flatnonzero(np.diff((made.signal_V > 12.0).astype(int)) == 1)[6]
    rises = opens + int(np.argmax(made.value[opens:] > 20.0))
    lost = np.where(np.arange(len(made.value)) > rises, np.nan, made.value)
    table = pd.DataFrame({"time_s": made.time_s, "flow_L_h": lost, "signal_V": made.signal_V})
    table.to_csv(tmp_path / "flow.csv", index=False)
    record = read_flow(Described(tmp_path / "flow.csv", "flow"))
    whole = np.median(made.value[made.value > 0.8 * made.value.max()])
    assert fit_valve(record, motor, authority=0.1).full_flow == pytest.approx(whole, rel=0.02)
    assert any("of the time is in gaps" in each for each in record.warnings)


@pytest.mark.parametrize(("cycles", "is_enough"), [(2, False), (3, True)])
def test_three_cycles_after_the_first_are_enough(
    record: FlowRecord, motor: Choice, searched: list[_Problem], cycles: int, is_enough: bool
) -> None:
    end = int(np.argmax(_cycle_of(record) == cycles))
    cut = {name: getattr(record, name)[:end] for name in ("on", "flow", "missing")}
    with nullcontext() if is_enough else pytest.raises(StudyError, match="2 cycles after the first"):
        fit_valve(replace(record, **cut), motor, authority=0.1)
    assert bool(searched) is is_enough


# --- whole fits ---------------------------------------------------------------------------------------


def test_the_curve_is_that_of_the_registered_valve() -> None:
    parameters = QuickOpeningValve.Parameters()
    opening = np.linspace(0.0, 1.0, 201)
    theirs = [QuickOpeningValve.step(parameters, None, float(h), 0.0, 5.0) for h in opening]
    np.testing.assert_allclose(curve(opening, *TRUE.values()), theirs, atol=1e-12)


def test_the_curve_comes_back_within_two_hundredths_at_the_paper_s_noise(record: FlowRecord, motor: Choice) -> None:
    found = fit_valve(record, motor, authority=authority_of(2.9, 30.0), how_authority="given")
    values = {name: found.values[name].value for name in TRUE}
    assert values == pytest.approx(TRUE, abs=0.02)
    assert 0.005 < found.mae < 0.011
    for name in ("h_min", "h_mid", "v_mid"):
        assert found.values[name].low < found.values[name].value < found.values[name].high
        assert 0.0 < found.values[name].width < 0.05


def test_the_authority_can_be_fitted_too(record: FlowRecord, motor: Choice) -> None:
    found = fit_valve(record, motor)
    assert found.values["authority"].value == pytest.approx(TRUE["authority"], abs=0.02)
    assert found.values["h_mid"].value == pytest.approx(0.41, abs=0.02)
    assert found.how_authority == "fitted"


def test_the_pace_of_the_exemplar_is_found(tmp_path: Path, motor: Choice) -> None:
    made = written(tmp_path / "slow.csv", Bench(exemplar_scatter=0.05), seed=1)
    pace = Motors("variable-times", {}, "quick-opening", Bench(exemplar_scatter=0.05), 1).exemplar_pace(FLOW)
    assert abs(pace - 1.0) > 0.02
    assert fit_valve(made, motor, authority=0.0967).values["pace"].value == pytest.approx(pace, abs=0.015)


def test_a_fragment_is_the_block_of_a_study(record: FlowRecord, motor: Choice) -> None:
    found = fit_valve(record, motor, authority=0.0967, how_authority="given", is_simulated=True)
    text = found.fragment()
    values = tomllib.loads(text)
    assert text.startswith("# SIMULATED")
    assert block("valve", values["valve"]).component.name == "quick-opening"
    assert values["fit"]["records"][0]["sha256"] == record.sha256
    assert set(values["fit"]["interval_95"]) == {"h_min", "h_mid", "v_mid", "pace", "delay"}


def test_a_parameter_at_the_bound_of_its_search_is_not_told(tmp_path: Path) -> None:
    slow = block("actuator", {"use": "variable-times", "product": "A"})
    found = fit_valve(written(tmp_path / "flow.csv", Bench(), hours=3.0), slow, authority=0.0967, product="A")
    at_bound = [name for name, value in found.values.items() if not value.told and name != "authority"]
    assert at_bound
    assert not set(at_bound) & set(tomllib.loads(found.fragment())["fit"]["interval_95"])
    for name in at_bound:
        assert any(each.startswith(f"{name} = ") and "lies at the bound" in each for each in found.warnings)


def test_the_actuator_of_another_product_is_told(record: FlowRecord, motor: Choice) -> None:
    other = replace(record, product="Y")
    said = "is of product Y, the actuator of X"
    assert any(said in each for each in fit_valve(other, motor, authority=0.0967, product="X").warnings)
    assert not any(said in each for each in fit_valve(other, motor, authority=0.0967, product="Y").warnings)


def test_openings_near_closed_and_open_are_left_out(record: FlowRecord, motor: Choice) -> None:
    found = fit_valve(record, motor, authority=0.0967)
    considered = found.opening[found.considered]
    assert 0.05 < considered.min() < 0.06
    assert 0.9 < considered.max() < 0.95


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda f: f.assign(flow_L_h=100.0), "flow: is 100 throughout"),
        (lambda f: f.assign(flow_L_h=f["flow_L_h"].iloc[::-1].to_numpy() * 0.0 + 60.0 * (f["signal_V"] < 12)), "flow"),
        (lambda f: f.assign(signal_V=f["flow_L_h"], flow_L_h=(f["signal_V"] > 12.0) * 1.0), "takes two values only"),
        (lambda f: f.rename(columns={"flow_L_h": "displacement_mm"}), "flow: no column has this name"),
        (lambda f: f.iloc[:700], "1 cycle after the first, whose start is unknown; at least 3 are needed"),
    ],
    ids=["constant flow", "flow of another valve", "swapped columns", "no flow", "too short"],
)
def test_a_flow_that_cannot_be_used_is_refused(tmp_path: Path, motor: Choice, change: object, said: str) -> None:
    whole = run_trial(Motors("variable-times", {}, "quick-opening", Bench(), 1), replace(FLOW, duration_min=180.0))
    table = pd.DataFrame({"time_s": whole.time_s, "flow_L_h": whole.value, "signal_V": whole.signal_V})
    change(table).to_csv(tmp_path / "flow.csv", index=False)  # type: ignore[operator]
    with pytest.raises(StudyError, match=said):
        fit_valve(read_flow(Described(tmp_path / "flow.csv", "flow")), motor, authority=0.1)
