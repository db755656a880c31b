"""Every k-th node of a grid or boundary: the coarser member of a family whose members share their nodes.

::

    fine      o--o--o--o--o--o--o--o--o       nine nodes, eight cells
    k = 2     o-----o-----o-----o-----o       five of them
    k = 4     o-----------o-----------o       three
"""

from __future__ import annotations

import math
from dataclasses import replace

from meshonet.geometry.arrays import SIDES
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError


def coarser_grid(grid: Grid, k: int) -> Grid:
    """Return the grid of every `k`-th node along both directions, with its patches.

    Raises InputError: `k` does not divide the cells along a direction, or a patch would lose an end.

    >>> import numpy as np
    >>> x, y = np.meshgrid(np.arange(5.0), np.arange(3.0), indexing="ij")
    >>> coarser_grid(Grid.from_nodes(np.stack([x, y], axis=-1)), 2).x[:, 0]
    array([0., 2., 4.])
    """
    _check(grid.ni, grid.nj, k)
    facts = {**grid.provenance, "coarsened": k * int(grid.provenance.get("coarsened", 1))}
    patches = _coarser_patches(grid.patches, k)
    nodes = grid.nodes[::k, ::k]
    return Grid.from_nodes(nodes, grid.topology, patches, grid.name, facts, grid.origin, finite=True)


def coarser_boundary(boundary: Boundary, k: int) -> Boundary:
    """Return the boundary of every `k`-th node, as `coarser_grid` does of a grid."""
    _check(boundary.ni, boundary.nj, k)
    edges = {side: getattr(boundary, side)[::k] for side in SIDES}
    return replace(boundary, **edges, patches=_coarser_patches(boundary.patches, k), sensors=None)


def _check(ni: int, nj: int, k: int) -> None:
    common = math.gcd(ni - 1, nj - 1)
    if k >= 1 and common % k == 0:
        return
    whole = max(k, 1)
    near = [whole * max(1, (n - 1) // whole) + 1 for n in (ni, nj)]
    remedy = f"make the grid with {near[0]}x{near[1]} nodes, say"
    if common > 1:
        remedy = f"use a number that divides {common}, or {remedy}"
    cells = f"{ni}x{nj} nodes are {ni - 1}x{nj - 1} cells, which {k} does not divide"
    raise InputError(cells, remedy)


def _coarser_patches(patches: tuple[Patch, ...], k: int) -> tuple[Patch, ...]:
    for patch in patches:
        for node in (patch.start, patch.stop):
            if node % k:
                end = f"patch {patch.name!r} ends at node {node} of {patch.side}"
                ends = f"make the grid with ends at multiples of {k} ({{wake_nodes}} for a wake)"
                raise InputError(f"{end}, which every {k}-th leaves out", f"{ends}, or coarsen less")
    return tuple(replace(patch, start=patch.start // k, stop=patch.stop // k) for patch in patches)
