"""Selects the kind of grid for sections: around a wing, a blade or an aircraft, in a duct or a blade row."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeAlias

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.sections.stack import Stack, Tip
from meshonet.solvers.keywords import refuse_given
from meshonet.solvers.pipeline.result import Result

if TYPE_CHECKING:
    from meshonet.geometry.aircraft.aircraft import Aircraft
    from meshonet.geometry.rows.row import Row

Sections: TypeAlias = "Stack | Row | Aircraft"  # inputs of `meshonet stack`


def with_tip(what: Sections, tip: Tip | None, *, surface: bool = False) -> Sections:
    """Return `what`; if `tip` is given, the tip of the stack has this shape.

    Raises InputError if a row or an aircraft gets a tip, or if only the `surface` of a row is requested.
    """
    if isinstance(what, Stack):
        return what.with_tip(tip)
    from meshonet.geometry.rows.row import Row

    name = "a row" if isinstance(what, Row) else "an aircraft"
    refuse_given(name, {"tip": tip, "surface": surface and isinstance(what, Row)})
    return what


def stacked_surface(what: Stack | Aircraft, **parameters: Any) -> tuple[Grid, tuple[str, ...]]:
    """Return the surface patches of a wing, a blade or an aircraft, and notes.

    `parameters` are fields of `StackRequest` or `AircraftRequest`. Raises the errors of `stack_surface` or
    `make_aircraft`.
    """
    if isinstance(what, Stack):
        from meshonet.solvers.pipeline.stacks import stack_surface
        from meshonet.solvers.stacking.request import StackRequest

        return stack_surface(what, StackRequest.of(**parameters))
    from meshonet.geometry.blocks.wall_surface import wall_surface
    from meshonet.solvers.aircraft.request import AircraftRequest
    from meshonet.solvers.pipeline.aircraft import make_aircraft

    solution = make_aircraft(what, AircraftRequest.of(**parameters)).solution
    return wall_surface(solution.grid), solution.notes


def make_stacked(what: Sections, **parameters: Any) -> Result:
    """Return the volume grid of a stack, a row or an aircraft, with its quality.

    `parameters` are fields of `StackRequest`, `RowRequest` or `AircraftRequest`. Raises InputError for
    other parameters, and the errors of `make_stack`, `make_row` or `make_aircraft`.
    """
    if isinstance(what, Stack):
        from meshonet.solvers.pipeline.stacks import make_stack
        from meshonet.solvers.stacking.request import StackRequest

        return make_stack(what, StackRequest.of(**parameters))
    from meshonet.geometry.rows.row import Row

    if isinstance(what, Row):
        from meshonet.solvers.pipeline.rows import make_row
        from meshonet.solvers.rows.request import RowRequest

        return make_row(what, RowRequest.of(**parameters))
    from meshonet.solvers.aircraft.request import AircraftRequest
    from meshonet.solvers.pipeline.aircraft import make_aircraft

    return make_aircraft(what, AircraftRequest.of(**parameters))
