"""How cycles, records and exemplars scatter about a model, and data resampled with that scatter.

Times of one record go together, as do those of one exemplar: cycles are no independent witnesses. The scatter is
relative: a motor that is slow is slow in all. Its parts are told by a nested analysis of variance; how well each is
known enters too, so that with few exemplars intervals widen as Student's t does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from waxstudy.plugin import FloatArray

IntArray = NDArray[np.intp]
CURVE_PARAMETERS = 2  # a and tau are fitted to differences between records


@dataclass(frozen=True)
class Nesting:
    """To which record each cycle belongs, each record to which exemplar, each exemplar to which product."""

    record: IntArray  # (cycles,)
    exemplar_of: IntArray  # (records,)
    product_of: IntArray  # (exemplars,)

    @property
    def exemplar(self) -> IntArray:
        return self.exemplar_of[self.record]


@dataclass(frozen=True)
class Scatter:
    """Relative scatter; a degree of freedom of 0 says that a part could not be seen."""

    cycle: float  # standard deviation within records
    record_square: float  # sum of squares of records within exemplars, and its freedom
    record_freedom: int
    exemplar_square: float
    exemplar_freedom: int
    per_record: float  # mean of 1 / cycles of a record
    per_exemplar: float  # mean of 1 / records of an exemplar

    @property
    def record(self) -> float:
        return self._record(self.record_square / self.record_freedom) if self.record_freedom else 0.0

    @property
    def exemplar(self) -> float:
        if not self.exemplar_freedom:
            return 0.0
        of_records = self.per_exemplar * (self.record**2 + self.per_record * self.cycle**2)
        return float(np.sqrt(max(0.0, self.exemplar_square / self.exemplar_freedom - of_records)))

    def _record(self, mean_square: float) -> float:
        return float(np.sqrt(max(0.0, mean_square - self.per_record * self.cycle**2)))

    def drawn(self, draw: np.random.Generator, count: int) -> tuple[FloatArray, FloatArray]:
        """Return standard deviations of records and exemplars as they may be: each mean square over its chi-squared."""
        records, exemplars = np.zeros(count), np.zeros(count)
        square = np.full(count, self.per_record * self.cycle**2)
        if self.record_freedom:
            square = self.record_square / draw.chisquare(self.record_freedom, count)
            records = np.sqrt(np.maximum(0.0, square - self.per_record * self.cycle**2))
        if self.exemplar_freedom:
            mean_square = self.exemplar_square / draw.chisquare(self.exemplar_freedom, count)
            exemplars = np.sqrt(np.maximum(0.0, mean_square - self.per_exemplar * square))
        return records, exemplars


def scatter_of(residual: FloatArray, nesting: Nesting) -> Scatter:
    """Return the scatter of relative residuals (cycles,)."""
    record, exemplar_of, product_of = nesting.record, nesting.exemplar_of, nesting.product_of
    cycles = np.bincount(record)
    means = np.bincount(record, residual) / cycles
    within = residual - means[record]
    freedom = max(1, len(residual) - len(cycles))
    records = np.bincount(exemplar_of)
    exemplar_means = np.bincount(exemplar_of, means) / records
    exemplars = np.bincount(product_of)
    product_means = np.bincount(product_of, exemplar_means) / exemplars
    between_records = int((records - 1).sum())
    return Scatter(
        cycle=float(np.sqrt((within**2).sum() / freedom)),
        record_square=float(((means - exemplar_means[exemplar_of]) ** 2).sum()),
        record_freedom=max(0, between_records - CURVE_PARAMETERS),
        exemplar_square=float(((exemplar_means - product_means[product_of]) ** 2).sum()),
        exemplar_freedom=int((exemplars - 1).sum()),
        per_record=float(np.mean(1.0 / cycles)),
        per_exemplar=float(np.mean(1.0 / records)),
    )


def resampled(
    model_s: FloatArray,
    outcome_s: FloatArray,
    nesting: Nesting,
    scatter: Scatter,
    draw: np.random.Generator,
    count: int,
) -> FloatArray:
    """Return outcomes (cycles, count) as other exemplars, in other records, might have given them.

    Each draws a deviation for every exemplar and record, and the deviations of cycles from those of the same record.
    """
    record_sd, exemplar_sd = scatter.drawn(draw, count)
    record, exemplar = nesting.record, nesting.exemplar
    shift = exemplar_sd * draw.normal(size=(len(nesting.product_of), count))
    moved = record_sd * draw.normal(size=(len(nesting.exemplar_of), count))
    order = np.argsort(record, kind="stable")
    counts = np.bincount(record)
    first = np.concatenate(([0], np.cumsum(counts)[:-1]))
    other = order[first[record][:, None] + (draw.random((len(record), count)) * counts[record][:, None]).astype(int)]
    residual = outcome_s / model_s - 1.0
    own = residual - (np.bincount(record, residual) / counts)[record]
    drawn: FloatArray = model_s[:, None] * (1.0 + shift[exemplar] + moved[record] + own[other])
    return drawn
