"""A linear room whose air is held between two setpoints by an ideal heater and cooler."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from waxstudy.plugin import FloatArray, LinearRoom, WeatherRecord

STEP_S = 300.0
WARM_UP_DAYS = 30  # the record's last days, before its first


@dataclass(frozen=True)
class HeldAir:
    """Means of every weather interval; heat is positive for heating, negative for cooling."""

    air_C: FloatArray
    heat_W: FloatArray


def hold_air(room: LinearRoom, weather: WeatherRecord, lowest_C: float = -np.inf, highest_C: float = np.inf) -> HeldAir:
    """Return air temperature and heat of a room without water flow, its air held from `lowest_C` to `highest_C`.

    Exact for inputs and heat that are constant over a step: x' = A x + B u + b q. In each step q is 0 if the air
    then ends between the setpoints, else what brings it to the nearer one. All heat goes to the air.
    """
    inputs, _ = room.drive(weather)
    air = list(room.nodes).index("air")
    decay, forcing, gain = _discrete(room, air)
    warm_up = round(WARM_UP_DAYS * 86_400 / weather.interval_s)
    driven = np.concatenate([inputs[-warm_up:], inputs]) @ forcing.T
    state = np.full(len(room.nodes), 20.0)
    steps = round(weather.interval_s / STEP_S)
    means = np.zeros((2, len(driven)))
    for interval, source in enumerate(driven):
        for _ in range(steps):
            state = decay @ state + source
            heat_W = (min(max(state[air], lowest_C), highest_C) - state[air]) / gain[air]
            state += gain * heat_W
            means[:, interval] += state[air], heat_W
    return HeldAir(*(means[:, -len(inputs) :] / steps))


def _discrete(room: LinearRoom, air: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the step's matrices for state, inputs and heat to the air."""
    nodes, count = len(room.nodes), len(room.inputs)
    system = np.zeros((nodes + count + 1,) * 2)
    system[:nodes, :nodes] = -room.conductance_W_K
    system[:nodes, nodes:-1] = room.input_matrix
    system[air, -1] = 1.0
    system[:nodes] /= room.capacity_J_K[:, None]
    step = expm(system * STEP_S)[:nodes]
    return step[:, :nodes], step[:, nodes:-1], step[:, -1]
