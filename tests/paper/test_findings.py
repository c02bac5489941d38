"""What the paper's findings say of the figures that they rest on."""

from __future__ import annotations

import doctest
from dataclasses import replace

import numpy as np
import pytest

from waxstudy_paper.published import findings
from waxstudy_paper.published.findings import Check, _judged


@pytest.mark.parametrize(
    ("mean", "spread", "shown"),
    [
        (5.2304, 0.3612, "5.23 ± 0.36 %"),
        (3.98, 3.2, "4.0 ± 3.2 %"),
        (-0.892, 1.13, "-0.9 ± 1.1 %"),
        (1.0, 1.1, "1.0 ± 1.1 %"),
        (-0.00103, 0.00089, "-0.0010 ± 0.0009 %"),
        (-0.0706, 2.6e-6, "-0.0706 %"),
        (361.0, 0.0, "361 %"),
    ],
)
def test_a_figure_and_its_spread_have_the_same_decimals(mean: float, spread: float, shown: str) -> None:
    # half the 95 % interval of the mean of two is 12.706 standard deviations over the root of two
    values = mean + spread / 12.706205 * np.array([-1.0, 1.0])
    assert str(Check("x", values, 0.0, 1.0, "%")) == f"x {shown}"


def test_a_figure_that_a_member_lacks_is_not_known_and_takes_no_other_with_it() -> None:
    lacking = Check("january", np.array([np.nan, 5.0]), 3.0, 8.0, "%")
    _, figure, share = _judged([lacking, Check("february", np.array([5.2, 5.3]), 3.0, 8.0, "%")])
    assert "january not known" in figure
    assert "february 5.25 ± 0.64 %" in figure
    assert share == 0.5


def test_every_figure_is_told_and_first_those_that_make_the_verdict() -> None:
    clear, open_ = np.array([5.2, 5.3]), np.array([2.0, 5.0])
    checks = [Check("january", clear, 3.0, 8.0, "%"), Check("february", open_, 3.0, 8.0, "%")]
    assert _judged(checks) == ("not resolved", "february 4 ± 19 %; january 5.25 ± 0.64 % (held)", 0.5)


def test_more_members_resolve_a_finding_and_weaken_none() -> None:
    few, many = (Check("x", np.tile([2.0, 5.0], n), 3.0, 8.0, "%") for n in (2, 50))
    assert (few.verdict, many.verdict) == ("not resolved", "held")
    assert replace(many, error=1.0).verdict == "not resolved"


def test_the_examples_in_the_docstrings_hold() -> None:
    result = doctest.testmod(findings)
    assert (result.attempted, result.failed) == (1, 0)
