"""Refines a volume grid by splines S of its difference from transfinite interpolation T.

x = T(fine faces) + S (x_c - T(coarse faces)): the difference is smooth, and T has the details of the faces.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.six_faces import SixFaces
from meshonet.geometry.elementary import product
from meshonet.geometry.linear import solve
from meshonet.solvers.volumes.interpolate import Laws, Spline, interpolate, uniform_laws


def refine_volume(coarse: Floats, coarse_faces: SixFaces, faces: SixFaces, laws: Laws) -> Floats:
    """Return nodes (3, ni, nj, nk) inside `faces`, by splines through a coarse grid.

    `coarse` (3, mi, mj, mk) are the nodes of the coarse grid inside `coarse_faces`. `laws` are the parameters
    of the fine nodes along edges, 0 to 1 (see `uniform_laws`), equal on all four edges of a direction.
    """
    start = interpolate(coarse_faces, uniform_laws(coarse_faces.counts))
    spline = spline_of(coarse - np.moveaxis(start, -1, 0), tuple(law[0] for law in laws))
    return np.moveaxis(interpolate(faces, laws, spline), -1, 0)


def spline_of(values: Floats, places: tuple[Floats, ...]) -> Spline:
    """Return the spline through `values` (3, mi, mj, mk) at uniform knots, to be evaluated at `places`."""
    coefficients = values
    for axis in range(3):
        matrix = coefficient_matrix(values.shape[axis + 1])
        lines = product(np.moveaxis(coefficients, axis + 1, -1), matrix.T)
        coefficients = np.moveaxis(lines, -1, axis + 1)
    reached = [_reached(m, place) for m, place in zip(values.shape[1:], places, strict=True)]
    weights = tuple(weight for _, weight in reached[:2]), np.ascontiguousarray(reached[2][1].T)
    return Spline(np.ascontiguousarray(coefficients), tuple(f for f, _ in reached), (*weights[0], weights[1]))


@lru_cache(maxsize=16)
def coefficient_matrix(m: int) -> Floats:
    """Return the matrix (m + 2, m) from values at m >= 2 uniform knots to cubic B-spline coefficients.

    The ends are "not a knot": de Boor, A Practical Guide to Splines (1978), chapter XIII.
    """
    system = np.zeros((m + 2, m + 2))
    for row in range(m):
        system[row, row : row + 3] = 1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0
    if m > 3:
        system[m, :5] = system[m + 1, -5:] = 1.0, -4.0, 6.0, -4.0, 1.0
    elif m == 3:  # a parabola
        system[m, :4] = system[m + 1, 1:] = -1.0, 3.0, -3.0, 1.0
    else:  # a straight line
        system[m, :3] = system[m + 1, 1:] = 1.0, -2.0, 1.0
    return solve(system, np.eye(m + 2, m))


def _reached(m: int, places: Floats) -> tuple[NDArray[np.intp], Floats]:
    """Return the first of four coefficients (n,) and their weights (n, 4) at `places` (n,) from 0 to 1."""
    at = places * (m - 1)
    first = np.clip(at.astype(np.intp), 0, m - 2)
    t = at - first
    s = 1.0 - t
    cubes = s * s * s, t * t * t
    middle = 4.0 - 6.0 * t**2 + 3.0 * cubes[1], 4.0 - 6.0 * s**2 + 3.0 * cubes[0]
    return first, np.stack([cubes[0], *middle, cubes[1]], axis=1) / 6.0
