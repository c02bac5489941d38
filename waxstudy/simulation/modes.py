"""A linear room in modal form: independent modes, so that a step costs a few multiply-adds each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from waxstudy.plugin import FloatArray, LinearRoom, WeatherRecord

CURVE_POINTS = 1001  # table of the floor conductance over the flow fraction


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
    supply_C: FloatArray
    conductance_W_K: FloatArray
    to_modes: FloatArray  # (modes, nodes): node temperatures -> modes
    dropped_error_K: float  # bound on what the dropped modes can do to any temperature

    @property
    def steps_per_interval(self) -> int:
        return round(self.weather.interval_s / self.step_s)


def drive(room: LinearRoom, weather: WeatherRecord, step_s: float, tolerance_K: float = 0.001) -> DrivenRoom:
    """Return the room in modal form under a weather record, exact for inputs held over a step.

    With z the modes, z' = exp(-lambda dt) z + (1 - exp(-lambda dt)) / lambda (b u + f q). Modes whose whole range
    of motion adds up to less than `tolerance_K` in every temperature are replaced by their static response.
    """
    root = np.sqrt(room.capacity_J_K)
    rates, vectors = eigh(room.conductance_W_K / np.outer(root, root))
    to_nodes = vectors / root[:, None]
    outputs = room.output_matrix @ to_nodes
    slow, heat = to_nodes.T @ room.input_matrix, to_nodes.T @ room.floor_heat_share
    inputs, supply_C = room.drive(weather)
    curve = room.floor_conductance_W_K(np.linspace(0.0, 1.0, CURVE_POINTS))

    heat_range = curve.max() * max(1.0, float(np.max(supply_C)) - 10.0)
    moved = np.abs(slow) @ np.ptp(inputs, axis=0) + np.abs(heat) * heat_range
    reach = np.max(np.abs(outputs[:5]), axis=0) * moved / rates
    keep, error = _kept(reach, tolerance_K)

    static = (outputs[:, ~keep] / rates[~keep]) @ slow[~keep]
    gain = -np.expm1(-rates[keep] * step_s) / rates[keep]
    return DrivenRoom(
        room=room,
        weather=weather,
        step_s=step_s,
        decay=np.exp(-rates[keep] * step_s),
        heat_gain=gain * heat[keep],
        forcing=np.ascontiguousarray(inputs @ slow[keep].T * gain),
        outputs=np.ascontiguousarray(outputs[:, keep]),
        offsets=np.ascontiguousarray(inputs @ (room.feedthrough + static).T),
        supply_C=np.ascontiguousarray(supply_C, dtype=float),
        conductance_W_K=np.ascontiguousarray(curve),
        to_modes=np.ascontiguousarray((vectors * root[:, None]).T[keep]),
        dropped_error_K=error,
    )


def _kept(reach: FloatArray, tolerance: float) -> tuple[np.ndarray, float]:
    """Choose the modes to keep: drop the smallest while their reaches add up to at most the tolerance."""
    order = np.argsort(reach)
    total = np.cumsum(reach[order])
    n_dropped = int(np.searchsorted(total, tolerance, side="right"))
    keep = np.ones(len(reach), dtype=bool)
    keep[order[:n_dropped]] = False
    return keep, float(total[n_dropped - 1]) if n_dropped else 0.0
