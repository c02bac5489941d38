"""Instruments of a room that have come to show something else since the healthy record."""

from __future__ import annotations

import doctest
from dataclasses import replace

import numpy as np
import pytest

from tests.diagnosis.realities import EFFECTS, planted
from tests.diagnosis.test_calibration import PUT_IN, of_room
from waxstudy.diagnosis.observations.partition import FIT
from waxstudy.diagnosis.observations.record import FLOW
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.select import instruments
from waxstudy.diagnosis.select.posterior import Weighed, posterior
from waxstudy.diagnosis.select.weigh import Weighing

LIBRARY = [EFFECTS[name] for name in ("supply-offset", "floor-cover", "infiltration")]


def weighed(channel: str = "", off: float = 0.0, came: tuple[str, float] | None = None) -> list[Weighed]:
    """A later record of a room in which one instrument shows more, or an effect came, as its hypotheses are weighed."""
    calibration, believed = of_room()
    (healthy,) = (each for name, each in calibration.healthy.items() if "room" in name)
    link, record = healthy.problem.segment, healthy.problem.record
    new = (("supply-offset", (("offset_K", came[1]),)),) if came else ()
    later = planted(link, record, believed, (*PUT_IN, *new), seed=2)
    if channel:
        shown = later.values[channel] * (1.0 + off) if channel == FLOW else later.values[channel] + off
        later = replace(later, values={**later.values, channel: shown})
    parts = np.full(len(later), FIT)
    problem = SegmentProblem(link, later, believed, as_built=calibration.as_built, parts=parts)
    return Weighing(problem, LIBRARY, healthy, 0.0, lambda name: None).weighed()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("channel", "off"),
    [("return_temperature_C", 0.7), ("floor_surface_temperature_C", -0.6), ("air_temperature_C", 0.6), (FLOW, -0.25)],
)
def test_an_instrument_that_shows_something_else_is_unknown_and_told_by_how_much(channel: str, off: float) -> None:
    found = weighed(channel, off)
    told = found[0].off_by
    assert told
    assert told.channel == channel
    assert told.off == pytest.approx(off, rel=0.2)
    beliefs = posterior(found)
    assert sum(p for names, p in beliefs.items() if "unknown" in names.split("+")) > 0.8


@pytest.mark.slow
def test_no_instrument_is_told_where_all_show_what_they_did() -> None:
    found = weighed()
    assert all(each.off_by is None for each in found)
    assert posterior(found)["none"] > 0.8


@pytest.mark.slow
def test_what_an_effect_of_the_library_does_is_no_instrument() -> None:
    beliefs = posterior(weighed(came=("supply-offset", 1.5)))
    assert beliefs["supply-offset"] > 0.8


def test_the_examples_of_what_it_looks_like_hold() -> None:
    tried = doctest.testmod(instruments)
    assert (tried.attempted, tried.failed) == (1, 0)
