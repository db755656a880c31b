"""Distances between the nodes of two grids of the same size."""

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError

NEAR = 0.1  # fraction of the rows that are near the wall


@dataclass(frozen=True)
class Difference:
    """Distances between the nodes of two grids, in the unit of length of the grids."""

    max: float
    mean: float
    at: tuple[int, ...]  # node with the largest distance: (i, j), or with blocks (block, i, j[, k])
    relative_l2: float  # root mean square distance, divided by that of the reference nodes from their mean
    near_wall: float  # the same for the tenth of all rows nearest to j = 0; with blocks, to walls
    boundary: float  # largest distance on outer sides, in O grids on body and far field


def compare(grid: Grid, reference: Grid) -> Difference:
    """Return distances of nodes from the nodes of `reference`. Raises InputError if node counts differ."""
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
    """Return the values (n,) at a patch, in a fraction `part` of all rows, at least one."""
    axis, end = patch.place
    rows = np.moveaxis(values, axis, 0)[:: -1 if end else 1]
    spans = patch.range(rows.shape[1:])
    inside = tuple(slice(first, last + 1) for first, last in spans)
    return rows[(slice(max(1, round(part * len(rows)))), *inside)].ravel()


def _root_mean_square(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))
