"""Claims about rooms that something drives which nobody recorded: it is never taken for nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.diagnosis.realities import EFFECTS, belief, dataset, rows, selected, study
from waxstudy.dataset.clear_sky import clear_sky_W
from waxstudy.dataset.stand_ins import GAINS, SUN, own_gains_W
from waxstudy.dataset.tables import Site
from waxstudy.diagnosis.diagnose import diagnose, record_of
from waxstudy.diagnosis.model.room_response import built
from waxstudy.diagnosis.model.segments import segments
from waxstudy.diagnosis.select.unexplained import unexplained

TALLINN = Site(latitude=59.4, longitude=24.7, timezone="Europe/Tallinn")
DAYS = 4


@pytest.mark.slow
@pytest.mark.parametrize("without", [(SUN,), (GAINS,), (SUN, GAINS)])
def test_a_healthy_room_whose_sun_or_gains_nobody_recorded_is_no_gap_without_a_cause(without: tuple[str, ...]) -> None:
    said = diagnose(dataset(rows("REAL", DAYS, without=without), "REAL"), quick=True)
    assert (said.verdict, list(said.effects)) == ("none", [])
    assert [each.what for each in said.next_measurements[: len(without)]] == [f"record {name}" for name in without]
    for name in without:
        assert any(sentence.startswith(f"{name} was not recorded") for sentence in said.assumptions)


def test_a_record_with_all_drives_has_nothing_in_their_place() -> None:
    assert record_of(dataset(rows("REAL", DAYS), "REAL")).stand_ins == {}


def test_the_gains_of_the_believed_room_stand_in_for_gains_that_nobody_recorded() -> None:
    data = rows("REAL", DAYS)
    seen = record_of(dataset(data.drop(columns=GAINS), "REAL"))
    assert seen.inputs.gains_W == pytest.approx(data[GAINS].to_numpy(), abs=0.1)
    assert seen.inputs.stand_ins == {"gains_W"}


def test_no_factor_is_claimed_of_what_only_stands_in() -> None:
    site = replace(dataset(rows("REAL", DAYS, without=(SUN, GAINS)), "REAL"), site=TALLINN)
    seen = record_of(site)
    believed = belief("REAL", seen)
    assert believed.inputs
    assert believed.inputs.solar_W.any()
    for name in ("solar-factor", "gain-shift"):
        assert EFFECTS[name].hindrance(believed)


def test_a_gap_beyond_what_a_missing_sun_could_make_is_a_finding() -> None:
    """The floor's surface reads 3 K too warm at night: no sun does that."""
    data = rows("REAL", DAYS, without=(SUN,))
    night = pd.DatetimeIndex(data["time"]).hour < 6
    data.loc[night, "floor_surface_temperature_C"] += 3.0
    seen = record_of(dataset(data, "REAL"))
    believed = belief("REAL", seen)
    segment = next(each for each in segments(seen, believed) if each.with_room)
    (remains,) = unexplained(selected(segment, seen, believed, thorough=0.2))
    assert remains.channel == "floor_surface_temperature_C"
    assert remains.is_finding


# --- the sun of a clear sky ------------------------------------------------------------------------------


def clear_W(site: Site, day: str = "2023-03-20") -> np.ndarray:
    time = pd.date_range(day, periods=96, freq="15min") + pd.Timedelta("15min")
    return clear_sky_W(built(study().room), time, 900.0, site)


@given(latitude=st.floats(-60.0, 60.0))
def test_a_clear_sky_shines_by_day_and_never_at_night(latitude: float) -> None:
    sun_W = clear_W(Site(latitude=latitude))
    assert (sun_W >= 0.0).all()
    assert not sun_W[:20].any()
    assert not sun_W[-20:].any()
    assert sun_W[40:56].min() > 0.0


@pytest.mark.parametrize("timezone", ["Europe/Tallinn", None])
def test_the_sun_of_a_site_is_that_of_its_clock(timezone: str | None) -> None:
    """Windows to south and west: the heat's middle lies after noon, which comes at 12.35 h there."""
    sun_W = clear_W(Site(latitude=59.4, longitude=24.7, timezone=timezone))
    middle_h = float(np.sum(sun_W * (np.arange(96) + 0.5) / 4.0) / np.sum(sun_W))
    assert 12.4 < middle_h < 14.5


def test_a_room_without_gains_has_none_of_its_own() -> None:
    room = built(study().room)
    hour = np.arange(24.0)
    assert own_gains_W(room, hour).mean() > 0.0
