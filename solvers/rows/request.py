"""Options of the grid of a blade row."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.first_cell import FirstCell
from meshonet.geometry.spacing.growth import check_growth
from meshonet.solvers.keywords import request_from

DEFAULT_FIRST_CELL, DEFAULT_GROWTH, DEFAULT_CELLS = 1e-3, 1.2, 500_000
FEWEST_CELLS, MOST_CELLS = 20_000, 200_000_000
_LEAST_HEIGHT, _MOST_HEIGHT = 1e-8, 0.05  # chords


@dataclass(frozen=True)
class RowRequest(FirstCell):
    """Options of the grid of a blade row, checked on construction. The unit of lengths is the longest chord.

    Parameters
    ----------
    first_cell : float, optional
        Height of the first cells at blade, hub, casing and tip; None: 1e-3.
    y_plus, reynolds, chord_fraction : float, optional
        First-cell height as y+, instead of `first_cell`. The conversion assumes a turbulent flat plate; the
        Reynolds number is based on the longest chord.
    growth : float, optional
        Largest growth ratio of cells away from walls; None: 1.2.
    cells : int, optional
        Approximate number of cells in one passage.
    copies : int, optional
        Number of passages beside each other; the number of blades gives the whole annulus.
    threads : int, optional
        Number of threads; None: all cores.
    percentiles : bool, optional
        Whether the quality includes percentiles.
    allow_invalid : bool, optional
        Whether a grid with folded cells is returned instead of an error.

    Raises
    ------
    InputError
        A value out of its range; parameters that need or exclude each other.
    """

    growth: float | None = None
    cells: int = DEFAULT_CELLS
    copies: int = 1
    threads: int | None = None
    percentiles: bool = False
    allow_invalid: bool = False

    def __post_init__(self) -> None:
        self.check_first_cell()
        if not _LEAST_HEIGHT <= self.height() <= _MOST_HEIGHT:
            remedy = f"use {_LEAST_HEIGHT:g} to {_MOST_HEIGHT:g}"
            raise InputError(f"{self.height():g} chords", remedy, parameter="first_cell")
        check_growth(self.growth)
        if not FEWEST_CELLS <= self.cells <= MOST_CELLS:
            remedy = f"use {FEWEST_CELLS} to {MOST_CELLS}"
            raise InputError(f"{self.cells} cells", remedy, parameter="cells")
        if self.threads is not None and self.threads < 1:
            raise InputError(f"{self.threads} threads", "use 1 or more", parameter="threads")

    @property
    def ratio(self) -> float:
        """Largest ratio of neighbouring cells."""
        return DEFAULT_GROWTH if self.growth is None else self.growth

    def height(self, unit: float = 1.0) -> float:
        """Return the first-cell height in chords; `unit` is the reference length for y+, in chords."""
        height = super().height(unit)
        return DEFAULT_FIRST_CELL if height is None else height


def row_request(**parameters: Any) -> RowRequest:
    """Return a `RowRequest` with the parameters as its fields; ``wall_spacing`` is read as ``first_cell``.

    Raises InputError: a parameter that `RowRequest` does not have; see also `RowRequest`.
    """
    return request_from(RowRequest, "a row", parameters)
