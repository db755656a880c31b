"""Heights of cells on both sides of the level of the tip: of its layers beside the wing, thicker far away.

Without this the layers of the tip would go around the aircraft as a shell of thin cells.
"""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, norms
from meshonet.geometry.elementary import exp, log

_SHARE = 0.5
"""Share of the logarithm of even cells over first ones by which cells far away are thicker: with all of it,
levels beyond the tip would lean far."""
_WAY = 5.0
"""Way from the tip to these cells, over the thickness that the layers of the tip would have of even cells."""


def last_cells(points: Floats, section: Indices, even: Floats, first: float, growth: float) -> Floats:
    """Return heights (p,) of cells at the level of the tip, of lines that pass it at `points` (p, 3).

    They are `first` on the lines `section` along the wing, and far away between this and `even` (p,).
    """
    wing = points[section]
    away = np.array([norms(wing - point).min() for point in points])
    more = _SHARE * np.maximum(log(even / first), 0.0)
    way = _WAY * even * more / log(np.float64(growth))
    part = np.minimum(away / np.maximum(way, first), 1.0)
    return np.asarray(first * exp(more * part * part * (3.0 - 2.0 * part)))
