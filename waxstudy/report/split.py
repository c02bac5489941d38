"""What single runs differ by, where an ensemble has every start in every weather: start, weather, and the rest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from waxstudy.plugin import FloatArray


@dataclass(frozen=True)
class Split:
    """Variances of single runs, estimated from one run for each start in each weather (two-way random effects).

    `rest` is what neither alone explains: that a start matters in one weather more than in another. `mean_error` is
    the standard error of the mean over other starts and weathers than these, `freedom` its degrees (Satterthwaite).
    """

    start: float
    weather: float
    rest: float
    mean_error: float
    freedom: float

    @classmethod
    def of(cls, values: FloatArray) -> Split:
        """Return the split of values (weathers, starts), at least two weathers; one start has no variance of its own.

        Source: Searle, Casella and McCulloch, Variance Components, 1992, section 4.5; a negative one is set to 0.
        """
        weathers, starts = values.shape
        of_weather = starts * float(np.var(values.mean(axis=1), ddof=1))
        if starts == 1:
            return cls(0.0, of_weather, 0.0, float(np.sqrt(of_weather / weathers)), weathers - 1.0)
        of_start = weathers * float(np.var(values.mean(axis=0), ddof=1))
        left = values - values.mean(axis=1, keepdims=True) - values.mean(axis=0) + values.mean()
        squares, degrees = np.array([of_weather, of_start, 0.0]), np.array([weathers - 1.0, starts - 1.0, 0.0])
        degrees[2] = degrees[0] * degrees[1]
        squares[2] = of_rest = float(np.sum(left**2)) / degrees[2]
        of_mean = max(of_weather + of_start - of_rest, of_weather, of_start, of_rest)  # as the parts below sum to
        parts = squares**2 / degrees
        freedom = of_mean**2 / float(parts.sum()) if of_mean > 0.0 else float(degrees.min())
        return cls(
            start=max(0.0, of_start - of_rest) / weathers,
            weather=max(0.0, of_weather - of_rest) / starts,
            rest=of_rest,
            mean_error=float(np.sqrt(of_mean / values.size)),
            freedom=max(1.0, freedom),
        )

    @property
    def total(self) -> float:
        """Variance of a single run."""
        return self.start + self.weather + self.rest

    @property
    def sd(self) -> float:
        """Standard deviation of single runs."""
        return float(np.sqrt(self.total))

    @property
    def runs(self) -> float:
        """Of how many independent single runs the mean is worth."""
        return self.total / self.mean_error**2 if self.mean_error > 0.0 else np.inf

    def share(self, of: str) -> float:
        """Return the share of `start`, `weather` or `rest` in the variance; NaN where nothing varies."""
        return float(getattr(self, of) / self.total) if self.total > 0.0 else np.nan
