"""Which model each time gets, what its intervals hold, and what a few cycles cannot tell."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from benchmarks.fit_recovery import coefficients, fitted, new_profiles
from tests.fit.conftest import QUIET, STEADY, table_of
from waxstudy.dataset.notes import Notes
from waxstudy.identification.actuator import ActuatorModel, fit_actuator
from waxstudy.identification.curves import COOLING, HEATING, Shape, fit_curve, t_test
from waxstudy.identification.description import Described
from waxstudy.identification.records import record_of, samples_of
from waxstudy.identification.result import ActuatorFit, fit
from waxstudy.identification.scatter import Nesting, resampled, scatter_of
from waxstudy.rig.bench import Motors
from waxstudy.rig.instruments import Bench
from waxstudy.rig.programme import table_a1
from waxstudy_paper.actuators import PRODUCTS

LEVELS_S = (130.0, 390.0, 670.0, 1550.0, 2480.0)  # undercooling times of Table A1's profiles
HEATED_S = (340.0, 520.0, 600.0, 880.0, 1440.0)


def synthetic(
    products: Mapping[str, Mapping[str, float]],
    *,
    levels: int = 5,
    exemplars: int = 2,
    cycles: int = 10,
    sd: float = 0.002,
    record_sd: float = 0.003,
    seed: int = 1,
) -> pd.DataFrame:
    """Cycles whose times follow Table 2's equations, in a record per exemplar and level."""
    draw, rows = np.random.default_rng(seed), []
    for product, p in products.items():
        for exemplar in range(exemplars):
            for before, heated in zip(LEVELS_S[:levels], HEATED_S[:levels], strict=True):
                pace = 1.0 + record_sd * draw.normal()
                for number in range(cycles):
                    uc, oh = before * draw.uniform(0.98, 1.02), heated * draw.uniform(0.98, 1.02)
                    times = {
                        "dead_s": p["dead_a_s"] * np.exp(-uc / p["dead_tau_s"]) + p["dead_b_s"],
                        "rise_s": p["rise_a_s"] * np.exp(-uc / p["rise_tau_s"]) + p["rise_b_s"],
                        "hold_s": p["hold_a_s"] * (1.0 - np.exp(-oh / p["hold_tau_s"])) + p["hold_b_s"],
                        "fall_s": p["fall_s"],
                    }
                    moved = {name: value * pace * (1.0 + sd * draw.normal()) for name, value in times.items()}
                    place = {"record": f"{product}{exemplar}_{before:g}", "product": product, "exemplar": str(exemplar)}
                    rows.append(place | moved | {"before_s": uc if number else np.nan, "overheat_s": oh, "lost": ""})
    return pd.DataFrame(rows)


def forms(model: ActuatorModel) -> dict[str, set[str]]:
    return {name: {curve.form for curve in time.curves.values()} for name, time in model.times.items()}


def product(**changes: float) -> dict[str, float]:
    return dict(PRODUCTS["B"]) | changes


# --- the way down from a common model ----------------------------------------------------------------


def test_products_that_do_not_differ_share_one_model() -> None:
    model = fit_actuator(synthetic({"X": product(), "Y": product()}))
    assert forms(model) == {"dead": {"common"}, "rise": {"common"}, "hold": {"common"}, "fall": {"constant"}}
    assert model.times["dead"].steps[-1] == "dead: the common model is used"


def test_products_that_differ_by_a_constant_get_a_product_term() -> None:
    model = fit_actuator(synthetic({"X": product(), "Y": product(dead_b_s=262.0)}))
    assert forms(model)["dead"] == {"product term"}
    b = [model.coefficients(name)["dead_b_s"].value for name in "XY"]
    assert b[1] - b[0] == pytest.approx(30.0, abs=2.0)
    assert "dead: the model with a product term is used" in model.times["dead"].steps


def test_products_of_one_motor_each_are_said_not_to_be_told_apart_from_their_motors() -> None:
    one = fit_actuator(synthetic({"X": product(), "Y": product(dead_b_s=262.0)}, exemplars=1))
    assert sum("product and motor cannot be told apart" in step for step in one.times["dead"].steps) == 1
    three = fit_actuator(synthetic({"X": product(), "Y": product(dead_b_s=262.0)}, exemplars=3))
    assert any("(p < 0.001 against the scatter of motors)" in step for step in three.times["dead"].steps)
    assert any("(p = " in step and "against the scatter of motors" in step for step in three.times["fall"].steps)


