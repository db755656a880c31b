"""Restores the heights of boundary layers after an optimisation; the other nodes are then optimised again."""

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices
from meshonet.geometry.elementary import exp, log
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.kernels._native import line_neighbours
from meshonet.solvers.smoothing.wanted_lengths import THIN, thin_heights

ROWS = 200  # largest number of rows of layers


def with_layers(mesh: QuadMesh, original: QuadMesh) -> tuple[QuadMesh, Bools]:
    """Return `mesh` with the layer heights of `original`, and a mask (n,) of the nodes in layers.

    Both meshes have the same quadrilaterals. Layers are rows of thin cells at the boundary. Their nodes are
    moved along grid lines to the distance from the wall that the layer has in `original` at this place. Nodes
    that are in layers of two walls stay.
    """
    lines = _lines(original)
    held = np.zeros(len(original.nodes), dtype=bool)
    if not len(lines.nodes):
        return mesh, held
    claimed = np.bincount(lines.nodes[:, 1:][lines.thin], minlength=len(held))
    heights = _at_new_places(_heights(original.nodes, lines), lines, mesh, original)
    nodes, own = mesh.nodes.copy(), _heights(mesh.nodes, lines)
    for k, line in enumerate(lines.nodes):
        rows = int(lines.thin[k].sum())
        alone = claimed[line[1 : rows + 1]] == 1
        rows = int(np.argmin(alone)) if not alone.all() else rows
        place, wanted = np.cumsum(own[k]), np.cumsum(heights[k])[:rows]
        if not rows or not wanted[-1] < place[-1]:
            continue
        points = mesh.nodes[line]
        for axis in (0, 1):
            moved = np.interp(wanted, np.concatenate([[0.0], place]), points[:, axis])
            nodes[line[1 : rows + 1], axis] = moved
        first = nodes[line[1]] - points[0]  # to the last digit, past the bend of the line at its old place
        nodes[line[1]] = points[0] + first * (wanted[0] / np.hypot(*first))
        held[line[: rows + 1]] = True
    return mesh.with_nodes(nodes), held


@dataclass(frozen=True)
class _WallLines:
    """Lines that leave the boundary: nodes (n, m), wall nodes first, and masks (n, m-1) of thin cells.

    A line that ends earlier repeats its last node. One step beyond the thin cells is included, if there is
    one.
    """

    nodes: Indices
    thin: Bools


def _lines(mesh: QuadMesh) -> _WallLines:
    edge_of = np.ascontiguousarray(mesh.edge_of)
    numbers = np.arange(len(mesh.nodes)), np.arange(len(mesh.edges))
    beside, _ = line_neighbours(np.ascontiguousarray(mesh.quads), edge_of, *numbers)
    thin = _thin(mesh)
    edge = np.flatnonzero(thin_heights(mesh))
    ends = mesh.edges[edge]
    first = mesh.wall_nodes[ends[:, 0]]
    node = np.where(first, ends[:, 1], ends[:, 0])
    nodes, flags = [np.where(first, ends[:, 0], ends[:, 1]), node], [np.ones(len(edge), dtype=bool)]
    going = ~mesh.wall_nodes[node]
    for _ in range(ROWS):
        ahead = beside[edge, 2:]
        on = ((mesh.edges[ahead] == node[:, None, None]).any(axis=2)) & (ahead != edge[:, None])
        going = going & on.any(axis=1) & flags[-1]
        if not going.any():
            break
        edge = np.where(going, ahead[np.arange(len(edge)), on.argmax(axis=1)], edge)
        ends = mesh.edges[edge]
        node = np.where(going, ends.sum(axis=1) - node, node)
        nodes.append(node)
        going = going & ~mesh.wall_nodes[node]
        flags.append(thin[edge] & going)
    return _WallLines(np.stack(nodes, axis=1), np.stack(flags, axis=1))


def _thin(mesh: QuadMesh) -> Bools:
    """Return for each edge (e,) whether it is the short side of all adjacent cells, by `THIN`."""
    ratio = mesh.aspects(mesh.edge_lengths)[:, None]
    short = np.concatenate([ratio, 1.0 / ratio, ratio, 1.0 / ratio], axis=1) > THIN
    wide = np.zeros(len(mesh.edges), dtype=bool)
    wide[mesh.edge_of[~short]] = True
    return ~wide


def _heights(nodes: Floats, lines: _WallLines) -> Floats:
    return np.asarray(np.hypot(*np.moveaxis(np.diff(nodes[lines.nodes], axis=1), -1, 0)))


def _at_new_places(heights: Floats, lines: _WallLines, mesh: QuadMesh, original: QuadMesh) -> Floats:
    """Return heights (n, m) of lines with moved wall nodes, interpolated along the wall."""
    wall = lines.nodes[:, 0]
    new = heights.copy()
    for number, loop in enumerate(original.domain.loops):
        on = np.flatnonzero(original.places.loop[wall] == number)
        old, now = (each.places.arc[wall[on]] for each in (original, mesh))
        for row in range(heights.shape[1] if (old != now).any() else 0):
            known = lines.thin[on, row]
            if known.any():
                values = np.interp(now, old[known], log(heights[on[known], row]), period=loop.length)
                new[on[known], row] = exp(values[known])
    return new
