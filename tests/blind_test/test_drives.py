"""Claims about records whose sun or gains nobody recorded: drawn from now on, and of earlier keys never."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from waxstudy.blind_test.draw import CHANNEL_SETS, LATER_BUILT_SETS, LATER_SETS, LIT, Case, Measured, drawn
from waxstudy.blind_test.key import Key
from waxstudy.blind_test.make import Place, begun
from waxstudy.blind_test.plan import DRAW, Plan, Slot
from waxstudy.blind_test.record import write_record
from waxstudy.blind_test.truth import sizes
from waxstudy.dataset.channels import GLOBAL
from waxstudy.dataset.read import read_dataset
from waxstudy.dataset.stand_ins import SUN
from waxstudy.diagnosis.diagnose import record_of
from waxstudy_trials.fast_room import FastRoom

KEY = Key(11, 32 * "d")  # no secret


def free(engine: str, count: int, draw: int) -> list[Case]:
    slot = Slot("spread", engine, "null", is_free=True, draw=draw)
    return [drawn(KEY, slot, index, 0, is_judged=True) for index in range(count)]


def test_records_without_sun_or_gains_are_drawn_from_now_on() -> None:
    assert {each.measured.channels for each in free("fast-room", 120, draw=1)} == set(CHANNEL_SETS)
    assert {each.measured.channels for each in free("fast-room", 120, draw=2)} == set(LATER_SETS)
    slot = Slot("built-null", "other-plant", "null", has_baseline=True, draw=2)
    built = [drawn(KEY, slot, index, 0, is_judged=True).measured for index in range(120)]
    assert {each.channels for each in built} == set(LATER_BUILT_SETS)


def test_light_is_shown_where_the_sun_has_a_place_and_a_date() -> None:
    lit = [each.measured for each in free("fast-room", 60, draw=2) if each.measured.channels == LIT]
    assert lit
    assert max(each.days for each in lit) <= FastRoom.lit_days
    assert not any(each.measured.channels == LIT for each in free("other-plant", 60, draw=2))


def test_a_record_with_light_tells_its_place_and_no_other_does(tmp_path: Path) -> None:
    case = next(each for each in free("fast-room", 60, draw=2) if each.measured.channels == LIT)
    staged = FastRoom.make(case.scene)
    for channels in (LIT, "no sun", "all"):
        write_record(tmp_path / channels, staged, replace(case.measured, channels=channels))
        found = read_dataset(tmp_path / channels)
        assert (found.site is not None) == (GLOBAL in found.values) == (channels == LIT)
        assert (SUN in found.values) == (channels == "all")
    told = record_of(read_dataset(tmp_path / LIT)).stand_ins[SUN].values
    true = record_of(read_dataset(tmp_path / "all")).filled(SUN)
    assert told.mean() == pytest.approx(true.mean(), rel=0.5)  # the sun of this winter is hardly above the horizon
    assert np.corrcoef(told, true)[0, 1] > 0.8


def test_what_drove_a_room_drove_it_whoever_recorded_it(tmp_path: Path) -> None:
    """The true gap is the same; what nobody saw of the sun may stand in for a cause that it could explain."""
    scene = FastRoom.draw(np.random.default_rng(0), ["solar-factor"], 4)
    scene["causes"] = [{"name": "solar-factor", "values": {"factor": 2.5}}]
    found = {}
    for channels in ("all", "no sun"):
        case = Case("x", "spread", "single", "fast-room", 0, Measured(channels, 60.0, 4, 1.0, 0.0, 3), scene)
        staged = FastRoom.make(case.scene)
        write_record(tmp_path / channels, staged, case.measured)
        (found[channels],) = sizes(case, staged, read_dataset(tmp_path / channels))
    assert found["all"].gap == found["no sun"].gap > 0.1
    assert found["all"].floor == found["no sun"].floor
    assert found["no sun"].beyond < 1.0 < found["all"].beyond


def test_a_test_that_was_begun_goes_on_as_its_key_drew_then(tmp_path: Path) -> None:
    place, plan = Place(tmp_path / "test"), Plan(cases=3, engines=("fast-room",))
    for draw in (1, DRAW):
        with begun(place, replace(plan, draw=draw), KEY) as drawn_by:
            assert drawn_by.draw == 1
    about = json.loads((place.folder / "blind-test.json").read_text())
    del about["plan"]["draw"]  # as earlier versions wrote it
    (place.folder / "blind-test.json").write_text(json.dumps(about))
    assert place.plan.draw == 1
    assert all(slot.draw == 1 for slot in place.plan.slots(KEY))
