"""Cubic splines that do not overshoot.

Hyman, SIAM J. Sci. Stat. Comput. 4 (1983) 645-654.
"""

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.curves.cubic import CubicTable
from meshonet.geometry.curves.monotone import hermite_piece


class LimitedSpline:
    """The cubic spline through `values` (n, ...) at rising `knots` (n,), with slopes limited to be monotone.

    Slopes at knots are the slopes of `CubicTable`, limited to three times the slopes of the straight lines on
    both sides, and 0 at extrema. Values in an interval therefore lie between the values at its ends. Unlike
    `monotone.monotone_cubic`, this does not change the spline of smooth data where the spline is monotone.
    """

    def __init__(self, values: Floats, knots: Floats) -> None:
        self.values, self.knots = values, knots
        step = np.diff(knots).reshape((-1,) + (1,) * (values.ndim - 1))
        delta = np.diff(values, axis=0) / step
        before, behind = np.concatenate([delta[:1], delta]), np.concatenate([delta, delta[-1:]])
        most = 3.0 * np.minimum(np.abs(before), np.abs(behind))
        slopes = np.clip(CubicTable(values, knots).slope(knots), -most, most)
        self.slopes = np.where((slopes * before > 0.0) & (slopes * behind > 0.0), slopes, 0.0)

    def __call__(self, places: Floats) -> Floats:
        """Return values (p, ...) at places (p,)."""
        x, along = self.knots, (-1,) + (1,) * (self.values.ndim - 1)
        i = np.clip(np.searchsorted(x, places, side="right") - 1, 0, len(x) - 2)
        h = x[i + 1] - x[i]
        t, h = ((places - x[i]) / h).reshape(along), h.reshape(along)
        return hermite_piece(
            t, self.values[i], self.values[i + 1], h * self.slopes[i], h * self.slopes[i + 1]
        )
