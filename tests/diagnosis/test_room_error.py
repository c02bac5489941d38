"""Claims about the error of a room's model in a diagnosis: it is what the room states, or a dataset widens."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.diagnosis.realities import belief, record
from waxstudy.diagnosis.model.room_response import OF_ROOM, error_of
from waxstudy.diagnosis.model.segments import segments
from waxstudy.diagnosis.residuals.judge import Judge
from waxstudy.diagnosis.residuals.room_means import RoomMeans
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import Belief, Choice, ModelError
from waxstudy_paper.room import NzebRoom

CHANNEL = "air_temperature_C"
STEP_S = 900.0  # of the means that a room is judged on, in records of minutes


class Exact(NzebRoom):
    """A stranger's, who has measured how far his air is off."""

    name = "exact"

    @classmethod
    def model_errors(cls, p: Any) -> Mapping[str, ModelError]:
        return {"air_C": ModelError(0.01, 0.03, "held against a climate chamber")}


# what a room leaves of the air, typically
TYPICAL_K = {"ours": 0.07, "ours widened": 0.105, "a stranger's": 0.01, "a stranger's widened": 0.02}


def beliefs() -> dict[str, Belief]:
    ours = belief("REAL", record("REAL"))
    exact = replace(ours, room=Choice.of(Exact, {}))
    return {
        "ours": ours,
        "ours widened": replace(ours, room_error_factor=1.5),
        "a stranger's": exact,
        "a stranger's widened": replace(exact, room_error_factor=2.0),
    }


@pytest.mark.parametrize(("name", "typical_K"), TYPICAL_K.items())
def test_a_room_s_errors_are_weighed_by_what_the_room_states(name: str, typical_K: float) -> None:
    seen, believed = record("REAL"), beliefs()[name]
    (room,) = [segment for segment in segments(seen, believed) if segment.with_room]
    predicted = room.predict(seen, believed, room.conventions[0])
    (air,) = [each for each in Judge(room, seen, believed).residuals(predicted) if each.channel == CHANNEL]
    scale_K = np.hypot(typical_K, seen.noise[CHANNEL]) * (WEIGHTS.lasting_s / STEP_S) ** 0.5
    assert np.abs(air.error).max() > 0.0
    assert air.whitened * scale_K == pytest.approx(air.error)


@pytest.mark.parametrize(
    ("interval_s", "mean_s"), [(60.0, 900.0), (600.0, 1200.0), (1800.0, 1800.0), (10_800.0, 10_800.0)]
)
def test_errors_hang_together_for_two_hours_however_long_samples_are(interval_s: float, mean_s: float) -> None:
    seen, believed = replace(record("REAL"), interval_s=interval_s), beliefs()["ours"]
    way = RoomMeans(
        CHANNEL, seen, "supply_temperature_C", np.zeros(len(seen), dtype=int), error_of(believed, CHANNEL), False
    )
    pieces = max(1.0, 7200.0 / mean_s)
    assert way.scale_K == pytest.approx(np.hypot(TYPICAL_K["ours"], seen.noise[CHANNEL]) * pieces**0.5)


def test_what_may_be_left_is_the_room_s_too_and_of_no_other_channel() -> None:
    own = {name: [error_of(each, channel).most_K for channel in OF_ROOM] for name, each in beliefs().items()}
    assert own["ours"] == [0.18, 0.18, 0.16, 0.5]
    assert own["ours widened"] == pytest.approx([0.27, 0.27, 0.24, 0.75])
    assert own["a stranger's"] == [0.03, 0.36, 0.32, 1.0]
