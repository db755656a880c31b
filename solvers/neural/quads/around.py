"""Bodies in far fields to O grids by the quad network, which goes round the unrolled strip.

::

    walls -> 65 nodes of them -> strip -> even steps from wall to wall -> size out -> towards Winslow's grid
          -> features -> network -> 65 x 33 grid, its walls those nodes
          -> splines -> grid at the walls' own counts

Turning, moving and scaling only move the strip, a mirrored body has the mirrored one, and beginning an eighth
of the way further round shifts it: the network's answer does the same, to rounding.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.solvers.algebraic.resample import grids as resample
from meshonet.solvers.algebraic.resample.spline import between
from meshonet.solvers.neural.quads.encoding import LATENT, SCALE, WINSLOW
from meshonet.solvers.neural.quads.features import features
from meshonet.solvers.neural.quads.inside import inside
from meshonet.solvers.neural.quads.model import QuadModel
from meshonet.solvers.neural.quads.network import CHUNK
from meshonet.solvers.neural.quads.picard import AFTER, approached
from meshonet.solvers.neural.quads.unrolled import AROUND, TURN, even, factors, middles, rolled, unrolled

COMPACT = 0.15
"""Least over largest distance of wall nodes from the middle, of bodies that models are trained on."""


def coarse_grids(
    boundaries: Sequence[Boundary], model: QuadModel, head: int, dtype: str = "float64"
) -> Floats:
    """Return the planes (batch, 2, 65, 33) of the network's grids of O `boundaries` with equal node counts.

    Parameters
    ----------
    head : index into `encoding.HEADS`.
    dtype : of the network's arithmetic, ``float64`` or ``float32``; all else is float64.

    Raises
    ------
    InputError
        walls that, at 65 nodes, do not go once round the body's centroid, nor round a point inside it.
    """
    walls, strips, centres, once = _strips(boundaries)
    if not once.all():
        name = boundaries[int(np.argmin(once))].name
        told = "its walls do not go once round a middle of the body"
        raise InputError(told, "use meshonet solve-pde for this shape", source=name)
    base, factor = even(strips, LATENT), factors(strips)[:, None, None]
    network = model.network(dtype)
    for k in range(0, len(base), CHUNK):
        chunk, unit = base[k : k + CHUNK], factor[k : k + CHUNK]
        even_strip = chunk * unit
        planes, steps = approached(even_strip, around=True)
        near, step = (one[:, 0] + 1j * one[:, 1] for one in (planes, steps))
        near[:, :-1] += SCALE * network(features(near, step, np, around=True), head)
        if head == WINSLOW:
            near[:, -1] = near[:, 0] + unit[:, 0] * TURN
            planes, _ = approached(near, True, AFTER, harmonic=False)
            near = planes[:, 0] + 1j * planes[:, 1]
        chunk[:, :-1] += (near - even_strip)[:, :-1] / unit
        chunk[:, -1] = chunk[:, 0]  # a whole turn on
    grids = rolled(base, centres)
    grids[:, :, [0, -1]] = walls
    return np.ascontiguousarray(np.stack([grids.real, grids.imag], axis=1))


def _strips(
    boundaries: Sequence[Boundary],
) -> tuple[Complexes, Complexes, Complexes, NDArray[np.bool_]]:
    """Return the walls of boundaries at 65 nodes, their strips, the middles, and which go round these once.

    Middles are centroids where the walls go round them, else points `inside` the bodies.
    """
    sides = [np.stack([getattr(b, side) for b in boundaries]).swapaxes(1, 2) for side in ("south", "north")]
    walls = _complex(np.stack([between(side, AROUND) for side in sides], axis=3))
    centres = middles(_complex(sides[0])[:, :-1])
    strips, once = unrolled(walls, centres)
    if not once.all():
        seen = zip(centres, once, walls[:, :-1, 0], strict=True)
        centres = np.array([centre if fits else inside(wall) for centre, fits, wall in seen])
        strips, once = unrolled(walls, centres)
    return walls, strips, centres, once


def compact(boundary: Boundary) -> bool:
    """Return whether an O boundary's body is about as thick as those that models are trained on."""
    _, _, centres, once = _strips([boundary])
    reach = np.abs(_complex(boundary.south.T[None]) - centres)
    return bool(once[0] and reach.min() > COMPACT * reach.max())


def evaluate(grids: Floats, boundaries: Sequence[Boundary]) -> Floats:
    """Return the planes (batch, 2, ni, nj) within `boundaries` of `grids` (batch, 2, m, n) on fewer nodes."""
    pairs = zip(grids, boundaries, strict=True)
    nodes = [resample.evaluate(np.moveaxis(one, 0, -1), boundary) for one, boundary in pairs]
    return np.stack([np.moveaxis(one, -1, 0) for one in nodes])


def _complex(planes: Floats) -> Complexes:
    return np.asarray(planes[:, 0] + 1j * planes[:, 1])
