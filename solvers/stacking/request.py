"""Options for the surface or volume of a stack."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from meshonet.geometry.blocks.revolve import AxisLine, Revolution, revolution
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.first_cell import FirstCell
from meshonet.geometry.spacing.growth import check_growth
from meshonet.solvers.keywords import request_from
from meshonet.solvers.stacking.section_nodes import GAP
from meshonet.solvers.stacking.wing_surface import DEFAULT_AROUND, DEFAULT_SPAN, WingSurface

MOST_CELLS = 200_000_000
DEFAULT_FIRST_CELL, DEFAULT_FAR_FIELD = 1e-3, 15.0  # chords


@dataclass(frozen=True)
class StackRequest(FirstCell):
    """Options for the surface or volume of a stack, checked on construction. Lengths are in longest chords.

    Parameters
    ----------
    around : int, optional
        Number of nodes around a section, including the repeated first one; odd. None is 129.
    span : int, optional
        Number of nodes from the first section to the last. None is 49.
    cells : int, optional
        Approximate number of cells of the volume around a wing or blade, in place of `around` and `span` or
        of one of them.
    base : float, optional
        Smallest height of trailing edges, in chords of their section; None is 0.005, and 0.001 for a wing
        that is a surface.
    first_cell : float, optional
        First-cell height at every wall node; None is 1e-3.
    y_plus, reynolds, chord_fraction : float, optional
        First-cell height as y+, converted for a flat plate; the Reynolds number is based on the longest
        chord.
    layers : int, optional
        Number of nodes along each line away from the wall, including the wall node; None: as many as `growth`
        needs.
    growth : float, optional
        Ratio of neighbouring cells away from the wall if `layers` is not given; None is 1.2.
    far_field : float, optional
        Distance of the far field.
    revolve : float, optional
        Angle in degrees about `axis` from the first section of a blade or duct to the last, instead of z.
    axis : AxisLine, optional Axis in the plane of the sections; None is the x axis.
    threads : int, optional
        Number of threads; None: all cores.
    percentiles : bool, optional
        Whether the quality includes percentiles.
    allow_invalid : bool, optional
        Whether a folded grid is returned.

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
        if not 1e-12 <= self.height() < 0.5 * self.far_field:
            problem = f"{self.height():g} chords"
            raise InputError(problem, "use 1e-12 to half of {far_field}", parameter="first_cell")
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
        """Return the first-cell height in chords; `unit` is the reference length of a y+, in chords."""
        height = super().height(unit)
        return DEFAULT_FIRST_CELL if height is None else height


def stack_request(**parameters: Any) -> StackRequest:
    """Return a request from keyword parameters, which are the fields of `StackRequest`.

    ``wall_spacing`` is another name of ``first_cell``. Raises InputError: as `StackRequest`, or an unknown
    parameter.
    """
    return request_from(StackRequest, "a stack", parameters)
