"""Grids of four-sided domains by the quad network, from transfinite grids of 33 nodes on each edge."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, TypeAlias

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats, pairs_of
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.elementary import times
from meshonet.geometry.quality.measure import count_folded
from meshonet.kernels._native import tfi
from meshonet.solvers.algebraic.resample.quad import Sides, refine_quad
from meshonet.solvers.algebraic.resample.spline import between
from meshonet.solvers.algebraic.tfi import arc_length_fraction
from meshonet.solvers.neural.quad.encoding import LATENT, SCALE, WINSLOW, frame, planes_of
from meshonet.solvers.neural.quad.network import CHUNK, Network
from meshonet.solvers.neural.quad.picard import AFTER, approach, nodes_after

Moves: TypeAlias = Callable[[Any, Any], Any]  # of grids and steps, or of grids and moves
SHARES = (0.95, 0.9, 0.8)  # fractions of the network's displacement, tried in turn if all of it folds cells


def sides_of(boundaries: Sequence[Boundary]) -> Sides:
    """Return the four arrays of sides (batch, 2, n) of boundaries that have the same node counts."""
    names = ("south", "north", "west", "east")
    south, north, west, east = (
        np.ascontiguousarray(np.stack([getattr(boundary, name).T for boundary in boundaries]))
        for name in names
    )
    return south, north, west, east


def rims(planes: Floats) -> Sides:
    """Return the four arrays of sides (batch, 2, n) of grids `planes` (batch, 2, m, n)."""
    south, north = np.ascontiguousarray(planes[..., 0]), np.ascontiguousarray(planes[..., -1])
    return south, north, np.ascontiguousarray(planes[:, :, 0]), np.ascontiguousarray(planes[:, :, -1])


def thinned(sides: Sides, ni: int, nj: int) -> Sides:
    """Return the sides reduced to `ni` and `nj` nodes, interpolated linearly at equal steps of the index."""
    return between(sides[0], ni), between(sides[1], ni), between(sides[2], nj), between(sides[3], nj)


def transfinite(sides: Sides) -> Floats:
    """Return nodes (batch, 2, ni, nj) of transfinite interpolation with arc-length parameters."""
    nodes = np.empty((*sides[0].shape, sides[2].shape[-1]))
    laws = [arc_length_fraction(np.moveaxis(side, 1, -1)) for side in sides]
    for k, (x, y) in enumerate(nodes):
        along, across = (tuple(side[k, axis] for side in sides) for axis in (0, 1))
        tfi(x, y, along, across, tuple(law[k] for law in laws))
    return nodes


def coarse_grids(sides: Sides, network: Network, head: int) -> Floats:
    """Return the network's grids (batch, 2, m, n), x and y of m by n nodes, in four `sides` (batch, 2, k).

    `head` is the index in `encoding.HEADS` of the kind of grid, Winslow or variational. Variational grids
    have 33 x 33 nodes. Winslow grids have the node counts of the sides, but at least 33 and at most 65.
    """
    base = transfinite(thinned(sides, LATENT, LATENT))
    shares = None if head == WINSLOW else _shares
    for k in range(0, len(base), CHUNK):
        z = base[k : k + CHUNK, 0] + 1j * base[k : k + CHUNK, 1]
        base[k : k + CHUNK] = planes_of(
            answered(z, in_frame(z, np), partial(network.moves, head=head), shares, np)
        )
    if head != WINSLOW:
        return base
    counts = (nodes_after(side.shape[-1]) for side in (sides[0], sides[2]))
    finer = refine_quad(base, thinned(sides, *counts))
    z = finer[:, 0] + 1j * finer[:, 1]
    return planes_of(nearer(z, in_frame(z, np), np))


def answered(z: Any, unit: Any, network: Moves, shares: Moves | None, xp: Any, around: bool = False) -> Any:
    """Return grids `z` (batch, n, n) of nodes x + i y, moved by Picard steps and then by a network.

    With `around`, `z` are O grids unrolled to strips (batch, m + 1, n). `unit` has the grids scaled to unit
    size, and factors (batch, 1, 1) that scale them back. `network` returns displacements of nodes. `shares`
    returns factors (batch, 1, 1) on these displacements; None means 1. `xp` is numpy or torch.
    """
    sized, back = unit
    near, step = approach(sized, xp, around)
    move = SCALE * network(near, step)
    if around:
        move = xp.concatenate([move, move[:, :1]], 1)
    if shares is not None:
        move = shares(near, move) * move
    return z + times(near + move - sized, back)


def nearer(z: Any, unit: Any, xp: Any, around: bool = False) -> Any:
    """Return complex grids `z` after Picard steps of Winslow's equations; for parameters, see `answered`."""
    sized, back = unit
    return z + times(approach(sized, xp, around, AFTER, harmonic=False)[0] - sized, back)


def in_frame(z: Any, xp: Any) -> tuple[Any, Any]:
    """Return grids ``(z - centre) * factor`` of area 1, and the complex numbers 1 / factor (batch, 1, 1).

    `z` (batch, n, n) has nodes x + i y. The factor also turns a grid so that xi is along x on average.
    """
    middle, factor = (value[:, None, None] for value in frame(z, xp))
    return times(z - middle, factor), factor.conj() / (factor.real**2 + factor.imag**2)


def _shares(near: Complexes, move: Complexes) -> Floats:
    parts = [share(start, start + by) for start, by in zip(near, move, strict=True)]
    return np.array(parts)[:, None, None]


def share(start: Complexes, answer: Complexes) -> float:
    """Return how much of the step from grid `start` to `answer` can be taken: 1, or less if cells fold."""
    tried = (part for part in (1.0, *SHARES) if not count_folded(pairs_of(start + part * (answer - start))))
    return next(tried, 1.0)
