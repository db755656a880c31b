"""Four-sided domains to grids by the quad network: once for a whole batch, at any resolution.

::

    edges -> 33 x 33 of them -> transfinite grid -> middle, turn, size out -> towards Winslow's grid
          -> features -> network -> 33 x 33 grid, its rim that of the edges
          -> splines -> grid at the edges' own counts

Winslow's grid goes over 65 x 65 nodes, where a few steps bring it nearer to its equations.

The last step is that of `solvers.coarse`: the difference from transfinite interpolation is smooth, but near
acute corners (`solvers.acute`), so it is evaluated anywhere and added to the interpolation of the full edges,
which are met bitwise.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from geometry.arrays import Complexes, Floats
from geometry.boundary import Boundary
from solvers import acute
from solvers._evaluate import begin_all, evaluate_all
from solvers.neural.quads._network import look
from solvers.neural.quads.approach import AFTER, approached, nodes_after
from solvers.neural.quads.edges import Edges
from solvers.neural.quads.encoding import LATENT, SCALE, WINSLOW
from solvers.neural.quads.features import FEATURES
from solvers.neural.quads.frame import frame
from solvers.neural.quads.model import QuadModel
from solvers.neural.quads.network import CHUNK
from solvers.spline import places

BATCH = 64
"""Domains in memory at a time at the most."""

CORNERS = [0, 1, -2, -1]
"""Rows and columns of a grid that tell how wide its corners open."""


def coarse_grids(edges: Edges, model: QuadModel, head: int, dtype: str = "float64") -> Floats:
    """Return the planes (batch, 2, m, n) of the network's grids inside the `edges`: 33 x 33 nodes.

    Winslow's have up to 65 along a direction, where the edges have as many.

    Parameters
    ----------
    head : index into `encoding.HEADS`.
    dtype : of the network's arithmetic, ``float64`` or ``float32``; all else is float64.
    """
    base, z, factor = _begun(edges)
    network = model.network(dtype)
    room = np.empty((min(CHUNK, len(base)), LATENT, LATENT, FEATURES), dtype)
    for k in range(0, len(base), CHUNK):
        rows = slice(k, k + CHUNK)
        near, step = approached(z[rows])
        seen = room[: len(near)]
        look(near, step, seen)
        found = near[:, 0] + 1j * near[:, 1] + SCALE * network(seen, head)
        _move(base[rows], found - z[rows], factor[rows])
    return _nearer(base, edges) if head == WINSLOW else base


def near_grids(edges: Edges) -> Floats:
    """Return the planes (batch, 2, n, n) that the network goes out from, at n = 33 nodes each."""
    base, z, factor = _begun(edges)
    near, _ = approached(z)
    _move(base, near[:, 0] + 1j * near[:, 1] - z, factor)
    return base


def _nearer(coarse: Floats, edges: Edges) -> Floats:
    """Return grids `coarse` on more nodes, nearer to Winslow's."""
    planes = evaluate(coarse, edges.thinned(*(nodes_after(n) for n in edges.counts)))
    z = planes[:, 0] + 1j * planes[:, 1]
    middle, factor = (np.asarray(value)[:, None, None] for value in frame(z, np))
    z = (z - middle) * factor
    near, _ = approached(z, steps=AFTER, harmonic=False)
    _move(planes, near[:, 0] + 1j * near[:, 1] - z, factor)
    return planes


def _begun(edges: Edges) -> tuple[Floats, Complexes, Complexes]:
    """Return transfinite grids as planes and, of unit size, as z (batch, n, n), and the factors to it."""
    base = np.empty((len(edges), 2, LATENT, LATENT))
    ni, nj = edges.counts
    begin_all(edges.sides, (places(ni, LATENT), places(nj, LATENT)), base)
    z = base[:, 0] + 1j * base[:, 1]
    middle, factor = (np.asarray(value)[:, None, None] for value in frame(z, np))
    return base, (z - middle) * factor, factor


def _move(planes: Floats, by: Complexes, factor: Complexes) -> None:
    """Add displacements at unit size to planes (batch, 2, n, n)."""
    moved = by / factor
    planes[:, 0] += moved.real
    planes[:, 1] += moved.imag


def evaluate(coarse: Floats, edges: Edges) -> Floats:
    """Return the planes (batch, 2, ni, nj) inside the `edges` of grids `coarse` (batch, 2, m, n)."""
    (m, n), (ni, nj) = coarse.shape[2:], edges.counts
    corners = coarse[:, :, CORNERS][..., CORNERS]
    opened = acute.openings(corners[:, 0] + 1j * corners[:, 1], np).reshape(-1, 4)
    nodes = np.empty((len(edges), 2, ni, nj))
    fine, thin = (places(m, ni), places(n, nj)), (places(ni, m), places(nj, n))
    evaluate_all(coarse, edges.sides, fine, thin, opened, acute.NEAR, acute.FAR, nodes)
    return nodes


def in_batches(boundaries: Sequence[Boundary], threads: int = 1) -> Iterator[list[int]]:
    """Yield indices of boundaries with equal node counts, `BATCH` at the most, each boundary once.

    Batches of one size are about equally large, and as many as keep all `threads` at work to the end.
    """
    groups: dict[tuple[int, int], list[int]] = {}
    for k, boundary in enumerate(boundaries):
        groups.setdefault((boundary.ni, boundary.nj), []).append(k)
    for group in groups.values():
        fewest = -(-len(group) // BATCH)
        count = min(-(-fewest // threads) * threads, len(group))
        for k in range(count):
            yield group[k * len(group) // count : (k + 1) * len(group) // count]
