"""Interpolation of coarse four-sided grids by splines, with edges that are reproduced bitwise.

Splines S and T are damped near acute corners (`corner_damping`) and linear around folded cells: x = S X Tᵀ +
shares * (edges - S X Tᵀ on the edges), with coarse nodes X. At a coarse node at a distance d along its line
from the edge, share = max(0, 1 - d / r), r = max(d_1, min(`REACH` h, length of the line)), h the mean step of
the edge on both sides of the line, d_1 the line's first cell.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.geometry.quality.measure import count_folded, folded_cells
from meshonet.geometry.threads import threads_for
from meshonet.kernels._native import resample
from meshonet.solvers.algebraic.resample import corner_damping as acute
from meshonet.solvers.algebraic.resample.spline import places

Sides = tuple[Floats, Floats, Floats, Floats]
"""Coordinates of the nodes on south and north (batch, 2, ni), west and east (batch, 2, nj)."""

Straight = NDArray[np.uint8]

REACH = 2.0  # steps of the edge over which its mismatch is blended

CORNERS = [0, 1, -2, -1]  # rows and columns of a grid from which its corner angles are computed

WIDER = (0, 1, 3)
"""Coarse cells around folded ones in which interpolation becomes linear; at last it is linear everywhere."""


def refine_quad(coarse: Floats, sides: Sides) -> Floats:
    """Return nodes (batch, 2, ni, nj) inside `sides`, interpolated from `coarse` grids (batch, 2, m, n)."""
    nodes = _evaluated(coarse, sides, None)
    for k, one in enumerate(nodes):
        if count_folded(one.transpose(1, 2, 0)):
            mended(coarse[k], tuple(side[k] for side in sides), one)
    return nodes


def mended(coarse: Floats, sides: Sequence[Floats], nodes: Floats) -> Straight | None:
    """Interpolate `nodes` (2, ni, nj) anew around folded cells, in place: linearly instead of with splines.

    `nodes` were interpolated from a `coarse` grid (2, m, n) and from `sides` (see `Sides`). Return a mask
    (m, n) that is 1 at the coarse nodes with linear interpolation. If `coarse` has folded cells, or if
    `nodes` would not get fewer of them, `nodes` stay unchanged and None is returned.
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
    """Yield growing masks (m, n) of coarse nodes around the folded cells of `nodes` (2, ni, nj)."""
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
