"""A grid of many blocks as a shape: the domain that its outer sides bound, and its blocks."""

from __future__ import annotations

from meshonet.geometry.blocks.block import face_counts
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.layout.from_grid import layout_of
from meshonet.geometry.shapes.domain_shape import DomainShape


def given_blocks(grid: Grid) -> DomainShape:
    """Return the domain inside the outer sides of planar blocks.

    Its blocks can be used again where each shares whole sides. Raises InputError: as `layout_of`.
    """
    layout = layout_of(grid)
    whole = all(joins_whole_sides(grid, each) for each in grid.connections)
    return DomainShape(layout.mesh.domain, layout=layout if whole else None, given=grid)


def joins_whole_sides(grid: Grid, connection: Connection) -> bool:
    """Say whether a connection of planar blocks joins all of a side to all of another."""
    ends = (
        (connection.block, connection.side, connection.range),
        (connection.donor, connection.donor_side, connection.donor_range),
    )
    return all(
        span[0] == (0, face_counts(grid.blocks[block].counts, side)[0] - 1) for block, side, span in ends
    )