def test_products_whose_curves_differ_get_separate_models() -> None:
    model = fit_actuator(synthetic({"X": product(), "Y": product(hold_a_s=195.0, hold_b_s=30.0, hold_tau_s=240.0)}))
    assert forms(model)["hold"] == {"separate"}
    assert model.coefficients("Y")["hold_tau_s"].value == pytest.approx(240.0, rel=0.1)
    assert model.coefficients("X")["hold_tau_s"].value == pytest.approx(600.0, rel=0.1)


def test_a_time_that_does_not_depend_on_the_past_gets_a_constant() -> None:
    model = fit_actuator(synthetic({"X": product(rise_a_s=0.0)}))
    assert forms(model)["rise"] == {"constant"}
    assert model.coefficients("X")["rise_b_s"].value == pytest.approx(163.0, abs=1.0)
    assert any("p = " in step for step in model.times["rise"].steps)
    assert model.coefficients("X")["rise_b_s"].told  # it was looked for and is not there


def test_a_slope_against_the_sign_of_the_physics_is_no_curve() -> None:
    cycles = synthetic({"X": product()})
    cycles["hold_s"] = 300.0 - cycles["hold_s"]
    assert forms(fit_actuator(cycles))["hold"] == {"constant"}


# --- what cannot be told -----------------------------------------------------------------------------


def test_one_profile_tells_no_curve_and_says_so() -> None:
    model = fit_actuator(synthetic({"X": product()}, levels=1))
    assert all(found == {"constant"} for found in forms(model).values())
    assert any("dead_a_s, dead_b_s and dead_tau_s of X cannot be told: undercooling" in each for each in model.untold())
    assert not model.coefficients("X")["dead_b_s"].told


def test_two_profiles_do_not_tell_the_time_constant_and_say_so() -> None:
    cycles = synthetic({"X": product()}, levels=5)
    two = cycles[cycles["record"].str.contains("_130|_2480")]
    model = fit_actuator(two.assign(before_s=two.groupby("record")["before_s"].transform("median")))
    assert not model.coefficients("X")["dead_tau_s"].told
    assert any(
        each.startswith("dead_a_s, dead_b_s and dead_tau_s of X cannot be told apart") for each in model.untold()
    )
    # what is taken instead is no nonsense: between and beyond the two it stays near the truth
    dead = {name: value.value for name, value in model.coefficients("X").items() if name.startswith("dead")}
    for before in (0.0, 130.0, 1000.0, 2480.0, 5000.0):
        modelled = dead["dead_a_s"] * np.exp(-before / dead["dead_tau_s"]) + dead["dead_b_s"]
        assert modelled == pytest.approx(232.0 - 192.0 * np.exp(-before / 780.0), abs=30.0)


def test_pauses_that_nobody_knows_are_no_pauses_of_zero() -> None:
    """Records of one cycle each: how long the motor cooled before is known of none."""
    model = fit_actuator(synthetic({"X": product()}, exemplars=10, cycles=1))
    for name in ("dead", "rise"):
        (said,) = model.times[name].untold
        assert "of X cannot be told: undercooling times are not known" in said
        assert np.isnan(model.times[name].curves["X"].before_s).all()
        assert np.isfinite(model.times[name].curves["X"].b_s.value)
    assert model.times["hold"].curves["X"].before_s == pytest.approx((340.0, 1440.0), rel=0.03)
    assert np.isnan(model.times["fall"].curves["X"].before_s).all()  # it is not held against any


def test_what_is_not_known_of_pauses_is_null_in_the_json(bench: tuple[ActuatorFit, Motors]) -> None:
    for told in bench[0].described()["products"].values():
        assert told["models"]["fall"]["before_s"] is None
        assert len(told["models"]["dead"]["before_s"]) == 2


def test_what_is_said_of_pauses_is_what_decided() -> None:
    """Two odd cycles at each end make no curve, and do not make the sentence contradict itself."""
    cycles = synthetic({"X": product()}, levels=1, exemplars=1, cycles=14)
    cycles["before_s"] = [np.nan, 60.0, 61.0, *[130.0] * 4, 150.0, *[160.0] * 4, 5999.0, 6000.0]
    (said,) = fit_actuator(cycles).times["dead"].untold
    assert "lie within 130 and 160 s, but for the 2 shortest and the 2 longest, and a curve needs" in said


