"""Where a boundary or grid of a dataset comes from: the numbers that made it, and what it is kept for."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Origin:
    """Facts of a sample that travel with it from dataset to dataset.

    Parameters
    ----------
    parameters : names and values of the numbers that made it, e.g. ``(("parameter", 0.25),)``.
    split : ``train`` or ``test``; nothing when it is neither.
    """

    parameters: tuple[tuple[str, float], ...] = ()
    split: str = ""


UNKNOWN = Origin()
"""Of a sample that no dataset holds."""
