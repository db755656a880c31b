"""Heights of cells at the level of the tip: thin in its layers beside the wing, thicker far away."""

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, norms
from meshonet.geometry.elementary import exp, log
from meshonet.solvers.rows.columns import arcs_of

# exponent of the size ratio by which cells far away are thicker; with 1, levels would be very oblique
_SHARE = 0.5
_WAY = 5.0  # distance from the tip to these cells, divided by the thickness of layers up to the even cells
_ROUNDS = 40  # largest number of steps of Newton's method for the growth ratio
_STILL = 1e-13  # change of the logarithm of the growth ratio below which the iteration ends


def arcs_beyond(lengths: Floats, first: Floats, cells: int) -> Floats:
    """Return arc lengths (n, cells + 1) of nodes on lines of `lengths` (n,) that start at the tip.

    Cells grow along each line; `first` (n,) are the sizes of the first cells.
    """
    least = float(first.min())
    more = (np.square(np.square(first / least)) - 1.0)[:, None]
    place, wanted = np.arange(cells, dtype=np.float64), lengths / least
    rate = log(wanted) / (cells - 1)  # the last cell alone is as long: above the root
    for _ in range(_ROUNDS):  # Newton's method on the logarithm of the sum, which is convex
        grown = exp(4.0 * rate[:, None] * place)
        sizes = np.sqrt(np.sqrt(more + grown))
        total = sizes.sum(axis=1)
        slope = (sizes * (grown / (more + grown)) * place).sum(axis=1) / total
        before, rate = rate, rate - log(total / wanted) / slope
        if (np.abs(rate - before) < _STILL).all():
            break
    arcs = arcs_of(sizes * (lengths / sizes.sum(axis=1))[:, None])
    arcs[:, -1] = lengths
    return arcs


def last_cells(points: Floats, section: Indices, even: Floats, first: float, growth: float) -> Floats:
    """Return spanwise heights (p,) of the cells inboard of a surface that cuts wings at their tips.

    `points` (p, 3) are the nodes of this surface; those with indices `section` are on a wing. There, cells
    are `first` high. Away from the wing the height increases to sqrt(first * even) within a distance that is
    shorter for a larger growth ratio `growth`. `even` (p,) are mean heights of cells inboard of the nodes.
    """
    wing = points[section]
    away = np.array([norms(wing - point).min() for point in points])
    more = _SHARE * np.maximum(log(even / first), 0.0)
    way = _WAY * even * more / log(np.float64(growth))
    part = np.minimum(away / np.maximum(way, first), 1.0)
    return np.asarray(first * exp(more * part * part * (3.0 - 2.0 * part)))