@pytest.mark.parametrize("count", [1, 2, 3, 7, 8])
def test_a_few_cycles_break_nothing(count: int) -> None:
    model = fit_actuator(synthetic({"X": product()}, exemplars=1, levels=1, cycles=count))
    values = [value.value for value in model.coefficients("X").values()]
    assert np.isfinite(values).all()
    assert model.untold()


def test_one_cycle_of_one_product_beside_many_of_another_breaks_nothing() -> None:
    few = synthetic({"Y": product(fall_s=150.0)}, exemplars=1, levels=1, cycles=2)
    model = fit_actuator(pd.concat([synthetic({"X": product()}), few]))
    assert model.coefficients("Y")["fall_s"].value == pytest.approx(150.0, abs=3.0)
    assert any("dead time of Y" in each for each in model.untold())


# --- least squares and scatter -----------------------------------------------------------------------


@pytest.mark.parametrize("shape", [COOLING, HEATING])
def test_without_noise_a_curve_is_found_exactly(shape: Shape) -> None:
    before = np.linspace(50.0, 2500.0, 60)
    group = np.arange(60) % 2
    outcome = shape.sign * 150.0 * shape(before, np.array([700.0]))[0] + np.array([250.0, 280.0])[group]
    found = fit_curve(shape, before, group, outcome[:, None])
    assert found.tau_s[0] == pytest.approx(700.0, rel=1e-3)
    assert found.a_s[0] == pytest.approx(shape.sign * 150.0, rel=1e-3)
    assert found.b_s[:, 0] == pytest.approx([250.0, 280.0], rel=1e-3)


def test_standard_errors_and_p_values_are_those_of_a_linear_model() -> None:
    from scipy.stats import linregress

    draw = np.random.default_rng(1)
    before = draw.uniform(50.0, 2500.0, 40)
    outcome = 230.0 - 190.0 * np.exp(-before / 780.0) + draw.normal(0.0, 20.0, 40)
    found = fit_curve(COOLING, before, np.zeros(40, dtype=np.intp), outcome[:, None])
    test = t_test(COOLING, before, np.zeros(40, dtype=np.intp), outcome, found)
    theirs = linregress(np.exp(-before / found.tau_s[0]), outcome)
    assert (test.se_a_s, test.se_b_s[0]) == pytest.approx((theirs.stderr, theirs.intercept_stderr))
    assert test.p_a == pytest.approx(theirs.pvalue)
    assert test.r_squared == pytest.approx(theirs.rvalue**2)


def nesting(exemplars: int = 6, records: int = 5, cycles: int = 10) -> Nesting:
    count = exemplars * records
    return Nesting(
        np.repeat(np.arange(count), cycles),
        np.repeat(np.arange(exemplars), records),
        np.zeros(exemplars, dtype=np.intp),
    )


def test_the_parts_of_the_scatter_are_told_apart() -> None:
    places, draw = nesting(40, 10, 10), np.random.default_rng(1)
    residual = 0.03 * draw.normal(size=40)[places.exemplar] + 0.01 * draw.normal(size=400)[places.record]
    found = scatter_of(residual + 0.005 * draw.normal(size=4000), places)
    assert (found.exemplar, found.record, found.cycle) == pytest.approx((0.03, 0.01, 0.005), rel=0.2)


def test_resampled_means_scatter_as_student_s_t_does_with_few_exemplars() -> None:
    places, draw = nesting(4, 3, 5), np.random.default_rng(1)
    covered = 0
    for _ in range(200):
        outcome = 100.0 * (1.0 + 0.03 * draw.normal(size=4)[places.exemplar] + 0.001 * draw.normal(size=60))
        model = np.full(60, outcome.mean())
        again = resampled(model, outcome, places, scatter_of(outcome / model - 1.0, places), draw, 400).mean(axis=0)
        low, high = np.quantile(again, (0.025, 0.975))
        covered += low <= 100.0 <= high
    assert 182 <= covered <= 198  # 95 % of 200; as independent cycles it would be about half


