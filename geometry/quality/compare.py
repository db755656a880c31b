"""Distances between the nodes of two grids of the same size, and pairs of grids of two sets."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import repeat
from typing import Literal, TypeAlias

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError

NEAR = 0.1
"""Fraction of the rows that are near the wall."""


@dataclass(frozen=True)
class Difference:
    """Distances between the nodes of two grids, in their unit of length."""

    max: float
    mean: float
    at: tuple[int, ...]
    """Node with the largest distance: (i, j), in multi-block grids (block, i, j) or (block, i, j, k)."""
    relative_l2: float
    """Root mean square distance, divided by the root mean square distance of the reference nodes from their
    mean.
    """
    near_wall: float
    """The same for the tenth of all rows nearest to j = 0; in multi-block grids nearest to walls."""
    boundary: float
    """Largest distance on the four sides, in O grids on body and far field, in multi-block grids on outer
    sides.
    """


def compare(grid: Grid, reference: Grid) -> Difference:
    """Return the distances between the nodes of `grid` and those of `reference`.

    Raises InputError: their node counts differ.
    """
    many = "blocks" in (grid.topology, reference.topology)
    _check_sizes(grid, reference, many=many)
    pairs = zip(grid.blocks, reference.blocks, strict=True)
    away = [norms(own.nodes - other.nodes) for own, other in pairs]
    if many:
        near = [_beside(away[wall.block], wall, NEAR) for wall in grid.walls()] or [a.ravel() for a in away]
        outer = [_beside(away[patch.block], patch, 0.0) for patch in grid.outer_patches()]
    else:
        near = [away[0][:, : max(1, round(NEAR * grid.nj))].ravel()]
        outer = [away[0][:, 0], away[0][:, -1]]
        if not grid.periodic:  # the seam of an O grid is no boundary
            outer += [away[0][0], away[0][-1]]
    worst = int(np.argmax([distances.max() for distances in away]))
    at = tuple(int(k) for k in np.unravel_index(int(away[worst].argmax()), away[worst].shape))
    nodes = np.concatenate([b.nodes.reshape(-1, b.nodes.shape[-1]) for b in reference.blocks])
    spread = _root_mean_square(norms(nodes - nodes.mean(axis=0)))
    extent = max(spread, float(np.finfo(float).tiny))  # all nodes may coincide
    every = np.concatenate([distances.ravel() for distances in away])
    return Difference(
        max=float(every.max()),
        mean=float(every.mean()),
        at=(worst, *at) if many else at,
        relative_l2=_root_mean_square(every) / extent,
        near_wall=_root_mean_square(np.concatenate(near)) / extent,
        boundary=max((float(side.max()) for side in outer), default=0.0),
    )


def _check_sizes(grid: Grid, reference: Grid, *, many: bool) -> None:
    sizes, others = ([block.counts for block in each.blocks] for each in (grid, reference))
    if [b.nodes.shape for b in grid.blocks] == [b.nodes.shape for b in reference.blocks]:
        return
    if not many:
        counts = f"{grid.ni}x{grid.nj} nodes are not comparable with {reference.ni}x{reference.nj}"
        raise InputError(counts, "compare grids of one size")
    counts = f"{len(sizes)} blocks are not comparable with {len(others)}"
    k = next((k for k, pair in enumerate(zip(sizes, others, strict=False)) if pair[0] != pair[1]), None)
    if len(sizes) == len(others) and k is not None:
        own, other = ("x".join(map(str, size[k])) for size in (sizes, others))
        counts = f"block {k} of {own} nodes is not comparable with one of {other}"
    raise InputError(counts, "compare grids of the same blocks")


def _beside(values: Floats, patch: Patch, part: float) -> Floats:
    """Return the values (n,) at a patch and in a fraction `part` of all rows next to it, at least one."""
    axis, end = patch.place
    rows = np.moveaxis(values, axis, 0)[:: -1 if end else 1]
    spans = patch.range(rows.shape[1:])
    inside = tuple(slice(first, last + 1) for first, last in spans)
    return rows[(slice(max(1, round(part * len(rows)))), *inside)].ravel()


def _root_mean_square(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))


Pairing: TypeAlias = Literal["auto", "name", "order"]


class GridMatcher:
    """Finds for each of many grids its partner in a reference set, which is read only as far as needed.

    Grids are paired by ``name`` or by ``order``. ``auto``: a single reference grid serves for all; several
    are paired by name if they have different names, one of which is that of the first grid, else by order.
    """

    def __init__(self, grids: Iterator[Grid], pairing: Pairing = "auto") -> None:
        self._grids = grids
        self._pairing = pairing
        self._passed: list[Grid] = []

    def match(self, name: str) -> Grid:
        """Return the partner of the next grid; `name` is the name of this grid.

        Raises InputError: the reference set has no grid of this name, or no further grid.
        """
        if self._pairing == "auto":
            self._pairing = self._decided(name)
        if self._pairing == "name":
            grid = self._named(name)
        else:
            grid = self._passed.pop(0) if self._passed else next(self._grids, None)
        if grid is None:
            remedy = "compare with one grid, or with as many"
            if self._pairing == "name":
                remedy = f"compare with one that is called {name!r}, or use {{pair}} order"
            raise InputError("there is no grid to compare it with", remedy)
        return grid

    def _decided(self, name: str) -> Pairing:
        self._passed = [grid for _, grid in zip(range(2), self._grids, strict=False)]
        names = [grid.name for grid in self._passed]
        if len(names) == 1:
            self._grids = repeat(self._passed.pop())
            return "order"
        if not all(names) or names[0] == names[1]:
            return "order"
        match = self._named(name)
        if match is None:
            return "order"
        self._passed.insert(0, match)
        return "name"

    def _named(self, name: str) -> Grid | None:
        for k, grid in enumerate(self._passed):
            if grid.name == name:
                return self._passed.pop(k)
        for grid in self._grids:
            if grid.name == name:
                return grid
            self._passed.append(grid)
        return None
