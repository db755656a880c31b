"""Four-sided grids on few nodes evaluated at many: splines, with edges that are met bitwise.

With X the planes of a grid's nodes::

    x = S X Tᵀ + shares * (edges - S X Tᵀ there)

S and T are cubic splines, less curved near acute corners (`corner_damping`). They do not reproduce the edges
exactly; the mismatch is blended into the interior over two coarse cells. A cubic swings
between nodes, which may fold cells where spacings differ much, although the coarse ones are valid. Then lines
are made straight around these, as far as it takes: between straight lines, cells inside a valid coarse cell
are valid.

Between the nodes of a coarse edge the full one has detail. In a smooth grid, detail as long as a coarse step
dies out over about that distance from the edge, however thin the cells there are. Blended along whole lines,
the detail would fold thin cells far away. So at coarse node (i, j), at a distance d along its line from the
edge ::

    share = max(0, 1 - d / r),    r = max(d_1, min(`REACH` h, length of the line))

with h the mean of the edge's steps to both sides of the line and d_1 the line's first cell. Between nodes
shares are linear.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.geometry.quality.measure import count_folded, folded_cells
from meshonet.geometry.threads import threads_for
from meshonet.kernels._native import resample
from meshonet.solvers.algebraic.resample import corner_damping as acute
from meshonet.solvers.algebraic.resample.spline import places

Sides = tuple[Floats, Floats, Floats, Floats]
"""Planes of south and north (batch, 2, ni), west and east (batch, 2, nj)."""

Straight = NDArray[np.uint8]

REACH = 2.0  # steps of the edge over which its mismatch is blended

CORNERS = [0, 1, -2, -1]  # rows and columns of a grid that tell how wide its corners open

WIDER = (0, 1, 3)
"""Coarse cells beyond those with folds whose lines become straight, one try after another; at last all do."""


def refine_quad(coarse: Floats, sides: Sides) -> Floats:
    """Return the planes (batch, 2, ni, nj) inside the `sides` of grids `coarse` (batch, 2, m, n)."""
    nodes = _evaluated(coarse, sides, None)
    for k, one in enumerate(nodes):
        if count_folded(one.transpose(1, 2, 0)):
            mended(coarse[k], tuple(side[k] for side in sides), one)
    return nodes


def mended(coarse: Floats, sides: tuple[Floats, ...], nodes: Floats) -> Straight | None:
    """Evaluate a valid grid `coarse` (2, m, n) again, into its folded fine planes `nodes` (2, ni, nj).

    Returns an array (m, n), 1 at coarse nodes around which lines became straight; None where that is no use.
    """
    if count_folded(coarse.transpose(1, 2, 0)):
        return None
    south, north, west, east = (side[None] for side in sides)
    best = None
    left = count_folded(nodes.transpose(1, 2, 0))
    for straight in _straighter(coarse.shape[1:], nodes):
        tried = _evaluated(coarse[None], (south, north, west, east), straight[None])[0]
        folded = count_folded(tried.transpose(1, 2, 0))
        if folded < left:
            nodes[:], best, left = tried, straight, folded
        if left == 0:
            break
    return best


def _straighter(shape: tuple[int, ...], nodes: Floats) -> Iterator[Straight]:
    """Yield ever more coarse nodes around the folded cells of planes `nodes` (2, ni, nj)."""
    straight = np.zeros(shape, np.uint8)
    for wider in WIDER:
        first = [
            cells * (m - 1) // (full - 1)
            for cells, m, full in zip(
                folded_cells(nodes.transpose(1, 2, 0)).T, shape, nodes.shape[1:], strict=True
            )
        ]
        for i, j in set(zip(*(row.tolist() for row in first), strict=True)):
            straight[max(i - wider, 0) : i + wider + 2, max(j - wider, 0) : j + wider + 2] = 1
        yield straight.copy()
    yield np.ones(shape, np.uint8)


def _evaluated(coarse: Floats, sides: Sides, straight: Straight | None) -> Floats:
    (m, n), ni, nj = coarse.shape[2:], sides[0].shape[-1], sides[2].shape[-1]
    corners = coarse[:, :, CORNERS][..., CORNERS]
    opened = acute.openings(corners[:, 0] + 1j * corners[:, 1], np).reshape(-1, 4)
    nodes = np.empty((len(coarse), 2, ni, nj))
    fine = places(m, ni), places(n, nj)
    threads = threads_for(ni * nj)
    resample(coarse, sides, fine, opened, acute.NEAR, acute.FAR, REACH, nodes, straight, threads)
    return nodes
