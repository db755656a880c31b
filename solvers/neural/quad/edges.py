"""The edges of many four-sided domains with the same node counts, and their transfinite grids."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.kernels._native import tfi_batch
from meshonet.solvers.algebraic.resample.spline import between

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

    def laws(self) -> Sides:
        """Return the fraction of an edge's length up to each node, (batch, n) for each side, 0 to 1."""
        south, north, west, east = (_fraction(side) for side in self.sides)
        return south, north, west, east

    def interpolated(self, laws: Sides) -> Floats:
        """Return the planes (batch, 2, ni, nj) of transfinite interpolation with `laws` along the edges."""
        nodes = np.empty((len(self), 2, *self.counts))
        tfi_batch(nodes, tuple(map(np.ascontiguousarray, self.sides)), laws)
        return nodes


def rims(planes: Floats) -> Sides:
    """Return south, north, west and east of grids (batch, 2, m, n)."""
    return planes[..., 0], planes[..., -1], planes[:, :, 0], planes[:, :, -1]


def _fraction(side: Floats) -> Floats:
    steps = np.diff(side)
    along = np.zeros((len(side), side.shape[-1]))
    steps *= steps
    np.cumsum(np.sqrt(steps[:, 0] + steps[:, 1]), axis=-1, out=along[:, 1:])
    along /= along[:, -1:]
    return along


def _planes(edges: Sequence[Floats]) -> Floats:
    return np.ascontiguousarray(np.moveaxis(np.stack(edges), -1, 1))
