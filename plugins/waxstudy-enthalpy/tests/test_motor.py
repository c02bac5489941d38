"""The physical motor: contract, heat, piston, signals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError
from waxstudy_enthalpy import Enthalpy
from waxstudy_enthalpy.agreement import inrush_s
from waxstudy_enthalpy.bench import Rig, cycle_times, on_off, parameters
from waxstudy_enthalpy.motor import core_temperature_C, liquid_fraction, stored_J

from waxstudy.conformance import assert_conforms

# spans of a held signal: minutes, level
SPANS = st.lists(st.tuples(st.integers(1, 40), st.floats(0.0, 1.0)), min_size=1, max_size=12)
PRODUCTS = st.sampled_from("AB")
INPUTS = ("binary", "proportional")
quick = settings(max_examples=30, deadline=None)


def held(spans: list[tuple[int, float]], dt: float) -> np.ndarray:
    return np.concatenate([np.full(round(60.0 * minutes / dt), level) for minutes, level in spans])


def motor(**values: Any) -> Rig:
    return Rig(parameters(values))


def test_the_motor_keeps_the_contract_of_its_kind() -> None:
    assert_conforms(Enthalpy)


# --- heat ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", INPUTS)
@given(product=PRODUCTS, spans=SPANS, dt=st.sampled_from([1.0, 5.0, 7.5, 60.0]))
@quick
def test_electrical_energy_is_heat_stored_or_given_off(kind: str, product: str, spans: Any, dt: float) -> None:
    p = parameters({"product": product, "input": kind})
    rig = Rig(p, dt)
    before = stored_J(p, rig)
    rig.run(held(spans, dt))
    assert rig.heater_J == pytest.approx(rig.loss_J + stored_J(p, rig) - before, rel=1e-9, abs=1e-6)
    assert rig.heater_J >= 0.0


@pytest.mark.parametrize("product", "AB")
def test_held_open_it_draws_the_holding_power_of_the_data_sheet(product: str) -> None:
    rig = motor(product=product)
    rig.run(np.ones(4 * 720))
    before = rig.heater_J
    rig.run(np.ones(720))
    assert (rig.heater_J - before) / 3600.0 == pytest.approx(1.8, abs=0.01)


@pytest.mark.parametrize(("product", "sheet_s"), [("A", 120.0), ("B", 140.0)])
def test_full_power_lasts_about_as_long_as_the_inrush_of_the_data_sheet(product: str, sheet_s: float) -> None:
    assert 60.0 < inrush_s({"product": product}) < sheet_s


@pytest.mark.parametrize("product", "AB")
def test_left_off_it_stays_at_ambient_temperature_and_closed(product: str) -> None:
    rig = motor(product=product, ambient_C=15.0)
    assert not rig.run(np.zeros(720)).any()
    assert core_temperature_C(rig.p, rig.core_J) == pytest.approx(15.0)
    assert rig.loss_J == pytest.approx(0.0, abs=1e-6)


@given(spans=SPANS, product=PRODUCTS)
@quick
def test_twice_the_heat_everywhere_gives_the_same_motion(spans: Any, product: str) -> None:
    once = parameters({"product": product})
    heat = ("inrush_W", "holding_W", "cup_J_K", "body_J_K", "wax_g", "core_body_W_K", "body_ambient_W_K")
    twice = parameters({"product": product, **{name: 2.0 * getattr(once, name) for name in heat}})
    signal = held(spans, 5.0)
    np.testing.assert_array_equal(Rig(once).run(signal), Rig(twice).run(signal))


@pytest.mark.parametrize("kind", INPUTS)
@given(spans=SPANS, product=PRODUCTS)
@quick
def test_steps_of_a_minute_give_what_steps_of_a_second_give(kind: str, spans: Any, product: str) -> None:
    p = parameters({"product": product, "input": kind})
    fine, coarse = Rig(p, 1.0).run(held(spans, 1.0)), Rig(p, 60.0).run(held(spans, 60.0))
    np.testing.assert_allclose(coarse, fine[59::60], atol=0.001 if kind == "binary" else 0.02)


# --- piston ----------------------------------------------------------------------------------------


@given(spans=SPANS, product=PRODUCTS)
@quick
def test_the_valve_never_closes_while_heated_nor_opens_while_not(spans: Any, product: str) -> None:
    signal = np.round(held(spans, 5.0))
    opening = motor(product=product).run(signal)
    change = np.diff(opening, prepend=0.0)
    assert opening.min() >= 0.0
    assert opening.max() <= 1.0
    assert (change[signal > 0.5] >= 0.0).all()
    assert (change[signal <= 0.5] <= 0.0).all()


def loop(**values: Any) -> tuple[np.ndarray, np.ndarray]:
    """Liquid fraction and opening over one full stroke up and down."""
    rig, points = motor(product="B", **values), []
    for level in np.repeat([1.0, 0.0], 400):
        opening = rig.run(np.array([level]))[0]
        points.append((liquid_fraction(rig.p, rig.core_J), opening))
    liquid, opening_ = np.array(points).T
    return liquid, opening_


def test_up_and_down_differ_by_friction() -> None:
    liquid, opening = loop()
    top = int(np.argmax(liquid))
    half = [np.interp(0.5, opening[a], liquid[a]) for a in (slice(0, top), slice(-1, top, -1))]
    p = parameters({"product": "B"})
    assert half[0] - half[1] == pytest.approx(2.0 * p.compliance_mm_N * p.friction_N / p.expansion_mm, rel=0.01)


def test_the_loop_of_liquid_and_opening_has_area_only_with_friction() -> None:
    areas = [abs(np.trapezoid(opening, liquid)) for liquid, opening in (loop(), loop(friction_N=0.0))]
    p = parameters({"product": "B"})
    assert areas[0] == pytest.approx(2.0 * p.compliance_mm_N * p.friction_N / p.expansion_mm, rel=0.01)
    assert areas[1] < 1e-3


@pytest.mark.parametrize("kind", INPUTS)
@pytest.mark.parametrize("product", "AB")
def test_a_stroke_that_is_cut_short_stays_partial(kind: str, product: str) -> None:
    rig = motor(product=product, input=kind)
    dead, rise, *_ = cycle_times(motor(product=product, input=kind).run(on_off(15, 15, 1)), 0.0, 900.0)
    up = rig.run(np.ones(round((dead + 0.5 * rise) / 5.0)))
    down = rig.run(np.zeros(180))
    assert 0.3 < up[-1] < 0.7
    assert down.max() == pytest.approx(up[-1], abs=0.05)
    assert down[-1] == 0.0


@pytest.mark.parametrize("product", "AB")
def test_a_valve_that_is_caught_half_closed_opens_again_sooner(product: str) -> None:
    rig = motor(product=product)
    rig.run(np.ones(360))
    _, _, hold, fall = cycle_times(rig.copy().run(np.concatenate([np.ones(1), np.zeros(180)])), 1.0, 5.0)
    down = rig.run(np.zeros(round((hold + 0.5 * fall) / 5.0)))
    assert 0.3 < down[-1] < 0.7
    assert rig.run(np.ones(36))[-1] == 1.0


@given(product=PRODUCTS, pulse_s=st.integers(5, 180), pause_min=st.integers(40, 90))
@quick
def test_pulses_shorter_than_the_dead_time_never_open(product: str, pulse_s: int, pause_min: int) -> None:
    signal = on_off(pulse_s / 60.0, pause_min, 8)
    assert not motor(product=product).run(signal).any()


# --- signals and parameters ------------------------------------------------------------------------


@pytest.mark.parametrize("product", "AB")
def test_a_proportional_motor_holds_openings_that_rise_with_the_signal(product: str) -> None:
    held_at = []
    for level in np.linspace(0.0, 1.0, 11):
        opening = motor(product=product, input="proportional").run(np.full(1440, level))
        assert np.ptp(opening[-360:]) < 1e-6
        held_at.append(opening[-1])
    assert held_at[0] == 0.0
    assert held_at[-1] == 1.0
    inner = [h for h in held_at if 0.0 < h < 1.0]
    assert len(inner) >= 7
    assert (np.diff(inner) > 0.05).all()


@pytest.mark.parametrize("product", "AB")
def test_a_proportional_motor_holds_a_higher_opening_on_the_way_down(product: str) -> None:
    rig = motor(product=product, input="proportional")
    settled = [rig.run(np.full(1440, level))[-1] for level in (0.5, 1.0, 0.5)]
    assert 0.0 < settled[0] <= settled[2] < settled[1] == 1.0


def test_a_warmer_place_opens_sooner_and_closes_later() -> None:
    cold, warm = (
        cycle_times(motor(product="B", ambient_C=ambient).run(on_off(15, 15, 1)), 0.0, 900.0)
        for ambient in (15.0, 35.0)
    )
    assert warm[0] < cold[0]
    assert warm[1] < cold[1]
    assert warm[2] > cold[2]
    assert warm[3] > cold[3]


def test_what_is_not_given_is_that_of_the_product() -> None:
    model = Enthalpy.Parameters
    assert model() == model(product="B")
    assert model(product="A", wax_g=0.7).body_J_K == model(product="A").body_J_K
    assert model(product="A").body_J_K != model(product="B").body_J_K


@pytest.mark.parametrize(
    ("wrong", "reason"),
    [
        ({"holding_W": 6.0}, "holding_W must be below inrush_W"),
        ({"knee_C": 90.0}, "knee_C below holding_C"),
        ({"friction_N": 110.0}, "the spring never closes the valve"),
        ({"expansion_mm": 2.5}, "expansion_mm must exceed stroke_mm"),
        ({"product": "C"}, "'A' or 'B'"),
        ({"wax_kg": 1.0}, "not permitted"),
    ],
)
def test_parameters_that_make_no_motor_are_refused_with_the_reason(wrong: dict[str, Any], reason: str) -> None:
    with pytest.raises(ValidationError, match=reason):
        Enthalpy.Parameters.model_validate(wrong)
