"""Connections: parts of two sides, of different blocks or of one block, whose nodes coincide.

::

    o   west is connected to east              c   the first nodes of south to its last, in reverse order

As in the 1-to-1 interfaces of CGNS (Standard Interface Data Structures, 8.2).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats, Side, Topology
from meshonet.geometry.blocks.block import Range, face_counts, face_of, part_of, sides_of
from meshonet.geometry.errors import InputError

if TYPE_CHECKING:
    from meshonet.geometry.blocks.motion import Motion

Face: TypeAlias = Callable[[int, Side], NDArray[Any]]
"""Returns the nodes of a side of a block, given its number."""


@dataclass(frozen=True)
class Connection:
    """Two parts of block sides whose nodes coincide; one of them is called the side, the other the donor.

    In a periodic connection, the motion `transform` moves the nodes of the side onto the nodes of the donor.
    Index ranges ascend.
    """

    block: int
    side: Side
    range: Range
    donor: int
    donor_side: Side
    donor_range: Range
    orientation: tuple[int, ...]
    """For each direction of the side, the number of that of the donor (1 or 2), negative if opposite."""
    transform: Motion | None = None
    """Motion from the nodes of the side to those of the donor, if they are periodic."""

    @property
    def ends(self) -> tuple[tuple[int, Side, Range], tuple[int, Side, Range]]:
        """Block number, side and index range: of the connection's side, then of its donor."""
        return (self.block, self.side, self.range), (self.donor, self.donor_side, self.donor_range)

    def pairs(self, values: Sequence[NDArray[Any]]) -> tuple[NDArray[Any], NDArray[Any]]:
        """Return the values at the nodes of the side, and those at the donor's nodes in the same order.

        `values` has an array (ni, nj[, nk]) per block. Results are views: (n, 1) or, of volumes, (n, m, 1).
        """

        def face(block: int, side: Side) -> NDArray[Any]:
            return np.asarray(face_of(values[block], side)[..., None])

        return replace(self, transform=None).nodes(face)

    def nodes(self, face: Face) -> tuple[NDArray[Any], NDArray[Any]]:
        """Return the side's nodes, moved by `transform`, and the donor's nodes; both in the side's order.

        Both are (n, d) or (n, m, d). `face` is a function of block and side, such as `Grid.face`.
        """
        own = part_of(face(self.block, self.side), self.range)
        donor = part_of(face(self.donor, self.donor_side), self.donor_range)
        if len(self.orientation) != own.ndim - 1:
            raise InputError(f"{self} has {len(self.orientation)} directions", f"give {own.ndim - 1}")
        donor = donor.transpose(*(np.abs(self.orientation) - 1), donor.ndim - 1)
        donor = np.flip(donor, tuple(np.flatnonzero(np.less(self.orientation, 0)).tolist()))
        return (self.transform(own) if self.transform else own), donor

    def check(self, face: Face) -> None:
        """Raise InputError unless the connected nodes are bitwise equal; for `face` see `nodes`."""
        own, donor = self.nodes(face)
        if own.shape != donor.shape:
            counts = f"{own.shape[:-1]} nodes to {donor.shape[:-1]}"
            raise InputError(f"{self} joins {counts}", "connect equal counts")
        if np.array_equal(own, donor):
            return
        place = np.argwhere((own != donor).any(axis=-1))[0]
        at = ", ".join(str(start + k) for (start, _), k in zip(self.range, place.tolist(), strict=True))
        raise InputError(
            f"{self} is open: its nodes differ, first at node {at} of {self.side}",
            "make the nodes of both sides the same, or leave the connection out",
        )

    def reversed(self) -> Connection:
        """Return the connection with side and donor exchanged; its transform is inverted, up to rounding."""
        ways = [0] * len(self.orientation)
        for k, way in enumerate(self.orientation, start=1):
            ways[abs(way) - 1] = k if way > 0 else -k
        own, donor = self.ends
        return Connection(*donor, *own, tuple(ways), self.transform.inverse() if self.transform else None)

    def __str__(self) -> str:
        own, donor = (ascii(side)[1:-1] for side in (self.side, self.donor_side))  # files may be damaged
        return f"the connection of {own} of block {self.block} to {donor} of block {self.donor}"

    def stretches(self, block: int) -> list[tuple[Side, int, int]]:
        """Return the connected parts of a planar block's sides: side, first and last node of each."""
        return [(side, *nodes[0]) for number, side, nodes in self.ends if number == block]


