"""The heated floor against EN 1264-2, ISO 11855-2, exact conduction and the heat equation."""

from __future__ import annotations

import pytest

from benchmarks.floor import (
    FILM_W_M2K,
    en_1264_W_m2K,
    exact_m2K_W,
    iso_11855_m2K_W,
    log_mean_K,
    nzeb,
    our_time_constant_h,
    ours_m2K_W,
    outputs,
    screed_alone,
    slab_time_constants_h,
    water_and_wall_m2K_W,
)

NOMINAL, PIPE = "ours, exchange 'nominal' (default)", "ours, exchange 'pipe'"


@pytest.fixture(scope="module")
def output_W_m2() -> dict[str, float]:
    return {name: output for name, (output, _) in outputs().items()}


def test_the_characteristic_of_a_bare_floor_at_the_reference_dimensions_is_that_of_the_standard() -> None:
    # all exponents but that of the spacing vanish, and so does that at 75 mm
    assert en_1264_W_m2K(0.075, 0.045, 1.0, 0.020) == pytest.approx(6.7)
    assert en_1264_W_m2K(0.15, 0.045, 1.0, 0.020) == pytest.approx(6.7 / 1.23)
    assert en_1264_W_m2K(0.3, 0.045, 1.0, 0.020) == pytest.approx(6.7 / 1.23**3)


def test_the_design_difference_of_34_and_29_C_into_20_C_is_11_3_K() -> None:
    assert log_mean_K(nzeb("nominal")) == pytest.approx(11.317, abs=0.001)


def test_the_published_68_W_m2_are_half_as_much_again_as_EN_1264_gives_for_300_mm(
    output_W_m2: dict[str, float],
) -> None:
    standard = [value for name, value in output_W_m2.items() if name.startswith("EN 1264-2")]
    assert output_W_m2[NOMINAL] == pytest.approx(68.0)
    assert [68.0 / value for value in standard] == pytest.approx([1.55, 1.49], abs=0.01)


def test_the_published_68_W_m2_are_what_EN_1264_gives_for_150_mm() -> None:
    assert 11.317 * en_1264_W_m2K(0.150, 0.040, 1.2, 0.020) == pytest.approx(68.0, rel=0.02)


def test_conduction_in_two_dimensions_confirms_EN_1264_within_5_percent_where_insulation_follows_the_screed(
    output_W_m2: dict[str, float],
) -> None:
    exact = output_W_m2["conduction in two dimensions, screed alone"]
    # the drawing measures 40 mm of screed to the pipe's middle or to its top: the paper does not say
    assert output_W_m2["EN 1264-2, 30 mm of screed above the pipe"] == pytest.approx(exact, rel=0.05)
    assert output_W_m2["EN 1264-2, 40 mm of screed above the pipe"] == pytest.approx(exact, rel=0.05)


def test_our_pipe_exchange_is_within_2_percent_of_conduction_in_the_floor_with_its_concrete(
    output_W_m2: dict[str, float],
) -> None:
    exact = output_W_m2["conduction in two dimensions, with the concrete"]
    assert output_W_m2[PIPE] == pytest.approx(exact, rel=0.02)
    assert output_W_m2[PIPE] == pytest.approx(output_W_m2["ISO 11855-2, resistances"], rel=0.05)


def test_our_resistance_differs_from_ISO_11855_by_the_film_of_slow_water_alone() -> None:
    room = nzeb("pipe")
    screed = ours_m2K_W(room) - water_and_wall_m2K_W(room)
    ours, standard = ours_m2K_W(room), iso_11855_m2K_W(room)
    assert screed == pytest.approx(0.0622, abs=1e-4)
    assert 0.0 < ours - standard < 0.005


def test_the_term_for_the_spread_between_pipes_is_exact_within_2_percent_with_the_concrete_only() -> None:
    room = nzeb("pipe")
    spread, cover = ours_m2K_W(room) - water_and_wall_m2K_W(room), 0.04 / 1.2 + 1 / FILM_W_M2K
    with_concrete, screed_only = (exact_m2K_W(room, 1 / FILM_W_M2K, below) - cover for below in (2, 1))
    assert with_concrete == pytest.approx(spread, rel=0.02)
    assert screed_only > 1.4 * spread


def test_finer_cells_change_the_conduction_by_less_than_one_percent() -> None:
    room = nzeb("nominal")
    coarse, fine = (exact_m2K_W(room, 1 / FILM_W_M2K, below=2, cell_m=cell_m) for cell_m in (0.002, 0.001))
    assert fine == pytest.approx(coarse, rel=0.01)


@pytest.mark.parametrize("thickness_m", [0.04, 0.06, 0.08])
def test_the_screed_s_time_constant_is_that_of_the_heat_equation_within_2_percent(thickness_m: float) -> None:
    room = screed_alone(thickness_m)
    exact, simple = slab_time_constants_h(thickness_m, room.beside_pipes[0], room.films.interior_m2K_W("floor"))
    assert our_time_constant_h(room) == pytest.approx(exact, rel=0.02)
    assert simple == pytest.approx(exact, rel=0.01)
