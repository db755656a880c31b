"""A grid of many blocks as a shape: the domain that its outer sides bound, and its blocks."""

from __future__ import annotations

from meshonet.geometry.blocks.families import joins_whole_sides
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
