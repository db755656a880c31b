"""Grids made of another's nodes: every k-th of them, at unit size, or turned by a quarter.

::

    fine      o--o--o--o--o--o--o--o--o       nine nodes, eight cells
    k = 2     o-----o-----o-----o-----o       five of them, which the members of a family share

        north                 west                turned: old east becomes south, old west north, old
    west     east   ->   south    north           south west and old north east; the latter two are
        south                 east                counted from their other end
"""

import math
from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import SIDES, Side
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError

_SIDES: dict[Side, Side] = {"east": "south", "west": "north", "south": "west", "north": "east"}


def coarser_grid(grid: Grid, k: int) -> Grid:
    """Return the grid of every `k`-th node along both directions, its patches along.

    Raises InputError: `k` does not divide the cells along a direction, or a patch would lose an end.
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


def normalised(grid: Grid) -> Grid:
    """Return `grid` moved, scaled and, around a body, turned to unit size.

    Of an O or C grid the trailing edge, where xi begins on the body, comes to (1, 0), and the body's farthest
    node from it to (0, 0). Of a four-sided grid the lower left corner of its box comes to (0, 0) and the
    longer side of the box becomes 1.

    Raises InputError: the body has no length.
    """
    if not grid.around_body:
        corner = grid.nodes.min(axis=(0, 1))
        return grid.with_nodes((grid.nodes - corner) / np.ptp(grid.nodes, axis=(0, 1)).max())
    body = grid.nodes[grid.wake : grid.ni - grid.wake, 0]
    trailing = body[0]
    leading = body[np.hypot(*(body - trailing).T).argmax()]
    ax, ay = trailing - leading
    square = ax * ax + ay * ay
    if not square > 0:
        raise InputError("the body has no length", "check that its side is the south one")
    # written out, not as a matrix product: nodes that coincide have to go on doing so bitwise
    x, y = grid.x - leading[0], grid.y - leading[1]
    nodes = np.stack([(x * ax + y * ay) / square, (y * ax - x * ay) / square], axis=-1)
    return grid.with_nodes(nodes)


def turned(grid: Grid) -> Grid:
    """Return `grid` with node (i, j) at (j, ni-1-i), its patches along.

    Raises InputError: an O or C grid, whose xi runs around the body by definition.
    """
    if grid.around_body:
        raise InputError(f"topology {grid.topology} has xi around the body", "swap four-sided grids only")
    patches = tuple(turned_patch(patch, grid.ni - 1) for patch in grid.patches)
    block = Block(np.swapaxes(grid.nodes, 0, 1)[:, ::-1], finite=True)
    return replace(grid, blocks=(block,), patches=patches)


def turned_patch(patch: Patch, last: int) -> Patch:
    """Return a patch of a block whose last node along xi has the number `last`, turned as `turned` does."""
    side, start, stop = _SIDES[patch.side], patch.start, patch.stop
    if patch.side in ("south", "north"):
        start, stop = last - stop, last - start
    return replace(patch, side=side, start=start, stop=stop)
