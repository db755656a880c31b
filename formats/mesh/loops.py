"""Closed curves from named edges in any order and direction, and default names of outer edges."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from meshonet.formats.mesh.cell_faces import faces_of
from meshonet.formats.mesh.unstructured import node_numbers, points_of
from meshonet.geometry.arrays import Floats, Indices
from meshonet.geometry.blocks.block import face_of
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import polygon_area


@dataclass(frozen=True)
class EdgeLoop:
    """A closed curve: its point numbers (n,) in order, and the name of the edge that starts at each point."""

    nodes: Indices
    names: tuple[str, ...]

    def reversed(self) -> "EdgeLoop":
        """Return the curve in the opposite direction, with the same first point."""
        return EdgeLoop(np.roll(self.nodes[::-1], 1), self.names[::-1])

    def begun_at(self, place: int) -> "EdgeLoop":
        """Return the curve with its point at index `place` as the first."""
        return EdgeLoop(np.roll(self.nodes, -place), (*self.names[place:], *self.names[:place]))

    @property
    def changes(self) -> list[int]:
        """Indices of the points at which the name of the edges changes."""
        return [k for k in range(len(self.names)) if self.names[k] != self.names[k - 1]]


def closed_loops(edges: Mapping[str, Indices], points: Floats) -> list[EdgeLoop]:
    """Return the closed curves that named edges (k, 2) form, each in the direction of its first edge.

    Raises InputError if one edge, or more than two edges, end at a point.
    """
    ends = np.concatenate([np.empty((0, 2), np.int64), *edges.values()])
    names = [name for name, rows in edges.items() for _ in range(len(rows))]
    met = np.bincount(ends.ravel(), minlength=len(points))
    for node in np.flatnonzero((met != 0) & (met != 2))[:1]:
        x, y = points[node]
        problem = "one edge ends" if met[node] == 1 else f"{met[node]} edges meet"
        remedy = "the boundary has to consist of closed curves"
        raise InputError(f"{problem} at ({x:.6g}, {y:.6g})", remedy, place="boundary")
    order = np.argsort(ends.ravel(), kind="stable")
    twin = np.empty(len(order), np.int64)  # the other place where the same point stands
    twin[order[0::2]], twin[order[1::2]] = order[1::2], order[0::2]
    return _followed(ends.ravel().tolist(), twin.tolist(), names)


def _followed(flat: list[int], twin: list[int], names: list[str]) -> list[EdgeLoop]:
    loops, used = [], [False] * len(names)
    for first in range(len(names)):
        if used[first]:
            continue
        nodes, own, at = [], [], 2 * first  # a place in `flat`; the edge goes from there to its partner
        while not used[at // 2]:
            used[at // 2] = True
            nodes.append(flat[at])
            own.append(names[at // 2])
            at = twin[at ^ 1]
        loops.append(EdgeLoop(np.array(nodes, np.int64), tuple(own)))
    return loops


def with_loop_names(grid: Grid) -> Grid:
    """Return a planar grid whose unnamed boundaries are patches ``outer``, ``body``, ``body2`` and so on."""
    outer = grid.outer_patches()
    unnamed = [
        p
        for p in outer
        if not any(
            (n.block, n.side, n.name) == (p.block, p.side, p.name) and n.start <= p.start and p.stop <= n.stop
            for n in grid.patches
        )
    ]
    if not unnamed:
        return grid
    numbers = node_numbers(grid)
    titles = _titles(grid, numbers, outer)
    taken = {patch.name for patch in grid.patches}
    new = []
    for patch in unnamed:
        line = face_of(numbers[patch.block], patch.side)[patch.start : patch.stop + 1]
        title = titles.get(int(line[0]), titles.get(int(line[-1]), "outer"))
        new.append(replace(patch, name=title if title not in taken else f"{title}-unnamed", kind="other"))
    return replace(grid, patches=(*grid.patches, *new))


def _titles(grid: Grid, numbers: list[Indices], outer: list[Patch]) -> dict[int, str]:
    """Return the name of the curve of each outer node; periodic sides belong to curves."""
    ends = [(p.block, p.side, p.start, p.stop) for p in outer]
    for each in grid.connections:
        if each.transform:
            ends += [(block, side, *span[0]) for block, side, span in each.ends]
    rows = [faces_of(face_of(numbers[k], side)[start : stop + 1], side) for k, side, start, stop in ends]
    points = points_of(grid, numbers)
    try:
        loops = closed_loops({"": np.concatenate(rows)}, points)
    except InputError:  # lines that touch: they count as one
        return {}
    outermost, *others = sorted(loops, key=lambda loop: -abs(polygon_area(points[loop.nodes])))
    names = [(outermost, "outer")]
    names += [(loop, "body" if k == 1 else f"body{k}") for k, loop in enumerate(others, start=1)]
    return {int(node): name for loop, name in names for node in loop.nodes}
