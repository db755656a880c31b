"""Division of a circle into cells, and notes."""

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.elementary import cos, product, sin
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.growth import check_growth
from meshonet.solvers.sweeping.butterfly import GROWTH, CrossSection, FiveBlocks, filled, planned

AROUND = 88
"""Default number of cells around; the area is then 0.08 % too small: 1 - sin(x)/x with x = 2 pi / 88."""
_LEAST = 84  # fewest cells around with which it is accurate to 0.1 %; its quarters cannot be halved
# quarter turns: east, north, west, south
_TURNS = (((1, 0), (0, 1)), ((0, -1), (1, 0)), ((-1, 0), (0, -1)), ((0, 1), (-1, 0)))


@dataclass(frozen=True)
class Disc:
    """A circle and its division into cells.

    Raises InputError if a value is out of its range, or if both `cells` and `around` are given.
    """

    radius: float  # radius in any unit
    cells: int | None = None  # approximate number of cells; None: as few as `around` permits
    first_cell: float | None = None  # first-cell height at the wall; None: about that of cells in the middle
    growth: float | None = None  # largest ratio of neighbouring cells; None: 1.2
    # number of cells along the circle, a multiple of four; None: by `cells`, 84 or more; without, `AROUND`
    around: int | None = None

    def __post_init__(self) -> None:
        if not 0 < self.radius < 1e12:
            raise InputError(f"a circle of radius {self.radius:g}", "use more than 0")
        if self.cells is not None and self.around is not None:
            raise InputError("{cells} and {around} both say how fine a circle is", "give one of them")
        if self.cells is not None and not 12 <= self.cells <= 10_000_000:
            raise InputError(f"{self.cells} cells", "use 12 to 10 million", parameter="cells")
        if self.around is not None and (self.around % 4 or not 8 <= self.around <= 10_000):
            remedy = "use a multiple of 4 from 8 to 10000"
            raise InputError(f"{self.around} cells around a circle", remedy, parameter="around")
        if self.first_cell is not None and not 1e-9 < self.first_cell / self.radius < 0.2:
            problem = f"{self.first_cell:g} in a circle of radius {self.radius:g}"
            raise InputError(problem, "use up to a fifth of the radius", parameter="first_cell")
        check_growth(self.growth)

    def section(self, side: int) -> CrossSection:
        """Return the circle with `side` cells on each quarter."""
        u = np.linspace(-1.0, 1.0, side + 1)
        arc = self.radius * np.stack([cos(0.25 * np.pi * u), sin(0.25 * np.pi * u)], axis=1)
        return CrossSection([product(arc, np.array(turn).T) for turn in _TURNS], self.first_cell)

    def plan(self, side: int) -> FiveBlocks:
        """Return the division into five blocks with `side` cells on each quarter of the circle."""
        return planned([self.section(side)], self.growth or GROWTH, radial=True)

    def count(self, side: int) -> int:
        """Return the number of cells of the disc if each quarter of the circle has `side` cells."""
        return side * side + 4 * side * self.plan(side).rows

    @cached_property
    def side(self) -> int:
        """Number of cells on each quarter of the circle."""
        if self.around is not None:
            return self.around // 4
        if (wanted := self.cells) is None:
            return AROUND // 4
        low, high = _LEAST // 4, math.isqrt(wanted)
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if self.count(middle) < wanted else (low, middle)
        nearest = [side for side in (low, high) if side >= low]
        return min(nearest, key=lambda side: abs(self.count(side) - wanted))

    @property
    def note(self) -> str:
        """Note if the disc has more cells than requested; else empty."""
        wanted = self.cells
        if wanted is None or self.side > _LEAST // 4 or self.count(self.side) <= 1.1 * wanted:
            return ""
        disc = replace(self, cells=None)
        side = min(range(2, _LEAST // 4), key=lambda side: abs(disc.count(side) - wanted))
        angle = 0.5 * math.pi / side
        part = math.sin(angle) / angle
        return (
            f"a circle has {self.count(self.side)} cells or more instead of {wanted}: {_LEAST} around "
            f"keep its area within 0.1 %. {{around}} {4 * side} makes {disc.count(side)} cells, and an area "
            f"{100 * (1 - part):.2g} % too small; the area is kept with a radius of "
            f"{self.radius / math.sqrt(part):.10g}"
        )


def butterfly(disc: Disc) -> Grid:
    """Return the grid of a disc around the origin, whose boundary is the patch ``wall``."""
    return replace(filled(disc.section(disc.side), disc.plan(disc.side)), name="circle")