# --- the bench's records -----------------------------------------------------------------------------


@pytest.fixture(scope="module")
def bench() -> tuple[ActuatorFit, Motors]:
    motors = Motors("variable-times", {}, "quick-opening", Bench(), 1)
    return fitted(motors, table_a1()), motors


def test_table_2_comes_back_within_its_intervals(bench: tuple[ActuatorFit, Motors]) -> None:
    rows = pd.DataFrame(coefficients(*bench))
    told = rows[(rows["form"] != "constant") | (rows["name"] == "fall_s")]
    inside = (told["low"] <= told["true"]) & (told["true"] <= told["high"])
    assert len(told) == 17
    assert inside.mean() >= 0.88
    assert forms(bench[0].model)["dead"] == {"product term"}
    assert forms(bench[0].model)["hold"] == {"constant", "separate"}


def test_product_a_s_hold_time_is_said_not_to_be_told(bench: tuple[ActuatorFit, Motors]) -> None:
    found = bench[0]
    assert any(
        each.startswith("hold_a_s, hold_b_s and hold_tau_s of A cannot be told") for each in found.model.untold()
    )
    never_closes = next(record for record in found.records if record.name == "A1_5-5")
    assert found.kept(never_closes) == 0
    assert max(found.lost(never_closes), key=found.lost(never_closes).__getitem__) == "does not close fully"


def test_times_of_new_profiles_are_predicted_within_five_seconds(bench: tuple[ActuatorFit, Motors]) -> None:
    wrong = pd.DataFrame(new_profiles(*bench))
    medians = wrong.groupby(["product", "time"])["wrong_s"].median()
    untold = ("A", "hold")  # said above
    assert medians.drop(index=[untold]).max() < 5.0


def test_full_activation_is_that_of_the_paper(bench: tuple[ActuatorFit, Motors]) -> None:
    of = bench[0].activation("B")
    assert 300.0 < of["full_activation_max_s"] < 420.0
    assert 0.05 < of["full_activation_above_300_s"] < 0.5


def test_the_model_s_error_on_the_records_it_was_fitted_to_is_small(bench: tuple[ActuatorFit, Motors]) -> None:
    errors = {name: each.mae for name, each in bench[0].errors.items() if name not in ("A1_5-5", "B1_3-3")}
    assert max(errors.values()) < 0.02
    assert len(errors) == 16


def test_times_that_no_maker_states_are_told() -> None:
    table = table_of(STEADY, QUIET)
    columns = [table[name].to_numpy() for name in ("time_s", "signal_V", "displacement_mm")]
    for factor, unusual in ((1.0, False), (0.2, True)):
        notes = Notes("r")
        samples = samples_of(factor * columns[0], columns[1], columns[2], "mm", notes)
        record = record_of(samples, Described(Path("r.csv"), "r"), "B", notes) if samples else None
        assert record is not None
        told = [sentence for sentence in fit([record]).warnings if "is the unit of the time right?" in sentence]
        assert bool(told) == unusual, factor


def test_a_fit_with_the_same_seed_is_the_same(bench: tuple[ActuatorFit, Motors]) -> None:
    assert fit(bench[0].records).described() == bench[0].described()


def test_another_physics_is_followed_within_the_paper_s_errors_but_where_hold_times_are_not_told() -> None:
    found = fitted(Motors("enthalpy", {}, "quick-opening", Bench(), 1), table_a1())
    errors = {name: each.mae for name, each in found.errors.items() if name != "A1_5-5"}
    assert np.mean(list(errors.values())) < 0.040
    assert max(errors.values()) < 0.098


@pytest.mark.slow
def test_intervals_hold_table_2_in_at_least_88_of_100_repetitions() -> None:
    rows = []
    for seed in range(1, 26):
        motors = Motors("variable-times", {}, "quick-opening", Bench(), seed)
        rows += coefficients(fitted(motors, table_a1()), motors)
    found = pd.DataFrame(rows)
    found = found[(found["form"] != "constant") | (found["name"] == "fall_s")]
    inside = (found["low"] <= found["true"]) & (found["true"] <= found["high"])
    by_name = inside.groupby([found["product"], found["name"]]).sum()
    assert len(by_name) == 17
    # below 19 of 25 would come once in fifty at 88 %
    assert by_name.min() >= 19
