"""y+ of the first nodes above walls, in a flow."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from meshonet.geometry.arrays import Floats, middle, norms
from meshonet.geometry.blocks.across import rows_at
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.y_plus import first_cell


@dataclass(frozen=True)
class Flow:
    """The flow for which y+ is computed, from the wall shear stress in the middle of a turbulent flat plate.

    `reynolds` is the Reynolds number of a reference length, which is `length` in the unit of the grid. Raises
    InputError: a value out of its range.
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
    """y+ of the first nodes off a wall."""

    min: float
    median: float
    max: float


def y_plus_at(grid: Grid, walls: Sequence[Patch], flow: Flow) -> dict[str, YPlus]:
    """Return the y+ of the first nodes off each of the `walls`, by the name of the wall."""
    values: dict[str, list[Floats]] = {}
    for wall in walls:
        rows = rows_at(grid, wall, 2)
        values.setdefault(wall.name, []).append(norms(rows[1] - rows[0]).ravel() / flow.height)
    every = {name: np.concatenate(parts) for name, parts in values.items()}
    return {name: YPlus(float(y.min()), middle(y), float(y.max())) for name, y in every.items()}
