"""A linear room in modal form: independent modes, so that a step costs a few multiply-adds each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from math import isqrt

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import svd

from waxstudy.plugin import FloatArray, LinearRoom, WeatherRecord
from waxstudy.results.kpis import BoolArray
from waxstudy.simulation.lanes import LANES

IntArray = NDArray[np.int64]
CURVE_POINTS = 1001  # table of the floor conductance over the flow fraction
AFTER_S = np.geomspace(5.0, 864000.0, 40)  # when after a step the error is looked at
SNAPSHOTS_S = np.append(0.0, np.geomspace(2.0, 432000.0, 60))  # when the responses are taken that few modes are to span


@dataclass(frozen=True)
class DrivenRoom:
    """A room in one weather, discretised for one step; shapes as in `kernel.simulate`."""

    room: LinearRoom
    weather: WeatherRecord
    step_s: float
    decay: FloatArray
    heat_gain: FloatArray
    forcing: FloatArray
    outputs: FloatArray
    offsets: FloatArray
    heat_offset: FloatArray  # (6,) direct part of the floor heat, from what the modes leave out
    supply_C: FloatArray
    conductance_W_K: FloatArray
    to_modes: FloatArray  # (modes, nodes): node temperatures -> modes
    dropped_error_K: float  # of any temperature against the full room, after the largest change of every input at once
    engine: str = ""  # an outside room's, with its version
    counts: BoolArray | None = None  # (intervals,) whether comfort is counted; None where it always is

    @property
    def steps_per_interval(self) -> int:
        return round(self.weather.interval_s / self.step_s)

    @property
    def counted_s(self) -> float:
        """Time over which comfort is counted [s]."""
        return self.weather.duration_s if self.counts is None else self.weather.interval_s * float(self.counts.sum())

    @property
    def spans(self) -> list[tuple[IntArray, bool]]:
        """The weather intervals one stretch after another, each with whether comfort is counted in it."""
        intervals = np.arange(len(self.supply_C))
        if self.counts is None:
            return [(intervals, True)]
        stretches = np.split(intervals, np.flatnonzero(np.diff(self.counts)) + 1)
        return [(stretch, bool(self.counts[stretch[0]])) for stretch in stretches]

    @property
    def stored_J(self) -> FloatArray:
        """(modes,) heat that the room holds with one of each mode: its nodes' capacities times their temperatures."""
        return np.asarray(self.to_modes.sum(axis=1))

    @property
    def heat_W_K(self) -> float:
        """Heat from the water that a kelvin more of air temperature takes in the long run, all else being equal."""
        # modes that only fill a lane neither decay nor take heat
        lasting = np.divide(self.heat_gain, 1.0 - self.decay, out=np.zeros_like(self.decay), where=self.heat_gain != 0)
        return float(1.0 / (self.outputs[0] @ lasting + self.heat_offset[0]))


def few_modes(
    rates: FloatArray, outputs: FloatArray, driving: FloatArray, starts: FloatArray, tolerance: float
) -> tuple[FloatArray, FloatArray, float]:
    """Return rates and directions (modes, few) of few modes that answer a step of every input alike, and their error.

    They span the main directions that the room goes through after such steps and from its starts (proper orthogonal
    decomposition; Galerkin projection keeps them real and stable).
    """
    exact = _response(rates, outputs, driving)
    fading = np.column_stack((driving / rates[:, None], starts))
    snapshots = np.exp(-np.outer(rates, SNAPSHOTS_S))[:, :, None] * fading[:, None, :]
    directions = svd(snapshots.reshape(len(rates), -1), full_matrices=False)[0]
    for count in range(LANES, directions.shape[1], LANES):
        main = directions[:, :count]
        few_rates, turned = np.linalg.eigh(main.T @ (rates[:, None] * main))
        basis = main @ turned
        missing = np.abs(_response(few_rates, outputs @ basis, basis.T @ driving) - exact)
        if (error := float(np.max(np.sum(missing, axis=2)))) <= tolerance:
            return few_rates, basis, error
    return rates, np.eye(len(rates)), 0.0


def main_modes(
    rates: FloatArray, outputs: FloatArray, driving: FloatArray, starts: FloatArray, tolerance: float
) -> tuple[FloatArray, FloatArray, float]:
    """Return the room's own modes but for those that hardly show: all of these together, at their most, stay within."""
    most = np.abs(outputs) * (np.abs(driving / rates[:, None]).sum(axis=1) + np.abs(starts).sum(axis=1))
    weakest = np.argsort(most.max(axis=0))
    missing = np.cumsum(most[:, weakest], axis=1).max(axis=0)
    left_out = missing <= tolerance
    return (
        np.delete(rates, weakest[left_out]),
        np.delete(np.eye(len(rates)), weakest[left_out], axis=1),
        float(missing[left_out].max(initial=0.0)),
    )


