"""Options of multi-block grids."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from meshonet.geometry.errors import InputError
from meshonet.geometry.reach import MOST_CELLS
from meshonet.geometry.spacing.first_cell import FirstCell

if TYPE_CHECKING:
    from meshonet.geometry.layout.layout import Layout

CELLS = 2500  # default number of cells
LAYERED_CELLS, PER_BODY, MOST_BODIES = 20_000, 10_000, 3
"""Default number of cells with layers around one body; additional cells for the second and for the third."""
MOST_HALVINGS = 8  # 65,536 times as many cells
MOST_ALONG = 100_000  # largest number of cells along a side
LARGEST_PITCH = 1e12  # largest pitch in the unit of the blade, so that squares of coordinates do not overflow


@dataclass(frozen=True)
class BlockRequest(FirstCell):
    """Options of the multi-block grid of a domain, checked on construction; see also `GridRequest`.

    Parameters
    ----------
    cells : number of cells. Without `cell_size` and `res`, see `usual_cells` for its default.
    res : number of cells along the longest extent of the domain.
    length : reference length of the Reynolds number; None is the extent of the bodies.
    walls : names of the walls that have layers; by default those of `Domain.layered_loops`.
    inlet, outlet : lengths of the passage upstream and downstream of a blade, in axial chords; None is 1.
    refine : how often all cells are halved. `cells`, `cell_size` and `res` apply to the coarsest grid of the
        family; `first_cell` and `growth` apply to the finest grid, which is the result.

    Raises InputError if a value is out of range, parameters exclude each other, or a needed one is missing.
    """

    cells: int | None = None
    cell_size: float | None = None
    res: int | None = None
    growth: float | None = None
    constant_layers: int | None = None
    walls: tuple[str, ...] = ()
    pitch: tuple[float, float] | None = None
    inlet: float | None = None
    outlet: float | None = None
    layout: Layout | None = None
    refine: int = 0
    periodic: tuple[tuple[str, str], ...] = ()
    count: Mapping[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        sizes = [name for name in ("cells", "cell_size", "res") if getattr(self, name) is not None]
        if len(sizes) > 1:
            both = f"{{{sizes[0]}}} and {{{sizes[1]}}} both say how many cells there are"
            raise InputError(both, "give one of them")
        self._check_counts()
        if not 0 <= self.refine <= MOST_HALVINGS:
            remedy = f"use 0 to {MOST_HALVINGS}"
            raise InputError(f"cells halved {self.refine} times", remedy, parameter="refine")
        for name in ("cell_size", "inlet", "outlet"):
            value = getattr(self, name)
            if value is not None and not 0 < value < math.inf:
                raise InputError(f"{value:g} is not a positive length", "give e.g. 0.1", parameter=name)
        if any(not name for name in self.walls):
            raise InputError("an empty name", "give the names of walls, e.g. slat,flap", parameter="walls")
        if self.walls and not self.at_walls:
            problem = "{walls} without a first cell"
            raise InputError(problem, "give {first_cell} or {y_plus} as well")
        if self.walls and self.by_wall:
            problem = "{walls} beside a first cell for each wall"
            raise InputError(problem, "drop {walls}: the walls with a first cell have layers")
        if self.pitch is not None and not 0 < math.hypot(*self.pitch) < LARGEST_PITCH:
            remedy = f"give DX,DY from one blade to the next, below {LARGEST_PITCH:g}"
            length = math.hypot(*self.pitch)
            raise InputError(f"a pitch of length {length:g}", remedy, parameter="pitch")
        for name in ("inlet", "outlet"):
            if getattr(self, name) is not None and self.pitch is None:
                remedy = f"give {{pitch}} as well, or drop {{{name}}}"
                raise InputError(f"{{{name}}} without {{pitch}}", remedy)

    def _check_counts(self) -> None:
        if self.cells is not None and not 1 <= self.cells <= MOST_CELLS:
            raise InputError(f"{self.cells} cells", f"use 1 to {MOST_CELLS}", parameter="cells")
        for name, count in self.count.items():
            if not 1 <= count <= MOST_ALONG:
                problem = f"{count} cells along {name!r}"
                raise InputError(problem, f"use 1 to {MOST_ALONG}", parameter="count")

    @property
    def layered(self) -> tuple[str, ...]:
        """Names of the walls with layers; if empty, the loops `Domain.layered_loops` have layers."""
        return self.by_wall or self.walls

    def default_cells(self, bodies: int) -> int:
        """Return the default number of cells before refinement, for this number of `bodies`.

        If the refined grid would have more than `MOST_CELLS`, the number is reduced, but at most by half.
        """
        usual, room = self.usual_cells(bodies), MOST_CELLS // self.multiple**2
        return room if usual // 2 <= room < usual else usual

    def usual_cells(self, bodies: int) -> int:
        """Return the default number of cells of a grid that is not refined, for this number of `bodies`."""
        more = PER_BODY * (min(max(bodies, 1), MOST_BODIES) - 1)
        return LAYERED_CELLS + more if self.at_walls else CELLS

    @property
    def multiple(self) -> int:
        """Divisor of all numbers of cells: 2 to the power of `refine`."""
        return 1 << self.refine
