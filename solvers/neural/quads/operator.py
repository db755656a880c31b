"""Four-sided domains to grids by the quad network: once for a whole batch, at any resolution.

::

    edges -> 33 x 33 of them -> transfinite grid -> middle, turn, size out -> towards Winslow's grid
          -> features -> network -> 33 x 33 grid, its rim that of the edges; part of the way to it if it folds
          -> splines -> grid at the edges' own counts

Winslow's grid goes over 65 x 65 nodes, where a few steps bring it nearer to its equations. The last step is
`meshonet.solvers.algebraic.resample.quad`, as in `meshonet.solvers.pipeline.coarse`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.kernels._native import add_answers, frame_put_back, frame_take_out, grid_features, tfi_coarse
from meshonet.solvers.algebraic.resample import quad as evaluation
from meshonet.solvers.algebraic.resample.spline import places
from meshonet.solvers.neural.quads.damping import share
from meshonet.solvers.neural.quads.edges import Edges
from meshonet.solvers.neural.quads.encoding import LATENT, SCALE, WINSLOW
from meshonet.solvers.neural.quads.features import FEATURES
from meshonet.solvers.neural.quads.model import QuadModel
from meshonet.solvers.neural.quads.network import CHUNK, rim_factor
from meshonet.solvers.neural.quads.picard import AFTER, nodes_after, step_all

BATCH = 64
"""Domains in memory at a time at the most."""


def coarse_grids(edges: Edges, model: QuadModel, head: int, dtype: str = "float64") -> Floats:
    """Return the planes (batch, 2, m, n) of the network's grids inside the `edges`: 33 x 33 nodes.

    Winslow's have up to 65 along a direction, where the edges have as many.

    Parameters
    ----------
    head : index into `encoding.HEADS`.
    dtype : of the network's arithmetic, ``float64`` or ``float32``; all else is float64.
    """
    base, network = _begun(edges), model.network(dtype)
    room = np.empty((min(CHUNK, len(base)), LATENT, LATENT, FEATURES), dtype)
    for k in range(0, len(base), CHUNK):
        planes = base[k : k + CHUNK]
        unit, factors = _unit(planes)
        near = unit.copy()
        step, seen = step_all(near), room[: len(near)]
        grid_features(near, step, seen)
        start = near.copy()
        add_answers(near, network.answers(seen), head, SCALE * rim_factor(LATENT, LATENT, around=False))
        for one, other in () if head == WINSLOW else zip(near, start, strict=True):
            if (part := share(other, one)) < 1.0:
                one[:] = other + part * (one - other)
        frame_put_back(planes, near, unit, factors)
    return _nearer(base, edges) if head == WINSLOW else base


def near_grids(edges: Edges) -> Floats:
    """Return the planes (batch, 2, n, n) that the network goes out from, at n = 33 nodes each."""
    base = _begun(edges)
    unit, factors = _unit(base)
    near = unit.copy()
    step_all(near)
    frame_put_back(base, near, unit, factors)
    return base


def _nearer(coarse: Floats, edges: Edges) -> Floats:
    """Return grids `coarse` on more nodes, nearer to Winslow's."""
    planes = evaluate(coarse, edges.thinned(*(nodes_after(n) for n in edges.counts)))
    unit, factors = _unit(planes)
    near = unit.copy()
    step_all(near, steps=AFTER, harmonic=False)
    frame_put_back(planes, near, unit, factors)
    return planes


def _begun(edges: Edges) -> Floats:
    """Return transfinite grids as planes (batch, 2, n, n) at n = 33 nodes each."""
    base = np.empty((len(edges), 2, LATENT, LATENT))
    ni, nj = edges.counts
    tfi_coarse(edges.sides, (places(ni, LATENT), places(nj, LATENT)), base)
    return base


def _unit(planes: Floats) -> tuple[Floats, Floats]:
    """Return planes at unit size (`meshonet.solvers.neural.quads.frame`), and the factors (batch, 2) to it."""
    unit, factors = np.empty_like(planes), np.empty((len(planes), 2))
    frame_take_out(planes, unit, factors)
    return unit, factors


def evaluate(coarse: Floats, edges: Edges) -> Floats:
    """Return the planes (batch, 2, ni, nj) inside the `edges` of grids `coarse` (batch, 2, m, n)."""
    return evaluation.evaluate(coarse, edges.sides)


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
