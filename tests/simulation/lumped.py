"""A room of one capacity with an engine of its own, in a few lines of Python; and ones that break their contract."""

from __future__ import annotations

import pickle
import time
from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np

from waxstudy.plugin import (
    TRACE,
    Advance,
    BackendMissing,
    FloatArray,
    LinearRoom,
    OutsideRoom,
    Refused,
    Stopped,
    WeatherRecord,
)
from waxstudy_paper.room import NzebRoom

DAY_S = 86400.0
LOSS_W_K, STORE_J_K, FULL_W = 12.0, 4e6, 600.0


class Lumped(OutsideRoom):
    """C dT/dt = heat - H (T - outdoor), by explicit steps, for a test."""

    name = "lumped"
    api_version = "1.0"
    engine: ClassVar[str] = "Lumped 1.0"

    @classmethod
    def build(cls, p: Any) -> LinearRoom:
        return NzebRoom.build(NzebRoom.Parameters())

    @classmethod
    def ready(cls, p: Any, weather: WeatherRecord, step_s: float) -> str:
        if step_s > 300.0:
            raise Refused("study.step_s", step_s, "must be at most 300")
        if weather.interval_s < 3600.0:
            raise Refused("weather.interval_s", weather.interval_s, "must be an hour")
        return cls.engine

    @classmethod
    def simulate(
        cls,
        p: Any,
        weather: WeatherRecord,
        advance: Advance,
        *,
        setpoint_C: float,
        step_s: float,
        air_K: float,
        slab_K: float,
        stop: Callable[[], bool],
    ) -> FloatArray:
        steps, air_C, rows = round(weather.duration_s / step_s), setpoint_C + air_K, []
        for n in range(-round(7 * DAY_S / step_s), steps):
            if stop():
                raise Stopped
            time_s = n * step_s
            outdoor_C = weather.outdoor_C[int((time_s if n >= 0 else time_s % DAY_S) // weather.interval_s)]
            chain = advance(air_C, time_s, step_s)
            air_C += step_s / STORE_J_K * (FULL_W * chain[-1] - LOSS_W_K * (air_C - outdoor_C))
            rows.append([air_C, air_C, air_C, air_C, 0.0, *chain, FULL_W * chain[-1]])
        return np.array(rows[-steps:])


class Elsewhere(Lumped):
    """Runs the chain as another process would get it."""

    @classmethod
    def simulate(cls, p: Any, weather: WeatherRecord, advance: Advance, **rest: Any) -> FloatArray:
        return super().simulate(p, weather, pickle.loads(pickle.dumps(advance)), **rest)


class Absent(Lumped):
    """Its engine is not installed."""

    @classmethod
    def ready(cls, p: Any, weather: WeatherRecord, step_s: float) -> str:
        raise BackendMissing("Lumped is not installed; install it with: pip install lumped")


class Nameless(Lumped):
    """Does not say which engine it is."""

    engine = ""


class Deaf(Lumped):
    """Does not ask whether it is to stop, and takes its time."""

    @classmethod
    def simulate(cls, p: Any, weather: WeatherRecord, advance: Advance, **rest: Any) -> FloatArray:
        begin = time.perf_counter()
        record = super().simulate(p, weather, advance, **{**rest, "stop": lambda: False})
        time.sleep(max(0.0, 1.5 - (time.perf_counter() - begin)))
        return record


class Hurried(Lumped):
    """Leaves out the warm-up."""

    @classmethod
    def simulate(cls, p: Any, weather: WeatherRecord, advance: Advance, **rest: Any) -> FloatArray:
        def skipping(sensed_C: float, time_s: float, step_s: float) -> Any:
            return advance(sensed_C, time_s, step_s) if time_s >= 0.0 else (0.0, 0.0, 0.0, 0.0)

        return super().simulate(p, weather, skipping, **rest)


class Swallowing(Lumped):
    """Goes on without the chain when the chain fails."""

    @classmethod
    def simulate(cls, p: Any, weather: WeatherRecord, advance: Advance, **rest: Any) -> FloatArray:
        def careless(sensed_C: float, time_s: float, step_s: float) -> Any:
            try:
                return advance(sensed_C, time_s, step_s)
            except Exception:
                return 0.0, 0.0, 0.0, 0.0

        return super().simulate(p, weather, careless, **rest)


class Short(Lumped):
    """Its record lacks the last step."""

    @classmethod
    def simulate(cls, p: Any, weather: WeatherRecord, advance: Advance, **rest: Any) -> FloatArray:
        return super().simulate(p, weather, advance, **rest)[:-1]


class Mixed(Lumped):
    """Writes the chain's columns in another order."""

    @classmethod
    def simulate(cls, p: Any, weather: WeatherRecord, advance: Advance, **rest: Any) -> FloatArray:
        record = super().simulate(p, weather, advance, **rest)
        order = [*range(5), *range(TRACE.index("flow_fraction"), 4, -1), 9]
        return np.ascontiguousarray(record[:, order])
