"""A domain in, a valid grid of blocks out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.errors import NoValidGridError
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.to_grid import to_grid
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.blocking.chords import Chords
from meshonet.solvers.blocking.decompose import Timings, decompose
from meshonet.solvers.blocking.refine import multiplied, refine
from meshonet.solvers.energy.quads import optimise

CELLS = 2500
"""Cells where nobody asked for a count."""
OPTIMISED = 6000
"""Most cells that are optimised themselves; more are splines through half as many each way."""
ITERATIONS = 150


@dataclass(frozen=True)
class BlockFacts:
    """What a grid of blocks was made of."""

    blocks: int
    cells: int
    irregular: int
    """Nodes inside where other than four blocks meet."""
    timings: Timings


def block_grid(
    domain: Domain,
    *,
    cells: int | None = None,
    cell_size: float | None = None,
    layout: Layout | None = None,
) -> tuple[Grid, Layout, BlockFacts]:
    """Return a grid of blocks of a domain, the layout whose nodes it has, and what it was made of.

    Parameters
    ----------
    cells : about how many in all, within 20 % where the blocks allow it; `CELLS` by default.
    cell_size : length of edges instead, in the domain's unit.
    layout : blocks to take, in the same domain; by default they are found.

    Raises BlockingError: no blocks were found. NoValidGridError: cells stay folded.
    """
    timings = Timings()
    layout = layout or decompose(domain, timings=timings)
    fine = fine_layout(layout, cells=cells, cell_size=cell_size, timings=timings)
    with timings.stage("grid"):
        grid = to_grid(fine)
    folded = sum(count_folded(block.nodes) for block in grid.blocks)
    if folded:
        raise NoValidGridError(f"{folded} cells of the blocks stay folded")
    mesh = fine.mesh
    irregular = int(np.count_nonzero(mesh.irregular & ~mesh.wall_nodes))
    return grid, fine, BlockFacts(len(fine.blocks), fine.cells, irregular, timings)


def fine_layout(
    layout: Layout,
    *,
    cells: int | None = None,
    cell_size: float | None = None,
    timings: Timings | None = None,
) -> Layout:
    """Return a layout with as many cells as asked for, its nodes optimised all together.

    Raises NoValidGridError: it stays folded.
    """
    timings = timings or Timings()
    chords = Chords.of(layout)
    area = layout.mesh.domain.area
    wanted = cells or (area / cell_size**2 if cell_size else CELLS)
    halvings = 0
    while wanted / 4**halvings > OPTIMISED:
        halvings += 1
    with timings.stage("refine"):
        if cell_size and not cells:
            counts = chords.counts_for_size(cell_size * 2**halvings)
        else:
            counts = chords.counts_for_cells(int(wanted / 4**halvings))
        fine = refine(layout, counts, chords)
    with timings.stage("optimum"):
        optimum = optimise(fine.mesh, iterations=ITERATIONS)
    if not optimum.valid:
        raise NoValidGridError("cells of the blocks stay folded after optimisation")
    fine = Layout(optimum.mesh, fine.blocks)
    with timings.stage("refine"):
        return multiplied(fine, 2**halvings) if halvings else fine
