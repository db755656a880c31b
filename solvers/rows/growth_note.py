"""Note for the report about the growth of cells in a row, which the optimum limits but for few nodes."""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import percentiles_of
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.growth import ratios

_EVERY = 4
"""Of the lines of a block across each direction one in so many is measured: all take longer than all else."""
_PERCENT = 99.9
_KEPT = 1.02
"""Excess over the limit from which on a note is due."""


def growth_note(grid: Grid, limit: float) -> tuple[str, ...]:
    """Return a note if consecutive edges inside blocks grow by more than a limit, at more than few nodes."""
    parts = []
    for block in grid.blocks:
        for axis in range(3):
            lines = np.moveaxis(block.nodes, axis, 0)[:, ::_EVERY, ::_EVERY]
            parts.append(ratios(lines).ravel())
    growth = np.concatenate(parts)
    most = percentiles_of(growth, (_PERCENT,))[0]
    if most <= _KEPT * limit:
        return ()
    worst = f"{growth.max():.3g} at the worst, instead of {limit:g}"
    return (f"cells grow by up to {most:.3g} at {_PERCENT:g} % of nodes, and by about {worst}",)
