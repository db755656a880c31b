"""Whether a smoothed grid of volumes is no worse than the one that was given."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.volume.hex_mesh import HexMesh

_SLACK = 1e-9
"""Degrees, and parts of a Jacobian, that rounding may add."""
_NOTHING = 0.05
"""Mean deviation up to which one is as good as the other."""
_GOOD, _PART = 0.7, 0.98
"""Scaled Jacobian from which on one is as good as the other, and the part of a smaller one that must be left."""


@dataclass(frozen=True, eq=False)
class Measures:
    """Folded cells and what must not become worse."""

    folded: int
    mean: float
    """Mean deviation from 90 degrees of the angles at corners, the worst of three."""
    least: float
    """Least scaled Jacobian of a corner."""
    cells: tuple[Floats, ...]
    """Least scaled Jacobian of each cell of each block."""

    def no_worse(self, than: Measures) -> bool:
        """Say whether no figure is worse."""
        if than.folded or self.folded:
            return self.folded < than.folded
        return self.mean <= max(than.mean + _SLACK, _NOTHING) and self.least >= than.bound

    @property
    def bound(self) -> float:
        """Scaled Jacobian that another mesh has to have at least to be no worse."""
        return min(_PART * self.least, _GOOD)

    def bad_cells(self, than: Measures) -> list[np.ndarray]:  # type: ignore[type-arg]
        """Return where (n, 3) in each block cells are folded, or worse than the worst of another grid."""
        bound = 0.0 if self.folded else than.bound
        return [np.argwhere(least <= bound) for least in self.cells]


def measures(mesh: HexMesh) -> Measures:
    """Return the measures of a mesh; corners at which an edge has no length are left out."""
    least, total, count = [], 0.0, 0
    for block in mesh.blocks:
        scaled, deviation, known = _corners(mesh.nodes[block])
        least.append(scaled)
        total, count = total + deviation, count + known
    folded = sum(int(np.count_nonzero(each <= 0.0)) for each in least)
    return Measures(folded, total / max(count, 1), float(min(each.min() for each in least)), tuple(least))


def _corners(nodes: Floats) -> tuple[Floats, float, int]:
    """Return the least scaled Jacobian of each cell, the sum of deviations of corners, and their number."""
    least = np.ones([n - 1 for n in nodes.shape[:3]])
    total, count = 0.0, 0
    for corner in np.ndindex(2, 2, 2):
        edges = [_edges(nodes, corner, axis) for axis in range(3)]
        lengths = [np.sqrt(np.einsum("...c,...c", each, each)) for each in edges]
        known = (lengths[0] > 0) & (lengths[1] > 0) & (lengths[2] > 0)
        u, v, w = (e / np.where(known, n, 1.0)[..., None] for e, n in zip(edges, lengths, strict=True))
        jacobian = np.einsum("...c,...c", u, np.cross(v, w))
        np.minimum(least, np.where(known, jacobian, 1.0), out=least)
        cosine = np.max([np.abs(np.einsum("...c,...c", a, b)) for a, b in ((u, v), (v, w), (w, u))], axis=0)
        total += float(np.degrees(np.arcsin(np.minimum(cosine, 1.0)))[known].sum())
        count += int(known.sum())
    return least, total, count


def _edges(nodes: Floats, corner: Sequence[int], axis: int) -> Floats:
    """Return the edges along a direction at one corner of each cell."""
    steps = np.diff(nodes, axis=axis)
    at = [slice(c, n - 1 + c) for c, n in zip(corner, nodes.shape[:3], strict=True)]
    at[axis] = slice(None)
    return steps[tuple(at)]
