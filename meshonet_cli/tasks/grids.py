"""Task of `tfi`, `solve-pde` and `infer`: one request, many boundaries, a report of each grid."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from functools import partial
from operator import attrgetter
from typing import TYPE_CHECKING, Any

from meshonet.formats.registry import read_grids, read_shapes
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.notes import UNJUDGED
from meshonet.geometry.shapes.shape import Shape
from meshonet.geometry.spacing.sampling import DEFAULT_NI, DEFAULT_NJ
from meshonet.solvers.pipeline.choose_method import method_of
from meshonet.solvers.pipeline.make_grid import MOST_NODES, make_grids_of
from meshonet.solvers.pipeline.request import GridRequest
from meshonet.solvers.pipeline.result import Result
from meshonet.solvers.stages import stage
from meshonet_cli.batch.item import Item, Outcome, Pair, made
from meshonet_cli.batch.provenance import provenance
from meshonet_cli.batch.run import Batch, BatchTask
from meshonet_cli.report.grid import Report

if TYPE_CHECKING:
    from meshonet.geometry.quality.criteria import Criteria

SHARED = 16  # members that one of several processes gets at a time at the most, fewer of large grids


def _grids(
    members: Iterable[Item[Shape]], request: GridRequest, criteria: Criteria | None, detailed: bool
) -> Iterator[Pair]:
    """Yield each member with its grid and report, or with its error."""
    for member, result in make_grids_of(members, request, attrgetter("what")):
        outcome: Outcome
        try:
            outcome = reported(member, made(result), criteria, detailed=detailed)
        except Exception as error:
            outcome = error
        yield member, outcome


def reported(
    member: Item[Any], result: Result, criteria: Criteria | None, *, detailed: bool = True
) -> tuple[Grid, Report]:
    """Return the grid of `member` and its report; the grid's metadata get the command and the verdict.

    With `detailed`, the report on a multi-block grid has angles and growth of its lines. Raises InputError if
    a quality limit names a quantity that the cells do not have.
    """
    solution, grid = result.solution, result.solution.grid
    counts = grid.blocks[0].counts if len(grid.blocks) == 1 else (None, None)
    report = Report(
        member, method=solution.method, ni=counts[0], nj=counts[1], topology=grid.topology,
        wake=grid.wake, quality=result.quality, model=solution.model, path=solution.path,
        residual=solution.residual, cycles=solution.cycles, notes=result.notes, history=result.history,
        confidence=solution.confidence, dimensions=solution.dimensions,
    )  # fmt: skip
    report.seconds |= result.seconds
    facts: dict[str, str | None] = {**UNJUDGED, **provenance()}
    with stage("quality", report.seconds):
        if grid.topology == "blocks":
            from meshonet.geometry.quality.blocks import block_counts, block_figures

            report.blocks = (
                block_figures(grid, result.quality, result.lines) if detailed else block_counts(grid)
            )
        if criteria:
            report.judgement = judgement = criteria.judge(grid, result.quality)
            report.left_out = criteria.leave_out and judgement.verdict == "fail"
            facts |= {"verdict": judgement.verdict, "limits_exceeded": ", ".join(judgement.beyond)}
    return grid.with_provenance(**facts), report


def made_by(
    member: Item[Any], solve: Callable[[Any], Result], criteria: Criteria | None
) -> tuple[Grid, Report]:
    """Return the grid that `solve` makes from the content of `member`, and its report."""
    return reported(member, solve(member.what), criteria)


def write_grids(
    batch: Batch, request: GridRequest, criteria: Criteria | None, *, history: str | None = None,
    assemble: bool = False,
) -> int:  # fmt: skip
    """Make a grid from each boundary of a batch and return the exit code.

    Parameters
    ----------
    criteria : limits on quality; if a grid does not meet them, the exit code is 1.
    history : CSV file to which solver cycles are written.
    assemble : whether all inputs together form one domain.
    """
    percentiles = criteria is not None and criteria.percentiles
    request = replace(request, threads=batch.engine.threads(request.threads), percentiles=percentiles)
    session, sampling = batch.session, request.sampling
    session.judges = criteria is not None
    nodes = (sampling.ni or DEFAULT_NI) * (sampling.nj or DEFAULT_NJ)
    alone = method_of(request).together is None
    task = BatchTask(
        partial(read_shapes, fmt=batch.files.from_format, surfaces=request.of_surface),
        partial(_grids, request=request, criteria=criteria, detailed=session.as_json),
        nodes=None if request.asks_for_blocks else nodes,
        together=1 if alone else max(1, min(SHARED, MOST_NODES // nodes)),
        assembled=sampling if assemble else None,
        joined="the walls of one channel belong in one file",
    )  # fmt: skip
    if history or session.live:
        from meshonet_cli.report.cycles import followed

        with followed(session, history) as written:
            batch.deliver(task, written)
    else:
        batch.deliver(task, session.written)
    return session.finish()


def initial_grid(path: str | None) -> Grid | None:
    """Return the first grid in the file `path`, or None if `path` is None."""
    return None if path is None else next(read_grids(path))