def cells_at(connection: Connection, face: Face) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return the values of the cells on each side of a connection, as views (n, d) or (n, m, d).

    Both views have the order of the cells at `connection.side`. `face` is a function of block and side; it
    returns d values for each cell at this side.
    """
    spans = [tuple((a, b - 1) for a, b in span) for span in (connection.range, connection.donor_range)]
    return replace(connection, range=spans[0], donor_range=spans[1], transform=None).nodes(face)


def check_connections(connections: Sequence[Connection], counts: Sequence[tuple[int, ...]]) -> None:
    """Raise InputError if a connection names a block, side or node that does not exist.

    `counts` are the node counts of each block along its directions.
    """
    for each in connections:
        for block, side, span in each.ends:
            known = 0 <= block < len(counts) and side in sides_of(counts[block])
            most = face_counts(counts[block], side) if known else ()
            for (start, stop), n in zip(span, most, strict=False):
                known &= 0 <= start < stop < n
            if not known or len(span) != len(most):
                raise InputError(f"{each} leaves its side", "connect sides and nodes that there are")
        if len(each.orientation) != len(each.range):
            raise InputError(f"{each} has {len(each.orientation)} directions", f"give {len(each.range)}")
        if sorted(map(abs, each.orientation)) != list(range(1, len(each.range) + 1)):
            raise InputError(f"{each} has directions {each.orientation}", "give each direction once")


def o_seam(nj: int) -> Connection:
    """Return the connection of the west side of an O block to its east side."""
    whole = ((0, nj - 1),)
    return Connection(0, "west", whole, 0, "east", whole, (1,))


def c_wake(ni: int, cells: int) -> Connection:
    """Return the connection of a C block's south side across the wake, which is `cells` cells long."""
    return Connection(0, "south", ((0, cells),), 0, "south", ((ni - 1 - cells, ni - 1),), (-1,))


def topology_of(counts: Sequence[tuple[int, ...]], connections: Sequence[Connection]) -> Topology:
    """Return the topology of blocks with `counts` nodes along their directions, joined by `connections`.

    >>> topology_of([(9, 5)], ()), topology_of([(9, 5)], [o_seam(5)]), topology_of([(9, 5)], [c_wake(9, 2)])
    ('quad', 'o', 'c')
    """
    if len(counts) == 1 and len(counts[0]) == 2:
        if not connections:
            return "quad"
        if tuple(connections) == (o_seam(counts[0][1]),):
            return "o"
        if tuple(connections) == (c_wake(counts[0][0], wake_cells(connections)),):
            return "c"
    return "blocks"


def wake_cells(connections: Sequence[Connection]) -> int:
    """Return the number of wake cells in the connections of a C block; 0 for other blocks."""
    joined = connections[0] if len(connections) == 1 else None
    return joined.range[0][1] if joined and joined.side == joined.donor_side == "south" else 0


def wake_nodes(south: Floats) -> int:
    """Return how many nodes at the start of `south` (ni, 2) are repeated in reverse order at its end.

    If all nodes are repeated, they enclose no body, and the result is 0.
    """
    half = south[: len(south) // 2]
    differs = (half != south[::-1][: len(half)]).any(axis=1)
    return int(np.argmax(differs)) if differs.any() else 0


def connections_of(topology: Topology, south: Floats, nj: int) -> tuple[Connection, ...]:
    """Return the connections of a block to itself: the seam of an O grid, or the wake of a C grid.

    `south` (ni, 2) are the nodes of the south side. `nj` is the number of nodes along eta. Raises InputError:
    an unknown topology; a C block without a wake.
    """
    if topology == "quad":
        return ()
    if topology == "o":
        return (o_seam(nj),)
    if topology != "c":
        raise InputError(f"topology {topology!r} is not known", "use quad/o/c")
    half = len(south) // 2
    all_doubled = len(south) % 2 == 1 and np.array_equal(south[:half], south[: -half - 1 : -1])
    cells = (half if all_doubled else wake_nodes(south)) - 1  # all but the middle: a wall of two cells
    if cells < 1:
        remedy = "make both sides of the wake coincide, or call it quad"
        raise InputError("the south side of a C grid does not begin and end with the nodes of a wake", remedy)
    return (c_wake(len(south), cells),)


class Connected:
    """Properties of a grid or boundary that follow from its connections."""

    connections: tuple[Connection, ...]
    topology: Topology

    @property
    def periodic(self) -> bool:
        """Whether xi runs around a body and closes on itself (topology ``o``)."""
        return self.topology == "o"

    @property
    def around_body(self) -> bool:
        """Whether the south side is a body within a far field (topology ``o`` or ``c``)."""
        return self.topology in ("o", "c")

    @property
    def wake(self) -> int:
        """Number of wake cells at each end of the south side; nodes (i, 0) and (ni-1-i, 0) coincide there."""
        return wake_cells(self.connections)
