"""Notes of results, which are the attribute `notes` of grids in Python."""

from collections.abc import Iterable
from dataclasses import replace

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import spelled
from meshonet.solvers.pipeline.result import Result


def noted(result: Result) -> Grid:
    """Return the grid of a result with the notes of the result."""
    return with_notes(result.grid, result.notes)


def with_notes(grid: Grid, notes: Iterable[str]) -> Grid:
    """Return the grid with notes, in which names of parameters are those of Python."""
    return replace(grid, notes=tuple(spelled(note) for note in notes))
