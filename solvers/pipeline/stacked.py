"""Selects the kind of grid for sections: around a wing, a blade or an aircraft, in a duct or a blade row."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, TypeAlias

from meshonet.geometry.aircraft.aircraft import Aircraft
from meshonet.geometry.aircraft.dimensions import aircraft_dimensions
from meshonet.geometry.blocks.copies import copied
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.transform import rotated
from meshonet.geometry.blocks.wall_surface import wall_surface
from meshonet.geometry.errors import InputError
from meshonet.geometry.rows.dimensions import doubts, row_dimensions
from meshonet.geometry.rows.row import Row
from meshonet.geometry.sections.stack import Stack, Tip
from meshonet.geometry.threads import limited_to
from meshonet.solvers.aircraft.request import AircraftRequest, aircraft_request
from meshonet.solvers.keywords import refuse_given
from meshonet.solvers.pipeline.result import Result, judged
from meshonet.solvers.pipeline.stacks import make_stack, stack_surface
from meshonet.solvers.rows.request import RowRequest, row_request
from meshonet.solvers.solution import Solution
from meshonet.solvers.stacking.request import stack_request
from meshonet.solvers.stages import stage

Sections: TypeAlias = Stack | Row | Aircraft
"""Inputs of `meshonet stack`."""


def with_tip(what: Sections, tip: Tip | None, *, surface: bool = False) -> Sections:
    """Return `what`; if it is a stack and `tip` is not None, with a tip of this shape.

    Raises InputError: a tip for a row or an aircraft; `surface` for a row, which has no surface grid.
    """
    if isinstance(what, Stack):
        return what.with_tip(tip)
    name = "a row" if isinstance(what, Row) else "an aircraft"
    refuse_given(name, {"tip": tip, "surface": surface and isinstance(what, Row)})
    return what


def stacked_surface(what: Stack | Aircraft, **parameters: Any) -> tuple[Grid, tuple[str, ...]]:
    """Return the surface patches of a wing or an aircraft, and notes.

    Parameters are the fields of `StackRequest` or `AircraftRequest`.

    Raises InputError: see `stack_surface` and `make_aircraft`. Raises NoValidGridError: see `make_aircraft`.
    """
    if isinstance(what, Stack):
        return stack_surface(what, stack_request(**parameters))
    solution = make_aircraft(what, aircraft_request(**parameters)).solution
    return wall_surface(solution.grid), solution.notes


def make_stacked(what: Sections, **parameters: Any) -> Result:
    """Return the volume grid of a stack, a row or an aircraft, with its quality.

    Parameters are the fields of `StackRequest`, `RowRequest` or `AircraftRequest`.

    Raises InputError: a parameter that the request does not have; see also `make_stack`, `make_row` and
    `make_aircraft`. Raises NoValidGridError: see these functions.
    """
    if isinstance(what, Aircraft):
        return make_aircraft(what, aircraft_request(**parameters))
    if isinstance(what, Row):
        return make_row(what, row_request(**parameters))
    return make_stack(what, stack_request(**parameters))


_REMEDY = "use more nodes {around}, or a larger {first_cell}"  # where cells fold


_HIGHEST = 0.1
"""Largest height of first cells, in chords of the smallest section."""
_REACH = 0.8
"""Largest distance of the tip of a wing from the middle of the body, relative to that of the far field."""


def make_aircraft(aircraft: Aircraft, request: AircraftRequest | None = None) -> Result:
    """Return the grid around an aircraft or its half, with its quality.

    Raises InputError: a wing that does not begin in the body, does not leave it or reaches the far field.
    Raises NoValidGridError: cells are folded, unless folded cells are allowed.
    """
    request = request or aircraft_request()
    seconds: dict[str, float] = {}
    sizes = aircraft_dimensions(aircraft, request.height(), request.far_field)
    _refuse_thick_cells(aircraft, sizes.first_cell)
    _refuse_far_tip(aircraft, sizes.far_field)
    with limited_to(request.threads):
        with stage("load", seconds):
            from meshonet.solvers.aircraft.aircraft_grid import planned_grid
        with stage("grid", seconds):
            grid, growth, notes = planned_grid(aircraft, request)
        note = request.height_note(f"on a chord of {sizes.chord:.6g}", sizes.chord)
        notes = (*notes, *[note] * bool(note))
        solution = Solution(grid, "aircraft", notes=notes, dimensions=sizes, growth=growth)
        return judged(solution, seconds, request, remedy=_REMEDY)


def _refuse_thick_cells(aircraft: Aircraft, first: float) -> None:
    """Raise InputError for first cells that are high beside a section of a wing."""
    shortest = min(float(wing.chords.min()) for wing in aircraft.wings)
    if first > _HIGHEST * shortest:
        problem = f"first cells are {first:g} high at a wing with a chord of {shortest:g}"
        raise InputError(problem, f"use at most {_HIGHEST:g} of it", parameter="first_cell")


def _refuse_far_tip(aircraft: Aircraft, far: float) -> None:
    """Raise InputError for a wing whose tip is not far enough from a far field at this distance."""
    body = aircraft.body
    middle = 0.5 * float(body.meridian[0, 0] + body.meridian[-1, 0])
    for wing, (name, _) in zip(aircraft.wings, aircraft.patches, strict=True):
        x, y, z = wing.end
        away = math.hypot(x - middle, y - body.y, z)
        if away > _REACH * far:
            at = f"the tip of the {name} is {away:.6g} from the middle of the body"
            raise InputError(
                f"{at}, and the far field {far:.6g}", "put it further away", parameter="far_field"
            )


@contextmanager
def _in_terms_of_rows() -> Iterator[None]:
    """Name `inlet` and `outlet` of a section as the keys of the row's file, and coordinates of its plane."""
    try:
        yield
    except InputError as error:
        if error.parameter in ("inlet", "outlet"):
            error.place, error.parameter = error.parameter, ""
            error.remedy += " from the blade to the ends of hub and casing"
        if error.place.startswith("blade, ("):
            error.place = error.place.replace("blade, ", "blade at (m', theta) = ")
        raise


_ROW_REMEDY = "use more {cells}, or a larger {first_cell}"  # where cells fold


def make_row(row: Row, request: RowRequest | None = None) -> Result:
    """Return the grid of a row's passage, with its quality.

    Raises InputError: parameters that do not suit the row. Raises NoValidGridError: cells are folded, unless
    folded cells are allowed.
    """
    request = request or RowRequest()
    if not 1 <= request.copies <= row.blades:
        problem = f"{request.copies} copies of {row.blades} passages"
        raise InputError(problem, f"use 1 to {row.blades}", parameter="copies")
    seconds: dict[str, float] = {}
    with limited_to(request.threads):
        with stage("load", seconds):
            from meshonet.solvers.rows.row_grid import row_grid
        with stage("grid", seconds), _in_terms_of_rows():
            grid, notes = row_grid(row, request)
            grid = copied(grid, request.copies)
            grid = grid if row.frame is None else rotated(grid, row.frame.inverse())
        dimensions = row_dimensions(row)
        own = (*row.changes, *doubts(dimensions), row.surface.edges)
        note = request.height_note(f"on a chord of {row.chord:.6g}", scale=row.chord)
        notes = (*own, *notes, *[note] * bool(note))
        solution = Solution(grid, "row", notes=notes, dimensions=dimensions, growth=request.ratio)
        return judged(solution, seconds, request, remedy=_ROW_REMEDY)
