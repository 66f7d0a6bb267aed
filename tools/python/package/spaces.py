# SPDX-License-Identifier: BSD-3-Clause
"""The one space that the environments need, where gymnasium is not installed."""

from typing import Any

import numpy as np


class Box:
    """Arrays of this shape between `low` and `high`."""

    def __init__(self, low: float, high: float, shape: tuple[int, ...], dtype: Any = np.float32) -> None:
        self.shape, self.dtype = shape, np.dtype(dtype)
        self.low, self.high = np.full(shape, low, dtype), np.full(shape, high, dtype)
        self._random = np.random.default_rng()

    def seed(self, seed: int | None = None) -> None:
        self._random = np.random.default_rng(seed)

    def sample(self) -> np.ndarray:
        """Uniform; normal where the box has no bounds."""
        if np.isfinite(self.high).all():
            return self._random.uniform(self.low, self.high).astype(self.dtype)
        return self._random.standard_normal(self.shape).astype(self.dtype)

    def contains(self, x: Any) -> bool:
        return (
            isinstance(x, np.ndarray)
            and x.shape == self.shape
            and np.can_cast(x.dtype, self.dtype)
            and bool(np.all((x >= self.low) & (x <= self.high)))
        )

    def __repr__(self) -> str:
        return f"Box({self.low.flat[0]}, {self.high.flat[0]}, {self.shape}, {self.dtype})"
