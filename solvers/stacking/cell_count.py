"""Node counts around the sections of a wing or blade, and along its span, from a number of cells."""

from dataclasses import replace

from meshonet.geometry.errors import InputError
from meshonet.geometry.sections.stack import Stack
from meshonet.solvers.stacking.request import StackRequest
from meshonet.solvers.stacking.section_nodes import LEAST_AROUND, MOST_AROUND
from meshonet.solvers.stacking.wing_surface import DEFAULT_AROUND, DEFAULT_SPAN, LEAST_SPAN, cap_of

_ALONG = (DEFAULT_SPAN - 1) / (DEFAULT_AROUND - 1)  # cells along the span per cell around a section

_ENOUGH = 1.1  # ratio of the number of cells to the requested one above which a note says so


def with_counts(
    stack: Stack, request: StackRequest, cells: int, rows: int
) -> tuple[StackRequest, tuple[str, ...]]:
    """Return the request with node counts for about `cells` cells, and notes.

    Each grid line from the wall outwards has `rows` cells. Node counts that the request sets are kept. Raises
    InputError if cells, nodes around and nodes along the span are all given.
    """
    if request.around is not None and request.span is not None:
        raise InputError("{cells}, {around} and {span} say how fine the grid is", "give two of them at most")
    cap = cap_of(stack) if stack.kind == "wing" else None
    least_span = max(LEAST_SPAN, len(stack.sections))
    surface = cells / rows

    def beside(around: int) -> int:
        return cap.cells(around) if cap else 0

    def away(around: int) -> float:
        """Return by how much the number of cells of the surface differs from the desired number.

        As a function of `around` it has a single minimum.
        """
        along = request.span or max(least_span, round(_ALONG * (around - 1)) + 1)
        return abs((around - 1) * (along - 1) + beside(around) - surface)

    around = request.around or min(range(LEAST_AROUND, MOST_AROUND + 1, 2), key=away)
    span = request.span or max(least_span, round((surface - beside(around)) / (around - 1)) + 1)
    made = rows * ((around - 1) * (span - 1) + beside(around))
    note = f"{rows} layers of cells need at least {made} cells in all, more than {cells}"
    notes = (note,) if made > _ENOUGH * cells else ()
    return replace(request, around=around, span=span, cells=None), notes
