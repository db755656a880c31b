"""Refines a multi-block grid by splines along its lines and around its boundary."""

from dataclasses import replace

from meshonet.geometry.blocks.block import Block, Range
from meshonet.geometry.blocks.families import joins_whole_sides
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.layout.from_grid import layout_of
from meshonet.solvers.refinement.refine import multiplied


def refined(grid: Grid, times: int) -> Grid:
    """Return `grid` with each cell divided into `times` x `times` cells; its nodes are kept.

    Raises InputError: a connection that covers only a part of a side; see also `layout_of`.
    """
    for each in grid.connections:
        if not joins_whole_sides(grid, each):
            problem = f"{each} joins parts of sides, and blocks are refined side by side"
            raise InputError(problem, "split the blocks there", parameter="refine")
    layout = multiplied(layout_of(grid), times)
    nodes = layout.mesh.nodes

    def scaled(span: Range) -> Range:
        return tuple((start * times, stop * times) for start, stop in span)

    patches = tuple(replace(p, start=p.start * times, stop=p.stop * times) for p in grid.patches)
    connections = tuple(
        replace(each, range=scaled(each.range), donor_range=scaled(each.donor_range))
        for each in grid.connections
    )
    blocks = tuple(Block(nodes[block]) for block in layout.blocks)
    return replace(grid, blocks=blocks, patches=patches, connections=connections)
