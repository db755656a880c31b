"""Transfinite interpolation inside six faces, with an optional spline that is added."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.blocks.six_faces import SixFaces
from meshonet.geometry.errors import InputError, place_of
from meshonet.geometry.threads import threads_for
from meshonet.kernels._native import tfi_volume

Laws: TypeAlias = tuple[Floats, Floats, Floats]  # laws of xi, eta and zeta

SAME = 1e-9  # largest difference of laws that count as equal


def uniform_laws(counts: tuple[int, int, int]) -> Laws:
    """Return laws (parameters from 0 to 1 along edges) with equal steps; `counts` are the node counts.

    The law (4, n) of a direction has a row for each edge along this direction. In the other two directions,
    the edges are at (low, low), (high, low), (low, high) and (high, high).
    """
    xi, eta, zeta = (np.tile(np.linspace(0.0, 1.0, n), (4, 1)) for n in counts)
    return xi, eta, zeta


def arc_laws(faces: SixFaces) -> Laws:
    """Return relative arc lengths, arranged as in `uniform_laws`. Raises InputError: repeated nodes."""
    xi, eta, zeta = (_arcs(faces.edges_along(axis)) for axis in range(3))
    return xi, eta, zeta


def mean_laws(laws: Laws) -> Laws:
    """Return `laws`, parameters along edges (see `uniform_laws`), as means over four edges per direction."""
    xi, eta, zeta = (np.tile(law.mean(axis=0), (4, 1)) for law in laws)
    return xi, eta, zeta


def _arcs(edges: list[Floats]) -> Floats:
    steps = np.stack([norms(np.diff(edge, axis=0)) for edge in edges])
    arcs = np.concatenate([np.zeros((4, 1)), np.cumsum(steps, axis=1)], axis=1)
    short = np.flatnonzero(~(steps > 0).all(axis=1))
    if len(short):
        edge, at = int(short[0]), int(np.argmin(steps[short[0]]))
        problem = f"nodes {at} and {at + 1} of an edge are the same"
        raise InputError(problem, "volumes need edges of some length", place=place_of(edges[edge][at]))
    laws = arcs / arcs[:, -1:]
    laws[:, -1] = 1.0
    mean = laws.mean(axis=0)
    return np.tile(mean, (4, 1)) if np.abs(laws - mean).max() <= SAME else laws


@dataclass(frozen=True, eq=False)
class Spline:
    """Tensor product of cubic B-splines, evaluated at the nodes of a volume."""

    coefficients: Floats  # (3, m1, m2, m3)
    first: tuple[NDArray[np.intp], ...]  # by direction, (n,) index of the first of four coefficients
    weights: tuple[Floats, ...]  # weights of these coefficients, (n, 4) along xi and eta, (4, n) along zeta


def interpolate(
    faces: SixFaces, laws: Laws, spline: Spline | None = None, out: Floats | None = None
) -> Floats:
    """Return nodes (ni, nj, nk, 3) by transfinite interpolation between `faces`.

    `laws` are the parameters of nodes along edges (see `uniform_laws`). Displacements by `spline` are added.
    `out` (3, ni, nj, nk) takes the result. Gordon and Hall, Int. J. Numer. Methods Eng. 7 (1973) 461-477.
    """
    planes = np.empty((3, *faces.counts)) if out is None else out
    sides = tuple(np.moveaxis(face, -1, 0) for face in faces.faces)
    added = None if spline is None else (spline.coefficients, spline.first, spline.weights)
    tfi_volume(planes, sides, laws, threads_for(planes[0].size), added)
    return np.moveaxis(planes, 0, -1)
