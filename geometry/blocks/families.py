"""Families of grid lines: those that run along a direction of a block, and on over its connections.

::

    +-----+-----+      the lines i = const of the left block run on into nothing else, those
    |     |     |      j = const into the right block
    +-----+-----+
"""

from dataclasses import dataclass

from meshonet.geometry.blocks.block import PLACES, face_counts
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid


@dataclass(frozen=True)
class Member:
    """The lines along a direction (0 is xi, 1 eta) of a block, and whether their numbers run backwards.

    Lines are numbered by the other direction; `aligned` says whether they are numbered as those of the
    family's first block are, backwards if `flipped`, or belong to it in part only.
    """

    block: int
    axis: int
    flipped: bool
    aligned: bool


def joins_whole_sides(grid: Grid, connection: Connection) -> bool:
    """Say whether a connection joins all of a side to all of another."""
    return all(
        span == tuple((0, count - 1) for count in face_counts(grid.blocks[block].counts, side))
        for block, side, span in connection.ends
    )


def families(grid: Grid) -> list[list[Member]]:
    """Return the families of the lines of a grid, each (block, direction) in one of them.

    In volumes, where lines have two numbers, `flipped` says nothing.
    """
    beyond: dict[tuple[int, int], list[tuple[tuple[int, int], bool, bool]]] = {}
    for each in grid.connections:
        own, donor = (each.block, PLACES[each.side][0]), (each.donor, PLACES[each.donor_side][0])
        whole = joins_whole_sides(grid, each)
        flip = each.orientation[0] < 0
        beyond.setdefault(own, []).append((donor, flip, whole))
        beyond.setdefault(donor, []).append((own, flip, whole))
    families: list[list[Member]] = []
    seen: set[tuple[int, int]] = set()
    for start in (
        (block, axis) for block in range(len(grid.blocks)) for axis in range(len(grid.blocks[block].counts))
    ):
        if start in seen:
            continue
        seen.add(start)
        family = [Member(*start, flipped=False, aligned=True)]
        for member in family:  # it grows meanwhile
            for other, flip, whole in beyond.get((member.block, member.axis), ()):
                if other not in seen:
                    seen.add(other)
                    family.append(Member(*other, member.flipped != flip, member.aligned and whole))
        families.append(family)
    return families
