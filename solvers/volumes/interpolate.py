"""Transfinite interpolation inside six faces, with an optional spline that is added."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.six_faces import SixFaces
from meshonet.geometry.threads import threads_for
from meshonet.kernels._native import tfi_volume
from meshonet.solvers.volumes.laws import Laws


@dataclass(frozen=True, eq=False)
class Spline:
    """A tensor product of cubic B-splines, evaluated at the nodes of a volume.

    Parameters
    ----------
    coefficients : (3, m1, m2, m3)
    first : (n,) for each direction, index of the first of four coefficients at a node.
    weights : weights of these four, (n, 4) along xi and eta, (4, n) along zeta.
    """

    coefficients: Floats
    first: tuple[NDArray[np.intp], ...]
    weights: tuple[Floats, ...]


def interpolate(
    faces: SixFaces, laws: Laws, spline: Spline | None = None, out: Floats | None = None
) -> Floats:
    """Return planar nodes (ni, nj, nk, 3): the Boolean sum of the three directions at `laws`, plus `spline`.

    `out` (3, ni, nj, nk) is used for the result if given; allocating memory costs as much as computing the
    nodes. Gordon and Hall, Int. J. Numer. Methods Eng. 7 (1973) 461-477.
    """
    planes = np.empty((3, *faces.counts)) if out is None else out
    sides = tuple(np.moveaxis(face, -1, 0) for face in faces.faces)
    added = None if spline is None else (spline.coefficients, spline.first, spline.weights)
    tfi_volume(planes, sides, laws, threads_for(planes[0].size), added)
    return np.moveaxis(planes, 0, -1)
