"""Where the network's answer folds, a grid part of the way to it may not."""

from __future__ import annotations

from meshonet.geometry.arrays import Floats
from meshonet.geometry.quality.measure import count_folded

SHARES = (0.95, 0.9, 0.8)
"""Of the way from the grid that the network sees to its answer, the first of them without folds; else all."""


def share(start: Floats, answer: Floats) -> float:
    """Return how much of the way from `start` to `answer`, planes (2, m, n) both, to go: 1 but for folds."""
    if count_folded(answer.transpose(1, 2, 0)) == 0:
        return 1.0
    tried = ((part, start + part * (answer - start)) for part in SHARES)
    return next((part for part, one in tried if count_folded(one.transpose(1, 2, 0)) == 0), 1.0)
