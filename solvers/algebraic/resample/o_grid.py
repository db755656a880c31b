"""Interpolation of a coarse O grid to any resolution, along its own grid lines.

x = S x_c(s(j)) + (1 - s)⁸ (south - S south_c) + s⁸ (north - S north_c), with
x_c: cubic of arc length; s(j): monotonic cubic, fraction of arc length; S: periodic splines along xi.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats, array_like, planar_nodes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.elementary import functions_of, modulus, product
from meshonet.geometry.threads import threads_for
from meshonet.kernels._native import add_spline_rows
from meshonet.solvers.algebraic.resample.spline import bending, places, spline_matrix
from meshonet.solvers.iteration import put_edges

STEEP, FLAT = 1.15, 0.5
"""Bounds of slopes of the monotonic cubic, as multiples of the harmonic mean of the two adjacent steps."""

SQUARINGS = 3  # squarings that make the eighth power


def refine_around(coarse: Floats, boundary: Boundary) -> Floats:
    """Return nodes (ni, nj, 2) inside an O `boundary`, interpolated from a `coarse` grid (m, n, 2)."""
    m, ni, nj = len(coarse), boundary.ni, boundary.nj
    threads = threads_for(ni * nj)
    lines, share = map(np.ascontiguousarray, along_lines(coarse[..., 0] + 1j * coarse[..., 1], nj))
    first, weights = places(m, ni)
    straight = weights * (1.0, 1.0, 0.0, 0.0)
    shares, nodes = np.zeros((ni, nj)), planar_nodes(ni, nj)
    add_spline_rows(shares, first, straight, share, share, True, threads)
    near_south, near_north = 1.0 - shares, shares
    for _ in range(SQUARINGS):
        near_south *= near_south
        near_north *= near_north
    around = spline_matrix(m, ni, True)
    for c, values in enumerate((lines.real.copy(), lines.imag.copy())):
        plane = nodes[..., c]
        plane[:] = 0.0
        add_spline_rows(plane, first, weights, values, product(bending(m, True), values), True, threads)
        plane += (boundary.south[:, c] - product(around, values[:, 0]))[:, None] * near_south
        plane += (boundary.north[:, c] - product(around, values[:, -1]))[:, None] * near_north
    put_edges(nodes, boundary)
    return nodes


def along_lines(z: Any, nj: int, xp: Any = np) -> tuple[Any, Any]:
    """Return nj nodes (..., nj) on a cubic curve through complex nodes `z` (..., n), and their arc fractions.

    `z` is an array of numpy or torch; `xp` is that module.
    """
    n = z.shape[-1]
    moves = z[..., 1:] - z[..., :-1]
    steps = xp.clip(modulus(moves), 1e-300, None)
    length = xp.concatenate([xp.zeros_like(steps[..., :1]), xp.cumsum(steps, -1)], -1)
    first = places(n, nj)[0]
    way = np.arange(nj) * ((n - 1) / (nj - 1)) - first
    way[-1] = 1.0
    t = array_like(way, z, xp)
    at = _hermite(length, _slopes(length, steps, xp), first, t, 1.0)
    span = steps[..., first]
    within = (at - length[..., first]) / span
    return _hermite(z, _tangents(moves / steps, steps, xp), first, within, span), at / at[..., -1:]


def _hermite(values: Any, slopes: Any, first: NDArray[np.intp], t: Any, span: Any) -> Any:
    """Return Hermite cubics of `values` and `slopes` (..., n) at fraction t of the intervals from `first`."""
    rest = 1.0 - t
    ends = (1.0 + 2.0 * t) * rest**2 * values[..., first] + (3.0 - 2.0 * t) * t**2 * values[..., first + 1]
    return ends + span * t * rest * (rest * slopes[..., first] - t * slopes[..., first + 1])


def _slopes(length: Any, steps: Any, xp: Any) -> Any:
    """Return the derivatives of arc `length` (..., n) by the index: a spline's, bounded to be monotonic."""
    bends = functions_of(xp).matmul(length, array_like(bending(length.shape[-1], False), length, xp).T)
    before, after = steps[..., :-1], steps[..., 1:]
    inner = steps - (2.0 * bends[..., :-1] + bends[..., 1:]) / 6.0
    last = steps[..., -1:] + (bends[..., -2:-1] + 2.0 * bends[..., -1:]) / 6.0
    mean = xp.concatenate([steps[..., :1], 2.0 / (1.0 / before + 1.0 / after), steps[..., -1:]], -1)
    return xp.clip(xp.concatenate([inner, last], -1), FLAT * mean, STEEP * mean)


def _tangents(directions: Any, steps: Any, xp: Any) -> Any:
    """Return the tangents (..., n) of polylines, whose segments (..., n-1) have `directions` and `steps`."""
    if steps.shape[-1] == 1:
        return xp.concatenate([directions, directions], -1)
    before, after = steps[..., :-1], steps[..., 1:]
    inner = (directions[..., :-1] * after + directions[..., 1:] * before) / (before + after)
    start = 2.0 * directions[..., :1] - inner[..., :1]
    return xp.concatenate([start, inner, 2.0 * directions[..., -1:] - inner[..., -1:]], -1)
