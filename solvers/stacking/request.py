"""Options for the surface or volume of a stack."""

from dataclasses import dataclass
from typing import Any, ClassVar

from meshonet.geometry.blocks.revolve import AxisLine, Revolution, revolution
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.first_cell import FirstCell
from meshonet.geometry.spacing.growth import check_growth
from meshonet.solvers.keywords import request_from
from meshonet.solvers.stacking.section_nodes import GAP
from meshonet.solvers.stacking.wing_surface import (
    DEFAULT_AROUND,
    DEFAULT_SPAN,
    WingSurface,
)

MOST_CELLS = 200_000_000
DEFAULT_FIRST_CELL, DEFAULT_FAR_FIELD = 1e-3, 15.0  # chords


@dataclass(frozen=True)
class StackRequest(FirstCell):
    """Options of the surface or volume grid of a stack, checked on construction.

    The unit of lengths is the longest chord; in a duct it is that of its sections' positions.

    Parameters
    ----------
    around : int, optional
        Number of nodes around a section, an odd number; the first node is counted again as the last. None:
        129.
    span : int, optional
        Number of nodes from the first section to the last. None: 49; along ducts and blades with unevenly
        spaced sections as many more as make cells change gradually.
    cells : int, optional
        Approximate number of cells of the volume around a wing or blade, instead of `around`, `span` or both.
    base : float, optional
        Smallest height of trailing edges, in chords of each section. Thinner trailing edges are opened to
        this height. None: 0.005, or 0.001 for a wing from a surface file.
    first_cell : float, optional
        First-cell height at every wall node; None: 1e-3.
    y_plus, reynolds, chord_fraction : float, optional
        First-cell height as y+, instead of `first_cell`. The conversion assumes a turbulent flat plate; the
        Reynolds number is based on the longest chord, the width of the widest section of a duct.
    layers : int, optional
        Number of nodes along each grid line away from the wall, including the wall node; None: as many as
        `growth` needs.
    growth : float, optional
        Growth ratio of cells away from the wall, if `layers` is not given; None: 1.2.
    far_field : float, optional
        Distance of the far field.
    revolve : float, optional
        Angle in degrees, from the first section to the last, by which the z axis of a blade or duct is bent
        around `axis`.
    axis : AxisLine, optional
        Axis of `revolve`, in the plane of the sections; None: the x axis.
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

    fewest_cells: ClassVar[int] = 1000
    around: int | None = None
    span: int | None = None
    cells: int | None = None
    base: float | None = None
    layers: int | None = None
    growth: float | None = None
    far_field: float = DEFAULT_FAR_FIELD
    revolve: float | None = None
    axis: AxisLine | None = None
    threads: int | None = None
    percentiles: bool = False
    allow_invalid: bool = False

    def __post_init__(self) -> None:
        self.check_first_cell()
        if not 1.0 < self.far_field <= 1e6:
            problem = f"{self.far_field:g} chords"
            raise InputError(problem, "use more than 1 and at most 1e6", parameter="far_field")
        if not self.height() >= 1e-12:
            raise InputError(f"{self.height():g}", "use 1e-12 or more", parameter="first_cell")
        if self.layers is not None and not 3 <= self.layers <= 100_000:
            raise InputError(f"{self.layers} nodes", "use 3 to 100000", parameter="layers")
        check_growth(self.growth)
        if self.layers is not None and self.growth is not None:
            raise InputError("{layers} and {growth} both say how many there are", "give one of them")
        turn = self.turn
        if turn is not None and turn.closed:
            raise InputError("a whole turn", "use less than 360", parameter="revolve")
        if self.cells is not None and not self.fewest_cells <= self.cells <= MOST_CELLS:
            remedy = f"use {self.fewest_cells} to {MOST_CELLS}"
            raise InputError(f"{self.cells} cells", remedy, parameter="cells")
        if self.threads is not None and self.threads < 1:
            raise InputError(f"{self.threads} threads", "use 1 or more", parameter="threads")

    def check_far_field(self) -> None:
        """Raise InputError for a first cell that is high beside the distance of the far field."""
        if not self.height() < 0.5 * self.far_field:
            problem = f"{self.height():g} chords"
            raise InputError(problem, "use less than half of {far_field}", parameter="first_cell")

    @property
    def turn(self) -> Revolution | None:
        """The revolution that replaces z, if any."""
        return revolution(self.revolve, None, self.axis)

    @property
    def surface(self) -> WingSurface:
        """Node counts of the surface."""
        return WingSurface(
            self.around or DEFAULT_AROUND, self.span or DEFAULT_SPAN, GAP if self.base is None else self.base
        )

    def height(self, unit: float = 1.0) -> float:
        """Return the first-cell height in chords; `unit` is the reference length for y+, in chords."""
        height = super().height(unit)
        return DEFAULT_FIRST_CELL if height is None else height


def stack_request(**parameters: Any) -> StackRequest:
    """Return a request from keyword parameters, which are the fields of `StackRequest`.

    ``wall_spacing`` is another name of ``first_cell``. Raises InputError: as `StackRequest`; an unknown
    parameter.
    """
    return request_from(StackRequest, "a stack", parameters)
