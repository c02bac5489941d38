"""A linear room in modal form: independent modes, so that a step costs a few multiply-adds each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from waxstudy.plugin import FloatArray, LinearRoom, WeatherRecord

CURVE_POINTS = 1001  # table of the floor conductance over the flow fraction
AFTER_S = np.geomspace(5.0, 86400.0, 30)  # when after a step the error of the dropped modes is looked at


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
    heat_offset: FloatArray  # (6,) direct part of the floor heat, from the dropped modes
    supply_C: FloatArray
    conductance_W_K: FloatArray
    to_modes: FloatArray  # (modes, nodes): node temperatures -> modes
    dropped_error_K: float  # bound on what the dropped modes can do to any temperature
    engine: str = ""  # an outside room's, with its version

    @property
    def steps_per_interval(self) -> int:
        return round(self.weather.interval_s / self.step_s)


def drive(room: LinearRoom, weather: WeatherRecord, step_s: float, tolerance_K: float = 0.01) -> DrivenRoom:
    """Return the room in modal form under a weather record, exact for inputs held over a step.

    With z the modes, z' = exp(-lambda dt) z + (1 - exp(-lambda dt)) / lambda (b u + f q). The modes that matter
    least are replaced by their static response, as many as keep every temperature within `tolerance_K` of the full
    room after the largest single change of every input at once.
    """
    root = np.sqrt(room.capacity_J_K)
    rates, vectors = eigh(room.conductance_W_K / np.outer(root, root))
    to_nodes = vectors / root[:, None]
    outputs = room.output_matrix @ to_nodes
    slow, heat = to_nodes.T @ room.input_matrix, to_nodes.T @ room.floor_heat_share
    inputs, supply_C = room.drive(weather)
    curve = room.floor_conductance_W_K(np.linspace(0.0, 1.0, CURVE_POINTS))

    pulse_W = curve.max() * max(1.0, float(np.max(supply_C)) - 21.0)
    jumps = np.append(np.max(np.abs(np.diff(inputs, axis=0, prepend=inputs[:1])), axis=0), pulse_W)
    driving = np.column_stack((slow, heat)) * jumps / rates[:, None]
    keep, error = _kept(outputs[:5], driving, rates, tolerance_K)

    static = (outputs[:, ~keep] / rates[~keep]) @ np.column_stack((slow, heat))[~keep]
    gain = -np.expm1(-rates[keep] * step_s) / rates[keep]
    return DrivenRoom(
        room=room,
        weather=weather,
        step_s=step_s,
        decay=np.exp(-rates[keep] * step_s),
        heat_gain=gain * heat[keep],
        forcing=np.ascontiguousarray(inputs @ slow[keep].T * gain),
        outputs=np.ascontiguousarray(outputs[:, keep]),
        offsets=np.ascontiguousarray(inputs @ (room.feedthrough + static[:, :-1]).T),
        heat_offset=np.ascontiguousarray(static[:, -1]),
        supply_C=np.ascontiguousarray(supply_C, dtype=float),
        conductance_W_K=np.ascontiguousarray(curve),
        to_modes=np.ascontiguousarray((vectors * root[:, None]).T[keep]),
        dropped_error_K=error,
    )


def _kept(outputs: FloatArray, driving: FloatArray, rates: FloatArray, tolerance: float) -> tuple[np.ndarray, float]:
    """Choose the fewest modes, by their reach, whose step error is within the tolerance."""
    reach = np.max(np.abs(outputs), axis=0) * np.sum(np.abs(driving), axis=1)
    order = np.argsort(reach)[::-1]
    for n_kept in range(1, len(rates)):
        dropped = order[n_kept:]
        error = _step_error(outputs[:, dropped], driving[dropped], rates[dropped])
        if error <= tolerance:
            return np.isin(np.arange(len(rates)), order[:n_kept]), error
    return np.ones(len(rates), dtype=bool), 0.0


def _step_error(outputs: FloatArray, driving: FloatArray, rates: FloatArray) -> float:
    """Largest error over time and outputs when these modes answer a step of every input at once instead of slowly."""
    decay = np.exp(-np.outer(AFTER_S, rates))
    missing = np.einsum("tm,om,mj->toj", decay, outputs, driving, optimize=True)
    return float(np.max(np.sum(np.abs(missing), axis=2)))
