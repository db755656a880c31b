"""Rows of blades: the grid of a passage, measured."""

from collections.abc import Iterator
from contextlib import contextmanager

from meshonet.geometry.blocks.copies import copied
from meshonet.geometry.blocks.transform import rotated
from meshonet.geometry.errors import InputError
from meshonet.geometry.rows.dimensions import doubts, row_dimensions
from meshonet.geometry.rows.row import Row
from meshonet.geometry.threads import limited_to
from meshonet.solvers.pipeline.result import Result, judged
from meshonet.solvers.rows.request import RowRequest
from meshonet.solvers.solution import Solution
from meshonet.solvers.stages import stage


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


_REMEDY = "use more {cells}, or a larger {first_cell}"  # where cells fold


def make_row(row: Row, request: RowRequest | None = None) -> Result:
    """Return the grid of one passage of a blade row, with its quality.

    Raises InputError if parameters do not suit the row. Raises NoValidGridError if cells are folded and the
    request does not allow that.
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
        notes = (*own, *notes, *request.height_notes(f"on a chord of {row.chord:.6g}", scale=row.chord))
        solution = Solution(grid, "row", notes=notes, dimensions=dimensions, growth=request.ratio)
        return judged(solution, seconds, request, remedy=_REMEDY)
