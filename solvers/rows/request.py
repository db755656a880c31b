"""Options of the grid of a blade row."""

from dataclasses import dataclass
from typing import ClassVar

from meshonet.geometry.errors import InputError
from meshonet.solvers.volume_request import VolumeRequest

DEFAULT_GROWTH, DEFAULT_CELLS = 1.2, 500_000
_LEAST_HEIGHT, _MOST_HEIGHT = 1e-8, 0.05  # chords


@dataclass(frozen=True, kw_only=True)
class RowRequest(VolumeRequest):
    """Options of the grid of a blade row, checked on construction. Lengths are in units of the longest chord.

    Parameters
    ----------
    first_cell : float, optional
        Height of the first cells at blade, hub, casing and tip; by default 1e-3.
    y_plus, reynolds, chord_fraction : float, optional
        First-cell height as y+ on a turbulent flat plate, with the Reynolds number of the longest chord, at a
        distance of `chord_fraction` chords from its leading edge.
    growth : float, optional
        Largest ratio of neighbouring cells; by default 1.2.
    cells : int, optional
        Approximate number of cells in one passage; by default 500,000.
    copies : int, optional
        Number of passages beside each other; the number of blades gives the whole annulus.
    threads : int, optional
        Number of threads; by default all cores.
    percentiles : bool, optional
        Whether the quality includes percentiles.
    allow_invalid : bool, optional
        Whether a grid with folded cells is returned instead of an error.

    Raises
    ------
    InputError
        If a value is out of its range, or if parameters exclude each other or lack another that they need.
    """

    what: ClassVar[str] = "a row"
    fewest_cells: ClassVar[int] = 20_000
    cells: int = DEFAULT_CELLS
    copies: int = 1

    def __post_init__(self) -> None:
        self.check_first_cell()
        if not _LEAST_HEIGHT <= self.height() <= _MOST_HEIGHT:
            remedy = f"use {_LEAST_HEIGHT:g} to {_MOST_HEIGHT:g}"
            raise InputError(f"{self.height():g} chords", remedy, parameter="first_cell")
        self.check_volume()

    @property
    def ratio(self) -> float:
        """Largest ratio of neighbouring cells."""
        return DEFAULT_GROWTH if self.growth is None else self.growth
