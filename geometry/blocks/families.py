"""Families of grid lines: the lines along a direction of a block, continued across its connections.

::

    +-----+-----+      the lines i = const of the left block continue into no other block, its lines
    |     |     |      j = const continue into the right block
    +-----+-----+
"""

from dataclasses import dataclass

from meshonet.geometry.blocks.block import PLACES, face_counts
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid


@dataclass(frozen=True)
class Member:
    """The grid lines of a block along the direction `axis` (0 is xi, 1 is eta), as a part of a family.

    A family has grid lines that continue each other from block to block. If `flipped` (in 2-D only), this
    block numbers them in the other direction than the family's first block. `aligned` states that all
    connections on the way from that block to this one join whole sides. Line k then continues line k of the
    first block, or the k-th from the end if `flipped`.
    """

    block: int
    axis: int
    flipped: bool
    aligned: bool


def joins_whole_sides(grid: Grid, connection: Connection) -> bool:
    """Return whether a connection joins all nodes of one side to all nodes of another."""
    return all(
        span == tuple((0, count - 1) for count in face_counts(grid.blocks[block].counts, side))
        for block, side, span in connection.ends
    )


def families(grid: Grid) -> list[list[Member]]:
    """Return the families of grid lines: sets of lines that continue each other from block to block."""
    beyond: dict[tuple[int, int], list[tuple[tuple[int, int], bool, bool]]] = {}
    for each in grid.connections:
        own, donor = (each.block, PLACES[each.side][0]), (each.donor, PLACES[each.donor_side][0])
        whole = joins_whole_sides(grid, each)
        flip = each.orientation[0] < 0
        beyond.setdefault(own, []).append((donor, flip, whole))
        beyond.setdefault(donor, []).append((own, flip, whole))
    families: list[list[Member]] = []
    seen: set[tuple[int, int]] = set()
    for start in ((number, k) for number, block in enumerate(grid.blocks) for k in range(len(block.counts))):
        if start in seen:
            continue
        seen.add(start)
        family = [Member(*start, flipped=False, aligned=True)]
        for member in family:  # the list grows meanwhile
            for other, flip, whole in beyond.get((member.block, member.axis), ()):
                if other not in seen:
                    seen.add(other)
                    family.append(Member(*other, member.flipped != flip, member.aligned and whole))
        families.append(family)
    return families