def _response(rates: FloatArray, outputs: FloatArray, driving: FloatArray) -> FloatArray:
    """Return what each output (time, output, input) still lacks of its final value after a step of each input."""
    fading = np.exp(-np.outer(AFTER_S, rates))
    return np.asarray(np.einsum("tm,om,mj->toj", fading, outputs / rates, driving, optimize=True))


# rates and directions (modes, fewer) of fewer modes, with their error, from rates, outputs, driving, starts, tolerance
Fewer = Callable[[FloatArray, FloatArray, FloatArray, FloatArray, float], tuple[FloatArray, FloatArray, float]]


def drive(
    room: LinearRoom, weather: WeatherRecord, step_s: float, tolerance_K: float = 0.005, fewer: Fewer = few_modes
) -> DrivenRoom:
    """Return the room in modal form under a weather record, exact for inputs held over a step.

    With z the modes, z' = exp(-lambda dt) z + (1 - exp(-lambda dt)) / lambda (b u + f q). The room's own modes are
    replaced by as few as keep every temperature within `tolerance_K` of the full room after the largest single change
    of every input at once; what they leave out answers at once, so that steady states are the full room's. Where the
    tolerance is 0 the room's own modes stay. Finding the fewest (`few_modes`) is dear, and pays in long runs.
    """
    root = np.sqrt(room.capacity_J_K)
    rates, vectors = _own_modes((room.conductance_W_K / np.outer(root, root)).tobytes())
    to_nodes, to_modes = vectors / root[:, None], (vectors * root[:, None]).T
    outputs = room.output_matrix @ to_nodes
    driving = to_nodes.T @ np.column_stack((room.input_matrix, room.floor_heat_share))
    inputs, supply_C = room.drive(weather)
    curve = room.floor_conductance_W_K(np.linspace(0.0, 1.0, CURVE_POINTS))

    few_rates, basis, error = rates, np.eye(len(rates)), 0.0
    if tolerance_K > 0.0:
        pulse_W = curve.max() * max(1.0, float(np.max(supply_C)) - 21.0)
        jumps = np.append(_largest_steps(inputs), pulse_W)
        air = to_modes @ room.air_nodes
        starts = np.column_stack((air, to_modes @ np.ones(len(root)) - air))  # a kelvin of air and walls, of the rest
        few_rates, basis, error = fewer(rates, outputs[:5], driving * jumps, starts, tolerance_K)

    few_outputs, few_driving = outputs @ basis, basis.T @ driving
    static = (outputs / rates) @ driving - (few_outputs / few_rates) @ few_driving
    gain = -np.expm1(-few_rates * step_s) / few_rates
    return DrivenRoom(
        room=room,
        weather=weather,
        step_s=step_s,
        decay=_in_lanes(np.exp(-few_rates * step_s)),
        heat_gain=_in_lanes(gain * few_driving[:, -1]),
        forcing=inputs @ _in_lanes(few_driving[:, :-1].T * gain),
        outputs=_in_lanes(few_outputs),
        offsets=np.ascontiguousarray(inputs @ (room.feedthrough + static[:, :-1]).T),
        heat_offset=np.ascontiguousarray(static[:, -1]),
        supply_C=np.ascontiguousarray(supply_C, dtype=float),
        conductance_W_K=np.ascontiguousarray(curve),
        to_modes=np.ascontiguousarray(_in_lanes(to_modes.T @ basis).T),
        dropped_error_K=error,
    )


def _largest_steps(inputs: FloatArray) -> FloatArray:
    """Return the largest change of each input (m,) from one interval to the next, of inputs (n, m)."""
    steps = np.diff(np.ascontiguousarray(inputs.T))
    return np.asarray(np.abs(steps, out=steps).max(axis=1, initial=0.0))


@lru_cache(maxsize=2)
def _own_modes(symmetric: bytes) -> tuple[FloatArray, FloatArray]:
    """Return eigenvalues and vectors of a matrix; many runs in a row change the inputs of one room alone."""
    flat = np.frombuffer(symmetric)
    found = np.linalg.eigh(flat.reshape(-1, isqrt(len(flat))))
    for each in found:
        each.flags.writeable = False
    return found.eigenvalues, found.eigenvectors


def _in_lanes(by_mode: FloatArray) -> FloatArray:
    """Return an array with modes of nothing at its end, so that they fill whole lanes."""
    count = by_mode.shape[-1]
    filled = np.zeros((*by_mode.shape[:-1], count + -count % LANES))
    filled[..., :count] = by_mode
    return filled
