"""The layout of a multi-block grid: shared nodes, and the domain bounded by its outer sides.

The loops are splines through the boundary nodes, with corners where they turn or their name changes, and
where other than two cells meet.
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from meshonet.geometry.arrays import Floats, Indices
from meshonet.geometry.blocks.across import planar
from meshonet.geometry.blocks.block import Block, face_of
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.meeting_sides import AROUND
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.blocks.shared_nodes import node_table
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.domain.periodic import Periodic
from meshonet.geometry.errors import InputError
from meshonet.geometry.layout.lattice import lattice_quads
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.geometry.polygon.area import polygon_area
from meshonet.geometry.polygon.corners import find_corners


def layout_of(grid: Grid) -> Layout:
    """Return the layout with the blocks, nodes and patches of a planar grid.

    Raises InputError: a block that is not planar or is left-handed; outer sides that do not form closed
    loops; overlapping blocks; sides that are periodic by a rotation.
    """
    planar(grid)
    nodes, numbers = node_table(grid.blocks, grid.connections)
    quads = lattice_quads(numbers)
    valence = np.bincount(quads.ravel(), minlength=len(nodes))
    rings = _rings(_boundary(grid, numbers), nodes)
    loops = tuple(_loop(ring, nodes, valence) for ring in rings)
    places = _places(rings, loops, valence, len(nodes))
    shift, first, second = _pairs(grid, numbers)
    places.partner[second] = first
    periodic: tuple[Periodic, ...] = ()
    if len(first):
        sides = [_stretch(rings[0], loops[0], side) for side in (first, second)]
        periodic = (Periodic(sides[0], sides[1], (float(shift[0]), float(shift[1]))),)
    domain = Domain(loops, grid.name, periodic=periodic)
    return Layout(QuadMesh(domain, nodes, quads, places), numbers)


def with_nodes(grid: Grid, layout: Layout) -> Grid:
    """Return `grid` with the nodes of `layout`, a layout that was made from it and whose nodes have moved."""
    nodes = layout.mesh.nodes
    return replace(grid, blocks=tuple(Block(nodes[block]) for block in layout.blocks))


@dataclass(frozen=True)
class _Ring:
    """A closed boundary, the domain on the left of its nodes, and the name of the edge after each node."""

    nodes: Indices
    names: tuple[str, ...]


def _boundary(grid: Grid, numbers: tuple[Indices, ...]) -> dict[int, tuple[int, str]]:
    """Return, for each boundary node, the next one (domain on the left) and the name of the edge between."""
    after: dict[int, tuple[int, str]] = {}
    named = {(p.name, p.block, p.side) for p in grid.patches}
    for patch in [*grid.outer_patches(), *_periodic_sides(grid)]:
        line = face_of(numbers[patch.block], patch.side)[patch.start : patch.stop + 1]
        for a, b in pairwise(line[:: AROUND[patch.side]].tolist()):
            if a in after:
                x, y = grid.face(patch.block, patch.side)[int(np.argmax(line == a))]
                problem = f"blocks overlap at ({x:.6g}, {y:.6g}) of block {patch.block}"
                raise InputError(problem, "check that a side is connected to one other")
            after[a] = (b, patch.name if (patch.name, patch.block, patch.side) in named else "outer")
    return after


def _periodic_sides(grid: Grid) -> list[Patch]:
    """Return both sides of periodic connections, with their own names or ``periodic1`` and ``periodic2``."""
    sides = []
    for each in grid.connections:
        for k, number in enumerate((each.block, each.donor) if each.transform else ()):
            side, start, stop = each.stretches(number)[k if each.block == each.donor else 0]
            names = [p.name for p in grid.patches if (p.block, p.side) == (number, side)]
            name = names[-1] if names else f"periodic{k + 1}"
            sides.append(Patch(name, side, start, stop, block=number))
    return sides


def _rings(after: dict[int, tuple[int, str]], nodes: Floats) -> list[_Ring]:
    """Return the closed boundaries, starting with the one that encloses the largest area."""
    rings, left = [], dict(after)
    while left:
        start = min(left)
        line, names, node = [], [], start
        while node in left:
            line.append(node)
            node, name = left.pop(node)
            names.append(name)
        if node != start:
            x, y = nodes[node]
            raise InputError(f"outer sides end at ({x:.6g}, {y:.6g})", "check the connections of the blocks")
        rings.append(_Ring(np.array(line, dtype=np.intp), tuple(names)))
    areas = [polygon_area(nodes[ring.nodes]) for ring in rings]
    if not max(areas, default=0.0) > 0:
        raise InputError("the blocks have no outer boundary, or are left-handed", "give right-handed blocks")
    return [rings[k] for k in sorted(range(len(rings)), key=lambda k: -areas[k])]


def _loop(ring: _Ring, nodes: Floats, valence: Indices) -> Loop:
    points = nodes[ring.nodes]
    corner = valence[ring.nodes] != 2
    corner |= np.array(
        [name != before for name, before in zip(ring.names, (ring.names[-1], *ring.names[:-1]), strict=True)]
    )
    corner[find_corners(points, closed=True)] = True
    corners = tuple(np.flatnonzero(corner).tolist())
    names = tuple(ring.names[k] for k in corners) or ring.names[:1]
    return Loop(Curve(points, closed=True, corners=corners), corners, names)


def _places(rings: list[_Ring], loops: tuple[Loop, ...], valence: Indices, count: int) -> Places:
    places = Places.inside(count)
    for number, (ring, loop) in enumerate(zip(rings, loops, strict=True)):
        places.loop[ring.nodes] = number
        places.arc[ring.nodes] = loop.curve.knots
        corners = ring.nodes[list(loop.corners)]
        places.cells[corners] = valence[corners]
    return places


def _pairs(grid: Grid, numbers: tuple[Indices, ...]) -> tuple[Floats, Indices, Indices]:
    """Return the shift of periodic sides, and the node numbers (n,) that it moves, and to which (n,)."""
    shift = np.zeros(2)
    first, second = list[Indices](), list[Indices]()
    for each in grid.connections:
        if each.transform is None:
            continue
        if each.transform.turn and not np.array_equal(each.transform.turn, np.eye(2)):
            problem = f"{each} is periodic by a rotation"
            raise InputError(problem, "give sides that are periodic by a shift")
        own, donor = each.pairs(numbers)
        way = np.array(each.transform.shift)
        if not first:
            shift = way
        size = np.hypot(*shift)
        if np.hypot(*(way - shift)) > 1e-9 * size:
            own, donor, way = donor, own, -way
        if np.hypot(*(way - shift)) > 1e-9 * size:
            problem = f"{each} is shifted otherwise than the others"
            raise InputError(problem, "give blocks that are periodic in one direction")
        first.append(own.ravel())
        second.append(donor.ravel())
    none = [np.empty(0, dtype=np.intp)]
    return shift, np.concatenate(first or none), np.concatenate(second or none)


def _stretch(ring: _Ring, loop: Loop, nodes: Indices) -> tuple[float, float]:
    """Return the arc lengths at which a run of `nodes` along the loop begins and ends; InputError: no run."""
    among = np.isin(ring.nodes, nodes)
    begins = np.flatnonzero(among & ~np.roll(among, 1))
    ends = np.flatnonzero(among & ~np.roll(among, -1))
    if len(begins) != 1:
        raise InputError("periodic sides are not one stretch of the outer boundary", "connect all of them")
    return float(loop.curve.knots[begins[0]]), float(loop.curve.knots[ends[0]])
