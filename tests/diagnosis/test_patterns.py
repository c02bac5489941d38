"""Claims about when an effect of the chain is said to act, on records whose dates are known."""

from __future__ import annotations

from typing import Any

import pytest

from tests.diagnosis.realities import EFFECTS, Effects, dataset, rows
from waxstudy.diagnosis.diagnose import diagnose
from waxstudy.diagnosis.result import FoundEffect
from waxstudy.plugin import Belief, Effect
from waxstudy_effects.sensor import SensorBias, sensor_of
from waxstudy_effects.wrapping import believed, wrapped

AROUND_SENSOR = ["time", "air_temperature_C", "sensor_temperature_C", "control_output"]
NOTHING: Effects = ()
DAYS = 7  # from Friday the first of January on


def warm_at_weekends(p: Any, x: Any, u: float, t: float, dt: float) -> float:
    """Read too warm on Saturday and Sunday; a record's first day is simulated twice."""
    day = t // 86_400.0 - 1.0
    return believed(p, x, u, t, dt) + (p.sensor_bias_bias_K if 1.0 <= day < 3.0 else 0.0)


class WeekendBias(SensorBias):
    """A sensor that reads too warm at weekends."""

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return belief.with_block("sensor", wrapped(sensor_of(belief), SensorBias, p, warm_at_weekends))


def warm_at_the_end(p: Any, x: Any, u: float, t: float, dt: float) -> float:
    """Read too warm from the sixth day on."""
    return believed(p, x, u, t, dt) + (p.sensor_bias_bias_K if t // 86_400.0 - 1.0 >= 5.0 else 0.0)


class LateBias(SensorBias):
    """A sensor that reads too warm on the last days, by which shrinkage is judged."""

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return belief.with_block("sensor", wrapped(sensor_of(belief), SensorBias, p, warm_at_the_end))


def told(effect: type[Effect], monkeypatch: pytest.MonkeyPatch) -> FoundEffect:
    """Return what is said of a sensor beside a healthy record of it."""
    monkeypatch.setitem(EFFECTS, effect.__name__, effect)
    put_in: Effects = ((effect.__name__, (("bias_K", 0.3),)),)
    healthy, seen = (rows("LATE", DAYS, each, seed=2)[AROUND_SENSOR] for each in (NOTHING, put_in))
    found = diagnose(dataset(seen, "LATE"), baseline=dataset(healthy, "LATE"), quick=True)
    (only,) = found.effects
    return only


def test_what_happens_at_weekends_only_is_told_so(monkeypatch: pytest.MonkeyPatch) -> None:
    effect = told(WeekendBias, monkeypatch)
    assert effect.name == "sensor-bias"
    assert effect.when.pattern == "on Saturdays and Sundays"
    assert list(effect.when.spans_h) == [pytest.approx((24.0, 72.0))]
    bias_K = effect.parameters["bias_K"]
    assert bias_K.value == pytest.approx(0.3, abs=0.05)  # as it is then, not on average over all days
    assert bias_K.low <= 0.3 <= bias_K.high
    # a bias of the average on all days would leave the rest of both
    assert effect.gap_after < 1.5 * effect.noise_floor < 0.5 * effect.gap_before


def test_what_the_last_days_alone_show_takes_their_gap_away(monkeypatch: pytest.MonkeyPatch) -> None:
    effect = told(LateBias, monkeypatch)
    assert effect.when.pattern == "from day 6 on"
    assert effect.parameters["bias_K"].value == pytest.approx(0.3, abs=0.05)
    assert effect.gap_after < 1.5 * effect.noise_floor < 0.5 * effect.gap_before


def test_what_is_there_always_is_not(monkeypatch: pytest.MonkeyPatch) -> None:
    assert told(SensorBias, monkeypatch).when.pattern == "always"
