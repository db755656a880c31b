"""How far two grids of the same size are apart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError

NEAR = 0.1
"""Part of the rows that counts as near the wall."""


@dataclass(frozen=True)
class Difference:
    """Distances between the nodes of two grids, in their unit of length."""

    max: float
    mean: float
    at: tuple[int, int]
    """Node (i, j) of the greatest."""
    relative_l2: float
    """Root of the mean squared distance over that of the reference's nodes from their mean."""
    near_wall: float
    """The same with the distances in the tenth of all rows from j = 0 on."""
    boundary: float
    """Greatest distance on the four sides; on the two walls of O grids."""


def compare(grid: Grid, reference: Grid) -> Difference:
    """Return how far the nodes of `grid` are from those of `reference`.

    Raises InputError: their node counts differ.
    """
    if grid.nodes.shape != reference.nodes.shape:
        counts = f"{grid.ni}x{grid.nj} nodes are not comparable with {reference.ni}x{reference.nj}"
        raise InputError(counts, "compare grids of one size")
    away = np.hypot(grid.x - reference.x, grid.y - reference.y)
    i, j = np.unravel_index(int(away.argmax()), away.shape)
    spread = _root_mean_square(np.hypot(reference.x - reference.x.mean(), reference.y - reference.y.mean()))
    extent = max(spread, float(np.finfo(float).tiny))  # all nodes in one place
    rows = max(1, round(NEAR * grid.nj))
    sides = [away[:, 0], away[:, -1]]
    if not grid.periodic:  # the cut of an O grid is no boundary
        sides += [away[0], away[-1]]
    return Difference(
        max=float(away.max()),
        mean=float(away.mean()),
        at=(int(i), int(j)),
        relative_l2=_root_mean_square(away) / extent,
        near_wall=_root_mean_square(away[:, :rows]) / extent,
        boundary=max(float(side.max()) for side in sides),
    )


def _root_mean_square(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))
