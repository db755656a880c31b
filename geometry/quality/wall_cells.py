"""Cells at walls in a flow: y+ of their heights; and their skewness, which is greatest at edges of bodies."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from meshonet.geometry.arrays import Floats, middle, norms, percentiles_of
from meshonet.geometry.blocks.across import rows_at
from meshonet.geometry.blocks.block import PLACES
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.growth import Extreme
from meshonet.geometry.quality.measure import per_cell_of_blocks
from meshonet.geometry.spacing.y_plus import first_cell


@dataclass(frozen=True)
class Flow:
    """The flow for which y+ is computed.

    The wall shear stress is that of a turbulent boundary layer on a flat plate, at half the reference length.

    Parameters
    ----------
    reynolds : float
        Reynolds number of the reference length.
    length : float, optional
        Reference length in the unit of the grid.

    Raises
    ------
    InputError
        A value out of its range.
    """

    reynolds: float
    length: float = 1.0

    def __post_init__(self) -> None:
        if not 0.0 < self.length < 1e12:
            problem = f"a length of {self.length:g}"
            raise InputError(problem, "use more than 0 and less than 1e12", parameter="length")
        _ = self.height

    @cached_property
    def height(self) -> float:
        """Distance from the wall at which y+ is 1, in the unit of the grid."""
        return self.length * first_cell(1.0, self.reynolds)


@dataclass(frozen=True)
class YPlus:
    """y+ of the nodes next to a wall."""

    min: float
    median: float
    max: float


def y_plus_at(grid: Grid, walls: Sequence[Patch], flow: Flow) -> dict[str, YPlus]:
    """Return, by name of the wall, y+ of the first nodes above each of the `walls`."""
    values: dict[str, list[Floats]] = {}
    for wall in walls:
        rows = rows_at(grid, wall, 2)
        values.setdefault(wall.name, []).append(norms(rows[1] - rows[0]).ravel() / flow.height)
    every = {name: np.concatenate(parts) for name, parts in values.items()}
    return {name: YPlus(float(y.min()), middle(y), float(y.max())) for name, y in every.items()}


def skewness_at(grid: Grid, walls: Sequence[Patch]) -> dict[str, Extreme]:
    """Return, by name of the wall, the skewness of the cells at each of the `walls` of a volume."""
    cells = per_cell_of_blocks(grid, "skewness")
    stretches: dict[str, list[tuple[Floats, Patch]]] = {}
    for wall in walls:
        axis, end = PLACES[wall.side]
        face = np.moveaxis(cells[wall.block], axis, 0)[end]
        (a, b), (c, d) = wall.range(tuple(n + 1 for n in face.shape))
        stretches.setdefault(wall.name, []).append((face[a:b, c:d], wall))
    return {name: _extreme(grid, parts) for name, parts in stretches.items()}


def _extreme(grid: Grid, parts: Sequence[tuple[Floats, Patch]]) -> Extreme:
    """Return the extreme of values (n, m) of the cells at stretches of a wall."""
    values, wall = max(parts, key=lambda part: float(part[0].max()))
    axis, end = PLACES[wall.side]
    last = grid.blocks[wall.block].counts[axis] - 2
    place = [int(index) for index in np.unravel_index(int(values.argmax()), values.shape)]
    starts = [first for first, _ in wall.range(tuple(n + 1 for n in values.shape))]
    at = [index + start for index, start in zip(place, starts, strict=True)]
    at.insert(axis, last if end else 0)
    every = np.concatenate([part.ravel() for part, _ in parts])
    return Extreme(
        float(values.max()), float(every.mean()), (wall.block, *at), percentiles_of(every, (99,))[0]
    )
