"""Options that the grids of stacks, aircraft and blade rows share."""

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.first_cell import FirstCell
from meshonet.geometry.spacing.growth import check_growth
from meshonet.solvers.keywords import request_from

DEFAULT_FIRST_CELL = 1e-3  # chords
MOST_CELLS = 200_000_000


@dataclass(frozen=True, kw_only=True)
class VolumeRequest(FirstCell):
    """Fields that `StackRequest` and `RowRequest` have in common; lengths are in chords."""

    what: ClassVar[str]  # the kind of grid in messages
    fewest_cells: ClassVar[int]
    growth: float | None = None
    cells: int | None = None
    threads: int | None = None
    percentiles: bool = False
    allow_invalid: bool = False

    @classmethod
    def of(cls, **parameters: Any) -> Self:
        """Return a request with these fields; ``wall_spacing`` is another name of ``first_cell``.

        Raises InputError if a value is out of its range or a parameter is unknown.
        """
        return request_from(cls, cls.what, parameters)

    def check_volume(self) -> None:
        """Raise InputError if the growth ratio or the number of cells or threads is out of range."""
        check_growth(self.growth)
        if self.cells is not None and not self.fewest_cells <= self.cells <= MOST_CELLS:
            remedy = f"use {self.fewest_cells} to {MOST_CELLS}"
            raise InputError(f"{self.cells} cells", remedy, parameter="cells")
        if self.threads is not None and self.threads < 1:
            raise InputError(f"{self.threads} threads", "use 1 or more", parameter="threads")

    def height(self, unit: float = 1.0) -> float:
        """Return the first-cell height in chords; the reference length for y+ is `unit`, also in chords."""
        height = super().height(unit)
        return DEFAULT_FIRST_CELL if height is None else height
