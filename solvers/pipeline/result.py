"""Result of a request: a checked grid with its quality and times."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from meshonet.geometry.arrays import norms
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import NoValidGridError
from meshonet.geometry.notes import change_facts
from meshonet.geometry.quality.measure import measure, worst_cells_of
from meshonet.geometry.summary import Quality
from meshonet.solvers.solution import Outcome, Solution
from meshonet.solvers.stages import stage

if TYPE_CHECKING:
    from meshonet.geometry.quality.lines import Lines
    from meshonet.solvers.pipeline.deformations import DeformRequest
    from meshonet.solvers.pipeline.request import GridRequest
    from meshonet.solvers.progress import HistoryRow
    from meshonet.solvers.rows.request import RowRequest
    from meshonet.solvers.stacking.request import StackRequest

JUMP = 5.0
"""Ratio of neighbouring cells along a wall above which a note is written even if no growth is prescribed."""


@dataclass(frozen=True, eq=False)
class Result:
    """A grid and the information for its report.

    Parameters
    ----------
    solution : Solution
        The grid, the method, and the stages of the computation.
    quality : Quality
        Quality of the grid.
    seconds : dict
        Wall-clock seconds of each stage: ``boundary``, ``load`` (of modules and models, once per process),
        ``grid`` (from boundary nodes to grid nodes), ``guard`` (test for folded cells and repair) and
        ``quality``.
    notes : tuple of str, optional
        Notes for the user, including those of boundary and solution; names of options are in braces.
    history : tuple of HistoryRow, optional
        Convergence history of the iteration, if the request asks for it.
    lines : Lines, optional
        Growth ratios along the grid lines of a multi-block grid, if a note of the report needs them.
    """

    solution: Solution
    quality: Quality
    seconds: Mapping[str, float]
    notes: tuple[str, ...] = ()
    history: tuple[HistoryRow, ...] = ()
    lines: Lines | None = None

    @property
    def grid(self) -> Grid:
        """The grid."""
        return self.solution.grid

    @property
    def outcome(self) -> Outcome:
        """How the computation ended, with advice on what to try next."""
        return Outcome.FOLDED if self.quality.folded else self.solution.outcome


def judged(
    solution: Solution,
    seconds: dict[str, float],
    request: GridRequest | StackRequest | RowRequest | DeformRequest,
    *,
    remedy: str,
    history: tuple[HistoryRow, ...] = (),
) -> Result:
    """Return a solution with the quality of its grid; the time of the measurement is added to `seconds`.

    A note of the result says where cells grow by more than the prescribed ratio. If none is prescribed, it
    says where the lengths of neighbouring cells along a wall differ by a factor above `JUMP`. Raises
    NoValidGridError, with the text `remedy`, if cells are folded and the request does not allow that.
    """
    with stage("quality", seconds):
        quality = measure(solution.grid, percentiles=request.percentiles)
    if quality.folded and not request.allow_invalid:
        problem = f"{quality.folded} of {quality.cells} cells are folded; {remedy}"
        raise NoValidGridError(problem, worst_cells_of(solution.grid))
    facts = change_facts(solution.notes) if solution.notes else {}
    if facts:
        solution = replace(solution, grid=solution.grid.with_provenance(**facts))
    run = None
    if solution.growth < math.inf:
        from meshonet.solvers.pipeline.wall_facts import growth_note, lines_without_percentiles

        with stage("quality", seconds):
            run = lines_without_percentiles(solution.grid) if solution.grid.topology == "blocks" else None
            notes = (*solution.notes, *growth_note(solution.grid, solution.growth, run))
        solution = replace(solution, notes=notes)
    elif (nodes := solution.grid.blocks[0].nodes).ndim == 3:
        steps = norms(np.diff(nodes[:, [0, -1]], axis=0))
        small, large = np.minimum(steps[1:], steps[:-1]), np.maximum(steps[1:], steps[:-1])
        if len(solution.grid.blocks) > 1 or (large > JUMP * small).any():
            from meshonet.solvers.pipeline.wall_facts import jump_note

            solution = replace(solution, notes=(*solution.notes, *jump_note(solution.grid, JUMP)))
    return Result(solution, quality, seconds, solution.notes, history, run)
