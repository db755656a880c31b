"""How a stack becomes a surface or a volume."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

from meshonet.geometry.blocks.revolve import AxisLine, Revolution, revolution
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.first_cell import FirstCell
from meshonet.geometry.spacing.growth import check_growth
from meshonet.solvers.stacking.section_nodes import GAP
from meshonet.solvers.stacking.wing_surface import DEFAULT_AROUND, DEFAULT_SPAN, WingSurface

DEFAULT_FIRST_CELL, DEFAULT_FAR_FIELD = 1e-3, 15.0  # chords


@dataclass(frozen=True)
class StackRequest(FirstCell):
    """How a stack becomes a surface or a volume; validates itself. Lengths are in longest chords.

    Parameters
    ----------
    around : int, optional
        Nodes around a section, the first one repeated; odd.
    span : int, optional
        Nodes from the first section to the last.
    base : float, optional
        Least height of trailing edges, in chords of their section.
    first_cell : float, optional
        Height of the first cell at every node of the wall; None is 1e-3.
    y_plus, reynolds, chord_fraction : float, optional
        The same height by its y+, converted for a flat plate; the Reynolds number is that of the longest
        chord.
    layers : int, optional
        Nodes away from the wall, the wall's included; None: what `growth` needs.
    growth : float, optional
        Ratio of neighbouring cells away from the wall, where `layers` is not given; None is 1.2.
    far_field : float, optional
        Distance of the far field.
    revolve : float, optional
        Degrees about an axis that z becomes, from the first section of a blade or duct to the last.
    axis : AxisLine, optional
        That axis, in the plane of the sections; None is the x axis.
    threads : int, optional
        Threads that kernels work with; None: all there are.
    percentiles : bool, optional
        Whether the quality includes percentiles.
    allow_invalid : bool, optional
        Whether a folded grid is a result.

    Raises
    ------
    InputError
        A value out of its range; parameters that need or exclude each other.
    """

    around: int = DEFAULT_AROUND
    span: int = DEFAULT_SPAN
    base: float = GAP
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
        if self.threads is not None and self.threads < 1:
            raise InputError(f"{self.threads} threads", "use 1 or more", parameter="threads")

    @property
    def turn(self) -> Revolution | None:
        """How z becomes an angle."""
        return revolution(self.revolve, None, self.axis)

    @property
    def surface(self) -> WingSurface:
        """Its nodes on the surface."""
        return WingSurface(self.around, self.span, self.base)

    def height(self, unit: float = 1.0) -> float:
        """Return the height of the first cell in chords, that of a y+ where a chord is `unit`."""
        height = super().height(unit)
        return DEFAULT_FIRST_CELL if height is None else height


def stack_request(**parameters: Any) -> StackRequest:
    """Return the request with the parameters, fields of `StackRequest`; ``wall_spacing`` is ``first_cell``.

    Raises InputError: as `StackRequest`, or a parameter that it does not have.
    """
    if "wall_spacing" in parameters:
        parameters["first_cell"] = parameters.pop("wall_spacing")
    known = [each.name for each in fields(StackRequest)]
    for name in parameters:
        if name not in known:
            raise InputError(f"a stack has no {{{name}}}", f"leave {{{name}}} out")
    return StackRequest(**parameters)
