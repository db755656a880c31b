"""An O grid of any resolution from a small one, along its own lines.

Lines from the body outwards may step by very unequal lengths, and a spline of their nodes would swing and
fold. So each keeps its course, a cubic of arc length, on which new nodes follow a rising cubic of the index::

    x = S x_c(s(j)) + (1 - s)⁸ (south - S south_c) + s⁸ (north - S north_c)

with s the share of a line's length and S periodic splines along xi. What few nodes miss of the walls is felt
only near them.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Complexes, Floats, planar_nodes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.kernels._native import add_spline_rows
from meshonet.solvers.algebraic.resample.spline import bending, places, spline_matrix

STEEP, FLAT = 1.15, 0.5
"""Slopes of the rising cubic in harmonic means of both steps, between which they are those of a spline."""

SQUARINGS = 3
"""Squarings that make the eighth power."""


def evaluate_around(coarse: Floats, boundary: Boundary) -> Floats:
    """Return planar nodes inside the O `boundary` from a grid (m, n, 2) inside its thinned edges."""
    m, ni, nj = len(coarse), boundary.ni, boundary.nj
    lines, share = _along_lines(coarse[..., 0] + 1j * coarse[..., 1], nj)
    first, weights = places(m, ni)
    straight = weights * (1.0, 1.0, 0.0, 0.0)
    shares, nodes = np.zeros((ni, nj)), planar_nodes(ni, nj)
    add_spline_rows(shares, first, straight, share, share, True)
    near_south, near_north = 1.0 - shares, shares
    for _ in range(SQUARINGS):
        near_south *= near_south
        near_north *= near_north
    around = spline_matrix(m, ni, True)
    for c, values in enumerate((lines.real.copy(), lines.imag.copy())):
        plane = nodes[..., c]
        plane[:] = 0.0
        add_spline_rows(plane, first, weights, values, bending(m, True) @ values, True)
        plane += (boundary.south[:, c] - around @ values[:, 0])[:, None] * near_south
        plane += (boundary.north[:, c] - around @ values[:, -1])[:, None] * near_north
    nodes[:, 0], nodes[:, -1] = boundary.south, boundary.north
    nodes[-1] = nodes[0]
    return nodes


def _along_lines(z: Complexes, nj: int) -> tuple[Complexes, Floats]:
    """Return nj nodes on each of the m lines `z` (m, n) and their shares of its length, (m, nj) both."""
    n = z.shape[1]
    steps = np.maximum(np.abs(np.diff(z)), 1e-300)
    length = np.concatenate([np.zeros((len(z), 1)), np.cumsum(steps, axis=1)], axis=1)
    first = places(n, nj)[0]
    t = np.arange(nj) * ((n - 1) / (nj - 1)) - first
    t[-1] = 1.0
    at = _hermite(length, _slopes(length, steps), first, t, 1.0)
    span = steps[:, first]
    within = (at - length[:, first]) / span
    new = _hermite(z, _tangents(np.diff(z) / steps, steps), first, within, span)
    return new, np.ascontiguousarray(at / at[:, -1:])


def _hermite(values: Any, slopes: Any, first: NDArray[np.intp], t: Floats, span: Floats | float) -> Any:
    """Return cubics through `values` (m, n) with `slopes`, at t of the way across spans from `first` on."""
    rest = 1.0 - t
    ends = (1.0 + 2.0 * t) * rest**2 * values[:, first] + (3.0 - 2.0 * t) * t**2 * values[:, first + 1]
    return ends + span * t * rest * (rest * slopes[:, first] - t * slopes[:, first + 1])


def _slopes(length: Floats, steps: Floats) -> Floats:
    """Return the slopes by index of rising `length` (m, n), a spline's where steps vary little."""
    n = length.shape[1]
    bends = length @ bending(n, False).T
    slopes = np.empty_like(length)
    slopes[:, :-1] = steps - (2.0 * bends[:, :-1] + bends[:, 1:]) / 6.0
    slopes[:, -1] = steps[:, -1] + (bends[:, -2] + 2.0 * bends[:, -1]) / 6.0
    before, after = steps[:, :-1], steps[:, 1:]
    mean = np.concatenate([steps[:, :1], 2.0 / (1.0 / before + 1.0 / after), steps[:, -1:]], axis=1)
    return np.clip(slopes, FLAT * mean, STEEP * mean)


def _tangents(directions: Complexes, steps: Floats) -> Complexes:
    """Return the tangents (m, n) of lines whose pieces have `directions` and lengths `steps` (m, n-1)."""
    if steps.shape[1] == 1:
        return np.repeat(directions, 2, axis=1)
    before, after = steps[:, :-1], steps[:, 1:]
    inner = (directions[:, :-1] * after + directions[:, 1:] * before) / (before + after)
    start = 2.0 * directions[:, :1] - inner[:, :1]
    stop = 2.0 * directions[:, -1:] - inner[:, -1:]
    return np.concatenate([start, inner, stop], axis=1)
