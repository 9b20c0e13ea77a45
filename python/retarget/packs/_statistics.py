"""Statistics of arrays that arrive clip by clip."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass
class Statistics:
    """Minimum, maximum, mean and standard deviation per column; each (N,) float64."""

    count: int
    min: np.ndarray
    max: np.ndarray
    mean: np.ndarray
    squares: np.ndarray
    """Sums of the squared differences from the mean."""

    @staticmethod
    def of(values: np.ndarray) -> Statistics:
        """Returns the statistics of (F, N) or (F,) values; F is at least 1."""
        columns = values.reshape(len(values), -1).astype(np.float64)
        mean = columns.mean(axis=0)
        return Statistics(len(columns), columns.min(axis=0), columns.max(axis=0), mean,
                          ((columns - mean) ** 2).sum(axis=0))

    def add(self, other: Statistics) -> None:
        """Includes the values of other statistics, exactly up to rounding (Chan's formula)."""
        count = self.count + other.count
        difference = other.mean - self.mean
        self.squares = (self.squares + other.squares
                        + difference ** 2 * (self.count * other.count / count))
        self.mean = self.mean + difference * (other.count / count)
        self.min = np.minimum(self.min, other.min)
        self.max = np.maximum(self.max, other.max)
        self.count = count

    def lists(self) -> dict[str, list[float] | list[int]]:
        """Returns the members as lists of N numbers; `std` divides by the count."""
        return {"min": self.min.tolist(), "max": self.max.tolist(), "mean": self.mean.tolist(),
                "std": np.sqrt(self.squares / self.count).tolist(), "count": [self.count]}
