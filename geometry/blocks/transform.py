"""Grids coarsened to every k-th node, scaled to unit size, or with xi and eta exchanged.

::

    fine      o--o--o--o--o--o--o--o--o       nine nodes, eight cells
    k = 2     o-----o-----o-----o-----o       five of the same nodes, four cells

        north                 west                turned: old east becomes south, old west north, old
    west     east   ->   south    north           south west and old north east; nodes of the latter
        south                 east                two are counted from their other end
"""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from meshonet.geometry.arrays import SIDES, Floats, Side
from meshonet.geometry.blocks.block import Block, part_of
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.blocks.shared_nodes import with_equal_nodes
from meshonet.geometry.errors import InputError, in_place
from meshonet.geometry.polygon.corners import find_corners

_SIDES: dict[Side, Side] = {"east": "south", "west": "north", "south": "west", "north": "east"}
_LENGTHS = "wall_spacing", "spacing_"  # first words of the provenance entries that are lengths
_MOST_SCALED = 1e12  # factor beyond which a change of unit is a mistake
_COUNTED_BACK = ("south", "north")  # sides whose nodes are counted from the other end after a grid is turned


def coarser_grid(grid: Grid, k: int) -> Grid:
    """Return the grid that consists of every `k`-th node along all directions, with its patches.

    In a multi-block grid every block is coarsened, and its connections are kept.

    Raises InputError: `k` does not divide the number of cells along a direction; an end of a patch or
    connection, or a corner of the outline of a planar grid, is at a node that is not kept.
    """
    for number, block in enumerate(grid.blocks):
        with in_place(f"block {number}" if grid.topology == "blocks" else ""):
            _check(block.counts, k, blocks=grid.topology == "blocks")
    kept = math.gcd(*(n - 1 for block in grid.blocks for n in block.counts))
    _check_corners(_corners_of_patches(grid), k, kept)
    patches = _coarser_patches(grid.patches, k)
    connections = []
    for each in grid.connections:
        for first, last in (*each.range, *each.donor_range):
            if first % k or last % k:
                problem = f"{each} runs from node {first} to {last}, which every {k}-th leaves out"
                raise InputError(problem, f"make the grid with ends at multiples of {k}, or coarsen less")
        spans = [tuple((a // k, b // k) for a, b in span) for span in (each.range, each.donor_range)]
        connections.append(replace(each, range=spans[0], donor_range=spans[1]))
    facts = {**grid.provenance, "coarsened": k * int(grid.provenance.get("coarsened", 1))}
    every = slice(None, None, k)
    blocks = tuple(Block(block.nodes[(every,) * len(block.counts)], finite=True) for block in grid.blocks)
    return replace(grid, blocks=blocks, patches=patches, connections=tuple(connections), provenance=facts)


def coarser_boundary(boundary: Boundary, k: int) -> Boundary:
    """Return the boundary that consists of every `k`-th node, with its patches (see `coarser_grid`)."""
    _check((boundary.ni, boundary.nj), k)
    sides = ((side, 0, getattr(boundary, side), boundary.periodic) for side in SIDES)
    _check_corners(_corners_of(sides), k, math.gcd(boundary.ni - 1, boundary.nj - 1))
    edges = {side: getattr(boundary, side)[::k] for side in SIDES}
    return replace(boundary, **edges, patches=_coarser_patches(boundary.patches, k), sensors=None)


_Corners: TypeAlias = list[tuple[str, int, Floats]]
"""For each side with corners: its name, and the indices and positions of the corner nodes."""


def _corners_of_patches(grid: Grid) -> _Corners:
    """Return the corners inside patches, in volumes inside walls; ends of patches are checked separately."""
    if grid.form != "plane":
        walls = (patch for patch in grid.patches if patch.kind == "wall" and grid.form == "volume")
        return [corner for patch in walls for corner in _corners_in_space(grid, patch)]
    ring = grid.periodic
    lines = (
        (patch.side, patch.start, grid.face(patch.block, patch.side)[patch.start : patch.stop + 1], ring)
        for patch in grid.patches
    )
    return _corners_of(lines)


def _corners_in_space(grid: Grid, patch: Patch) -> _Corners:
    """Return the corners of three lines along each direction of a patch in space."""
    face = grid.face(patch.block, patch.side)
    span = patch.range(face.shape[:-1])
    nodes = part_of(face, span)
    lines = (
        (patch.side, first, np.take(nodes, k * (nodes.shape[across] - 1) // 2, axis=across), False)
        for (first, _), across in zip(span, (1, 0), strict=True)
        for k in range(3)
    )
    return _corners_of(lines)


def _corners_of(lines: Iterable[tuple[Side, int, Floats, bool]]) -> _Corners:
    """Return the corners of lines of nodes (n, 2), given as side, first node, nodes, and whether closed."""
    corners: _Corners = []
    for side, first, nodes, ring in lines:
        closed = ring and side in _COUNTED_BACK and np.array_equal(nodes[0], nodes[-1])
        line = nodes[:-1] if closed else nodes
        corners += [(side, first + int(k), line[k]) for k in find_corners(line, closed=closed)]
    return corners


def _check_corners(corners: _Corners, k: int, kept: int) -> None:
    """Raise InputError if a corner is not a `k`-th node; `kept` divides all counts of cells."""
    lost = [each for each in corners if each[1] % k]
    if not lost:
        return
    most = math.gcd(kept, *(node for _, node, _ in corners))
    side, node, place = lost[0]
    at = ", ".join(f"{x:.6g}" for x in place)
    corner = f"a corner of {side} at ({at}), node {node}, would be cut: every {k}-th drops it"
    others = f"; {len(lost) - 1} more" if len(lost) > 1 else ""
    keeps = f"the largest number that keeps all corners is {most}"
    remedy = "make the grid with {refine} or more nodes, so that its corners stand on multiples"
    raise InputError(corner + others, f"{keeps}; {remedy}")


def _check(counts: tuple[int, ...], k: int, *, blocks: bool = False) -> None:
    common = math.gcd(*(n - 1 for n in counts))
    if k >= 1 and common % k == 0:
        return
    whole = max(k, 1)
    near = [whole * max(1, (n - 1) // whole) + 1 for n in counts]
    remedy = f"make the grid with {'x'.join(map(str, near))} nodes, say"
    if blocks and len(counts) == 3:
        remedy = f"make the grid with a multiple of {k} cells along every direction of its blocks"
    elif blocks:
        remedy = "make the grid with {refine} K, which lets every block be halved K times"
    if common > 1:
        remedy = f"use a number that divides {common}, or {remedy}"
    nodes, across = ("x".join(map(str, sizes)) for sizes in (counts, [n - 1 for n in counts]))
    cells = f"{nodes} nodes are {across} cells, which {k} does not divide"
    raise InputError(cells, remedy)


def _coarser_patches(patches: tuple[Patch, ...], k: int) -> tuple[Patch, ...]:
    for patch in patches:
        for node in (patch.start, patch.stop, *(patch.across or ())):
            if node % k:
                end = f"patch {patch.name!r} ends at node {node} of {patch.side}"
                ends = f"make the grid with ends at multiples of {k} ({{wake_nodes}} for a wake)"
                raise InputError(f"{end}, which every {k}-th leaves out", f"{ends}, or coarsen less")
    coarser = []
    for patch in patches:
        across = patch.across and (patch.across[0] // k, patch.across[1] // k)
        coarser.append(replace(patch, start=patch.start // k, stop=patch.stop // k, across=across))
    return tuple(coarser)


def normalised(grid: Grid) -> Grid:
    """Return `grid` moved and scaled to unit size. A grid around a body is also rotated.

    In an O or C grid the trailing edge, where xi begins on the body, is moved to (1, 0). The body's node that
    is farthest from the trailing edge is moved to (0, 0). In any other grid the lower left corner of the
    bounding box is moved to the origin, and the longest side of the box gets length 1. Raises InputError: the
    body has no length.
    """
    if not grid.around_body:
        low, high = grid.box
        size = float((high - low).max())
        blocks = [Block((block.nodes - low) / size) for block in grid.blocks]
        return _moved(grid, blocks, lambda motion: _shifted(motion, (motion(low) - low) / size))
    body = grid.nodes[grid.wake : grid.ni - grid.wake, 0]
    trailing = body[0]
    leading = body[np.hypot(*(body - trailing).T).argmax()]
    ax, ay = trailing - leading
    square = ax * ax + ay * ay
    if not square > 0:
        raise InputError("the body has no length", "check that its side is the south one")
    # written out, not a matrix product: coincident nodes must stay bitwise equal
    x, y = grid.x - leading[0], grid.y - leading[1]
    nodes = np.stack([(x * ax + y * ay) / square, (y * ax - x * ay) / square], axis=-1)
    return grid.with_nodes(nodes)


def _moved(grid: Grid, blocks: Sequence[Block], motion_of: Callable[[Motion], Motion]) -> Grid:
    """Return `grid` with its `blocks` moved, and `motion_of` each motion between periodic sides."""
    connections = tuple(
        replace(each, transform=each.transform and motion_of(each.transform)) for each in grid.connections
    )
    equal = with_equal_nodes(blocks, connections)  # periodic sides now differ by rounding
    return replace(grid, blocks=equal, connections=connections)


def _shifted(motion: Motion, shift: Floats) -> Motion:
    return replace(motion, shift=tuple(shift.tolist()))


def scaled(grid: Grid, factor: float) -> Grid:
    """Return `grid` in another unit: nodes, periodic shifts, first-cell heights are multiplied by `factor`.

    Raises InputError: a factor that is not positive, or beyond 1e-12 to 1e12.
    """
    if not 1.0 / _MOST_SCALED <= factor <= _MOST_SCALED:
        remedy = "give the new unit in old ones, e.g. 0.001 for a grid from mm to m"
        raise InputError(f"a factor of {factor:g}", remedy, parameter="scale")
    blocks = [Block(factor * block.nodes) for block in grid.blocks]
    moved = _moved(grid, blocks, lambda motion: _shifted(motion, factor * np.array(motion.shift)))
    facts = {
        name: factor * fact if name.startswith(_LENGTHS) else fact for name, fact in grid.provenance.items()
    }
    facts["scaled"] = factor * float(facts.get("scaled", 1.0))
    return replace(moved, provenance=facts)


def rotated(grid: Grid, rotation: Motion) -> Grid:
    """Return a grid of volumes rotated by `rotation`; the motions between periodic sides are rotated too."""
    frame = rotation.inverse()(np.concatenate([np.zeros((1, 3)), np.eye(3)]))

    def rotated_motion(motion: Motion) -> Motion:
        start, *ends = rotation(motion(frame))
        turn = (np.array(ends) - start).T.tolist() if motion.turn else ()
        return Motion(tuple(start.tolist()) if motion.shift else (), tuple(map(tuple, turn)))

    blocks = [Block(rotation(block.nodes), finite=True) for block in grid.blocks]
    return _moved(grid, blocks, rotated_motion)


def turned(grid: Grid) -> Grid:
    """Return `grid` with xi and eta exchanged and one reversed: node (i, j) of a block becomes (j, ni-1-i).

    Raises InputError: an O or C grid, whose xi runs around the body by definition.
    """
    if grid.around_body:
        raise InputError(f"topology {grid.topology} has xi around the body", "swap four-sided grids only")
    if grid.form == "volume":
        raise InputError("a volume has three directions to swap", "swap grids of two directions only")
    last = [block.counts[0] - 1 for block in grid.blocks]
    patches = tuple(turned_patch(patch, last[patch.block]) for patch in grid.patches)
    connections = tuple(_turned_connection(each, last) for each in grid.connections)
    blocks = tuple(Block(np.swapaxes(block.nodes, 0, 1)[:, ::-1], finite=True) for block in grid.blocks)
    return replace(grid, blocks=blocks, patches=patches, connections=connections)


def turned_boundary(boundary: Boundary) -> Boundary:
    """Return a four-sided boundary with xi and eta exchanged, as `turned` does for grids."""
    patches = tuple(turned_patch(patch, boundary.ni - 1) for patch in boundary.patches)
    west, east = boundary.south[::-1], boundary.north[::-1]
    return replace(
        boundary, south=boundary.east, north=boundary.west, west=west, east=east, patches=patches, chord=0.0,
        sensors=None,
    )  # fmt: skip


def turned_patch(patch: Patch, last: int) -> Patch:
    """Return a patch with xi and eta exchanged, as in `turned`; `last` is its block's last index along xi."""
    side, (start, stop) = _turned_stretch(patch.side, (patch.start, patch.stop), last)
    return replace(patch, side=side, start=start, stop=stop)


def _turned_connection(each: Connection, last: list[int]) -> Connection:
    side, span = _turned_stretch(each.side, each.range[0], last[each.block])
    donor_side, donor_span = _turned_stretch(each.donor_side, each.donor_range[0], last[each.donor])
    flips = (each.side in _COUNTED_BACK) != (each.donor_side in _COUNTED_BACK)
    way = (-each.orientation[0] if flips else each.orientation[0],)
    ends = each.block, side, (span,), each.donor, donor_side, (donor_span,)
    return Connection(*ends, way, each.transform)


def _turned_stretch(side: Side, span: tuple[int, int], last: int) -> tuple[Side, tuple[int, int]]:
    """Return the new side and range of a stretch of a side of a `turned` block; see `turned_patch`."""
    if side in _COUNTED_BACK:
        span = last - span[1], last - span[0]
    return _SIDES[side], span
