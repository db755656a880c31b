"""Four-sided domains to grids by the quad network: once for a whole batch, at any resolution.

::

    edges -> 33 x 33 of them -> transfinite grid -> middle, turn, size out -> towards Winslow's grid
          -> features -> network -> 33 x 33 grid, its rim that of the edges; part of the way to it if it folds
          -> splines -> grid at the edges' own counts

Winslow's grid goes over 65 x 65 nodes, where a few steps bring it nearer to its equations. The last step is
`meshonet.solvers.algebraic.resample.quad`, as in `meshonet.solvers.pipeline.coarse`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.quality.measure import count_folded
from meshonet.kernels._native import add_answers, frame_put_back, frame_take_out, grid_features, tfi_coarse
from meshonet.solvers.algebraic.resample import quad as evaluation
from meshonet.solvers.algebraic.resample.spline import between, places
from meshonet.solvers.neural.quad.encoding import FEATURES, LATENT, SCALE, WINSLOW
from meshonet.solvers.neural.quad.network import CHUNK, Network, rim_factor
from meshonet.solvers.neural.quad.picard import AFTER, nodes_after, step_all

SHARES = (0.95, 0.9, 0.8)  # of the way to the network's answer, the first without folds; else all
Sides = tuple[Floats, Floats, Floats, Floats]  # of south, north, west and east


@dataclass(frozen=True)
class Edges:
    """South, north (batch, 2, ni), west and east (batch, 2, nj) of a batch of domains."""

    south: Floats
    north: Floats
    west: Floats
    east: Floats

    @classmethod
    def of(cls, boundaries: Sequence[Boundary]) -> Edges:
        """Return the edges of boundaries that have the same node counts."""
        names = ("south", "north", "west", "east")
        return cls(*(_planes([getattr(boundary, name) for boundary in boundaries]) for name in names))

    def __len__(self) -> int:
        return len(self.south)

    def __getitem__(self, rows: slice) -> Edges:
        return Edges(*(side[rows] for side in self.sides))

    @property
    def sides(self) -> Sides:
        """South, north, west and east."""
        return self.south, self.north, self.west, self.east

    @property
    def counts(self) -> tuple[int, int]:
        """Nodes along xi and eta."""
        return self.south.shape[-1], self.west.shape[-1]

    def thinned(self, ni: int, nj: int) -> Edges:
        """Return the edges with ni and nj nodes, at equal steps of the index of the given ones."""
        south, north = between(self.south, ni), between(self.north, ni)
        return Edges(south, north, between(self.west, nj), between(self.east, nj))

    def transfinite(self, m: int, n: int) -> Floats:
        """Return the planes (batch, 2, m, n) of transfinite interpolation between edges, by their lengths."""
        nodes, (ni, nj) = np.empty((len(self), 2, m, n)), self.counts
        tfi_coarse(self.sides, (places(ni, m), places(nj, n)), nodes)
        return nodes


def rims(planes: Floats) -> Sides:
    """Return south, north, west and east of grids (batch, 2, m, n)."""
    return planes[..., 0], planes[..., -1], planes[:, :, 0], planes[:, :, -1]


def _planes(edges: Sequence[Floats]) -> Floats:
    return np.ascontiguousarray(np.moveaxis(np.stack(edges), -1, 1))


def coarse_grids(edges: Edges, network: Network, head: int) -> Floats:
    """Return the planes (batch, 2, m, n) of the network's grids inside the `edges`: 33 x 33 nodes.

    Winslow's have up to 65 along a direction, where the edges have as many. `head`: index into
    `encoding.HEADS`.
    """
    base = edges.transfinite(LATENT, LATENT)
    room = np.empty((min(CHUNK, len(base)), LATENT, LATENT, FEATURES), network.dtype)
    for k in range(0, len(base), CHUNK):
        planes = base[k : k + CHUNK]
        unit, factors = _unit(planes)
        near = unit.copy()
        step, seen = step_all(near), room[: len(near)]
        grid_features(near, step, seen)
        start = near.copy()
        add_answers(near, network.answers(seen), head, SCALE * rim_factor(LATENT, LATENT, around=False))
        for grid, before in () if head == WINSLOW else zip(near, start, strict=True):
            if (part := share(before, grid)) < 1.0:
                grid[:] = before + part * (grid - before)
        frame_put_back(planes, near, unit, factors)
    return _nearer(base, edges) if head == WINSLOW else base


def _nearer(coarse: Floats, edges: Edges) -> Floats:
    planes = refine_coarse(coarse, edges.thinned(*(nodes_after(n) for n in edges.counts)))
    unit, factors = _unit(planes)
    near = unit.copy()
    step_all(near, steps=AFTER, harmonic=False)
    frame_put_back(planes, near, unit, factors)
    return planes


def _unit(planes: Floats) -> tuple[Floats, Floats]:
    """Return planes at unit size (`encoding.frame`), and the factors (batch, 2) to it."""
    unit, factors = np.empty_like(planes), np.empty((len(planes), 2))
    frame_take_out(planes, unit, factors)
    return unit, factors


def refine_coarse(coarse: Floats, edges: Edges) -> Floats:
    """Return the planes (batch, 2, ni, nj) inside the `edges` of grids `coarse` (batch, 2, m, n)."""
    return evaluation.refine_quad(coarse, edges.sides)


def share(start: Floats, answer: Floats) -> float:
    """Return the share of the step from `start` to `answer`, planes (2, m, n), to take: 1 unless it folds."""
    if count_folded(answer.transpose(1, 2, 0)) == 0:
        return 1.0
    tried = ((part, start + part * (answer - start)) for part in SHARES)
    return next((part for part, grid in tried if count_folded(grid.transpose(1, 2, 0)) == 0), 1.0)
