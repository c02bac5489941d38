"""The standby study: pulses that warm without opening."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from waxstudy_enthalpy import agreement
from waxstudy_enthalpy.bench import parameters
from waxstudy_enthalpy.pulses import (
    FIRST_S,
    LIMIT_S,
    NONE,
    Pattern,
    after_pause_s,
    largest,
    opens_from_C,
    smallest,
    standby,
)
from waxstudy_enthalpy.standby import print_all


@pytest.mark.parametrize("product", "AB")
def test_without_standby_a_long_pause_takes_longer_than_the_reserve_allows(product: str) -> None:
    assert standby(parameters({"product": product}), NONE).activation_s > LIMIT_S


@pytest.mark.parametrize("product", "AB")
def test_the_smallest_pattern_is_quick_enough_after_every_pause_and_moves_nothing(product: str) -> None:
    p = parameters({"product": product})
    pattern = smallest(p, 300.0)
    settled = standby(p, pattern)
    assert settled.opening == 0.0
    assert settled.margin_K > 5.0
    assert all(after_pause_s(p, pattern, 60.0 * minutes) <= LIMIT_S for minutes in (5, 15, 30, 60, 120))
    assert standby(p, Pattern(pattern.pulse_s - 1.0, 300.0)).activation_s > LIMIT_S


def test_one_pattern_serves_product_a_from_15_to_35_C_but_not_product_b() -> None:
    for product, serves in (("A", True), ("B", False)):
        cold, warm = (parameters({"product": product, "ambient_C": ambient_C}) for ambient_C in (15.0, 35.0))
        pattern = smallest(cold, 300.0)
        assert standby(cold, pattern).activation_s <= LIMIT_S
        in_time = after_pause_s(cold, NONE, FIRST_S) <= LIMIT_S
        assert (in_time and standby(warm, pattern).margin_K > 1.0) is serves


@pytest.mark.parametrize("product", "AB")
def test_one_second_more_than_the_largest_pattern_moves_the_piston(product: str) -> None:
    p = parameters({"product": product})
    pattern = largest(p, 300.0)
    assert standby(p, pattern).opening == 0.0
    assert standby(p, Pattern(pattern.pulse_s + 1.0, 300.0)).opening > 0.0


@pytest.mark.parametrize("product", "AB")
def test_a_pattern_that_is_safe_at_21_C_opens_the_valve_in_a_warm_cabinet(product: str) -> None:
    pattern = largest(parameters({"product": product}), 300.0)
    assert standby(parameters({"product": product, "ambient_C": 35.0}), pattern).opening > 0.4
    assert 21.0 < opens_from_C({"product": product}, pattern) < 22.0


def test_more_pulse_costs_more_power_and_opens_sooner() -> None:
    p = parameters({"product": "B"})
    short, long = (standby(p, Pattern(pulse_s, 300.0)) for pulse_s in (30.0, 60.0))
    assert short.power_W < long.power_W
    assert short.activation_s > long.activation_s
    assert short.margin_K > long.margin_K


@pytest.mark.slow
def test_the_tables_of_the_pages_are_what_the_commands_print(capsys: pytest.CaptureFixture[str]) -> None:
    pages = sorted((Path(__file__).parents[3] / "docs").glob("enthalpy*.md"))
    if not pages:
        pytest.skip("the pages lie in waxstudy's repository, not in this package")
    agreement.print_all()
    print_all()
    printed = {line.rstrip() for line in capsys.readouterr().out.splitlines()}
    text = "".join(page.read_text(encoding="utf-8") for page in pages)
    blocks = re.findall(r"^```text\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    shown = [line for block in blocks for line in block.splitlines()]
    assert len(shown) > 40
    assert [line for line in shown if line not in printed and line != "..."] == []
