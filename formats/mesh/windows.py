"""Ranges of block faces in the three indices of a file, converted to ranges of sides of blocks."""

from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

from meshonet.formats.mesh.slices import IndexedNodes
from meshonet.geometry.arrays import Side
from meshonet.geometry.blocks.block import PLACES, Range
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.meeting_sides import AROUND
from meshonet.geometry.blocks.patches import Kind, Patch
from meshonet.geometry.errors import InputError

Triple: TypeAlias = tuple[int, int, int]
_SIDES: dict[tuple[int, int], Side] = {place: side for side, place in PLACES.items()}
"""Sides by direction and end of this direction."""


class FaceWindow(NamedTuple):
    """A rectangle of nodes on a face of a block, given by the indices, from 0, of two opposite corners.

    If two rectangles are connected, their `first` corners coincide, and so do their `last` corners. So an
    index may be lower in `last` than in `first`.
    """

    block: int
    first: Triple
    last: Triple


class Face(NamedTuple):
    """A rectangle of nodes on a face of a block, with the name and kind of its boundary."""

    window: FaceWindow
    name: str
    kind: Kind


class Pair(NamedTuple):
    """Two connected rectangles of nodes, and the name of the connection in the file.

    ``partner[k]`` is the direction of the donor block that corresponds to direction k of the first block.
    """

    own: FaceWindow
    donor: FaceWindow
    partner: Triple
    name: str = ""


class SidePart(NamedTuple):
    """A part of a side of a block in a file."""

    side: Side
    range: Range  # first and last node along each direction
    axes: tuple[int, ...]  # for each direction, the number of the file's index along it
    ways: tuple[int, ...]  # for each direction, -1 if the file reverses it, else 1


def part_of(window: FaceWindow, lattices: Sequence[IndexedNodes]) -> SidePart | None:
    """Return the part of a block's side that `window`, a rectangle of nodes, covers.

    Returns None for a plane inside a block or a mere edge of it. Raises InputError: nodes outside the blocks.
    """
    if not 0 <= window.block < len(lattices):
        problem = f"a face of block {window.block + 1} is named and there are {len(lattices)}"
        raise InputError(problem, "name those that there are")
    lattice = lattices[window.block]
    fixed: list[tuple[int, int]] = []
    along: list[tuple[int, int, int]] = []
    for direction, axis in enumerate(lattice.axes):
        count = lattice.nodes.shape[direction]
        first, last = window.first[axis], window.last[axis]
        if not 0 <= min(first, last) <= max(first, last) < count:
            problem = f"a face has nodes {first + 1} to {last + 1} of {count} of block {window.block + 1}"
            raise InputError(problem, "keep ranges within the block")
        if lattice.reversed and direction == 0:
            first, last = count - 1 - first, count - 1 - last
        if first != last:
            along.append((axis, first, last))
        elif first in (0, count - 1):
            fixed.append((direction, 0 if first == 0 else -1))
    if len(fixed) != 1 or len(along) != len(lattice.axes) - 1:
        return None
    span = tuple((min(first, last), max(first, last)) for _, first, last in along)
    ways = tuple(1 if first < last else -1 for _, first, last in along)
    return SidePart(_SIDES[fixed[0]], span, tuple(axis for axis, _, _ in along), ways)


def patch_of(face: Face, lattices: Sequence[IndexedNodes]) -> Patch | None:
    """Return a face as a patch; None if it is a plane inside a block, or a mere edge of a volume."""
    part = part_of(face.window, lattices)
    if part is None:
        return None
    (start, stop), *across = part.range
    place = across[0] if across else None, face.window.block
    return Patch(face.name, part.side, start, stop, *place, face.kind)


def connection_of(pair: Pair, lattices: Sequence[IndexedNodes]) -> Connection | None:
    """Return the connection of a pair of index ranges; None if a range is not on a single side of a block.

    No translation or rotation is set. Raises InputError as `part_of`, and if indices do not correspond.
    """
    here, there = part_of(pair.own, lattices), part_of(pair.donor, lattices)
    if here is None or there is None:
        return None
    ends = pair.own.block, here.side, here.range, pair.donor.block, there.side, there.range
    if lattices[pair.own.block].nodes.shape[-1] == 2:  # right-handed, they run along it in opposite ways
        return Connection(*ends, (-AROUND[here.side] * AROUND[there.side],))
    orientation = []
    if any(pair.partner[axis] not in there.axes for axis in here.axes):
        problem = (
            f"an interface of blocks {pair.own.block + 1} and {pair.donor.block + 1} has faces across it"
        )
        raise InputError(problem, "join faces whose directions lie on each other")
    for axis, way in zip(here.axes, here.ways, strict=True):
        place = there.axes.index(pair.partner[axis])
        orientation.append((place + 1) * way * there.ways[place])
    return Connection(*ends, tuple(orientation))
