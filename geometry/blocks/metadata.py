"""Where a boundary or grid of a dataset comes from: the numbers that made it, and what it is kept for."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Origin:
    """Names and values of the numbers that made a sample, and ``train``, ``test`` or nothing."""

    parameters: tuple[tuple[str, float], ...] = ()
    split: str = ""


UNKNOWN = Origin()
"""Of a sample that no dataset holds."""
