"""The first-cell height at walls as a request gives it: directly, or by its y+."""

from __future__ import annotations

import math
from dataclasses import dataclass

from meshonet.geometry.errors import InputError


@dataclass(frozen=True, kw_only=True)
class FirstCell:
    """First-cell height at walls: fields that several requests share.

    Parameters
    ----------
    first_cell : float, optional
        First-cell height, in the unit of the request.
    y_plus, reynolds : float, optional
        First-cell height as y+, converted by flat-plate friction; the Reynolds number is for a length of 1.
    chord_fraction : float, optional
        Position along this length at which y+ is converted, 0 to 1.
    """

    first_cell: float | None = None
    y_plus: float | None = None
    reynolds: float | None = None
    chord_fraction: float = 0.5

    @property
    def at_walls(self) -> bool:
        """Whether a first-cell height is given."""
        return self.first_cell is not None or self.y_plus is not None

    def check_first_cell(self) -> None:
        """Raise InputError for a height out of range, or for fields that need or exclude each other."""
        if self.first_cell is not None and self.y_plus is not None:
            problem = "{first_cell} and {y_plus} both say how high the first cell is"
            raise InputError(problem, "give one of them")
        if (self.y_plus is None) != (self.reynolds is None):
            needed, known = ("reynolds", "y_plus") if self.reynolds is None else ("y_plus", "reynolds")
            raise InputError(f"{{{known}}} without {{{needed}}}", f"give {{{needed}}} as well")
        if self.y_plus is None and self.chord_fraction != 0.5:
            raise InputError("{chord_fraction} without {y_plus}", "give {y_plus} and {reynolds} as well")
        if self.first_cell is not None:
            check_height(self.first_cell, "first_cell")
        self.height()  # raises for values out of range

    def height(self, unit: float = 1.0) -> float | None:
        """Return the first-cell height; `unit` is the reference length of the Reynolds number."""
        if self.y_plus is None or self.reynolds is None:
            return self.first_cell
        from meshonet.geometry.spacing.y_plus import first_cell

        return first_cell(self.y_plus, self.reynolds, self.chord_fraction) * unit

    def height_note(self, where: str, unit: float = 1.0, in_unit: str = "") -> str:
        """Return how a height follows from y+, as text; `where` names the reference length."""
        from meshonet.geometry.spacing.y_plus import height_note

        return height_note(self.y_plus, self.reynolds, where, f"{self.height(unit) or 0.0:.6g}{in_unit}")


def check_height(height: float, parameter: str) -> None:
    """Raise InputError if a height is not positive, or not finite."""
    if not 0 < height < math.inf:
        raise InputError(f"a first cell of {height:g}", "give a positive height", parameter=parameter)
