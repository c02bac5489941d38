"""A temperature of a room: judged on means of a quarter of an hour, over what the form of its model leaves."""

from __future__ import annotations

import numpy as np

from waxstudy.diagnosis.estimate.hypothesis import Residual
from waxstudy.diagnosis.model.discrepancy import Discrepancy
from waxstudy.diagnosis.model.room_response import OF_AIR_AND_FLOOR, Predicted, samples_of_mean, weighted
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import FloatArray, ModelError

STEPPED_K = 0.005  # chosen: what stays of a room that is exactly as believed, in samples of some minutes


class RoomMeans:
    """Errors of means over quarters of an hour, the return's only where water flows."""

    def __init__(
        self,
        channel: str,
        record: Record,
        driven_by: str,
        parts: np.ndarray,
        error: ModelError,
        is_exact_room: bool,
        discrepancy: Discrepancy | None = None,
    ) -> None:
        self.channel, self.record, self.parts = channel, record, parts
        self.form_K = WEIGHTS.most_left * discrepancy.rms_K if discrepancy else error.most_K
        self.discrepancy = discrepancy
        self.driven = record.driven & record.driven_by(driven_by)
        self.samples = samples_of_mean(record.interval_s)
        self.step_s = self.samples * record.interval_s
        self.measured = self._means()
        self.noise = np.full(len(self.measured), record.noise[channel] / np.sqrt(self.samples))
        # the return's first minutes of each pulse are blurred whatever the form
        is_exact = is_exact_room and channel in OF_AIR_AND_FLOOR
        form_K = np.hypot(STEPPED_K, self.noise) if is_exact else np.hypot(error.typical_K, record.noise[channel])
        self.scale_K = form_K * max(1.0, WEIGHTS.lasting_s / self.step_s) ** 0.5

    def residual(self, predicted: Predicted) -> Residual:
        measured, shown = self.measured, predicted[self.channel]
        sample = np.minimum(np.arange(len(measured)) * self.samples, len(self.record) - 1)
        count = min(len(measured), len(shown))
        error = np.full(len(measured), np.nan)
        error[:count] = shown[:count] - measured[:count]
        known = np.isfinite(error) & (self.record.settled & self.driven)[sample]
        error = np.where(known, error, 0.0)
        where = self.record.day[sample], self.parts[sample], sample
        found = self.discrepancy
        whitened = found.whitened(error, known, self.step_s) if found else error / self.scale_K
        return Residual(self.channel, "K", error, whitened, known, *where, self.form_K)

    def _means(self) -> FloatArray:
        values = self.record.values[self.channel]
        weight = np.isfinite(values).astype(float)
        if self.channel == "return_temperature_C" and self.record.has("flow_L_h"):
            weight *= np.where(self.record.flowing, self.record.filled("flow_L_h"), 0.0)
        return weighted(np.nan_to_num(values), weight, self.samples)
