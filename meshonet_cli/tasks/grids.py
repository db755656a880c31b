"""What `tfi`, `solve-pde` and `infer` share: one request, many boundaries, a report of each grid."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from meshonet.formats.output import whole_file
from meshonet.formats.registry import read_grids, read_shapes
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.criteria import Criteria
from meshonet.geometry.shapes.shape import Shape
from meshonet.geometry.spacing.sampling import DEFAULT_NI, DEFAULT_NJ
from meshonet.solvers.pipeline.choose_method import method_of
from meshonet.solvers.pipeline.make_grid import MOST_NODES, make_grids_of
from meshonet.solvers.pipeline.request import GridRequest
from meshonet.solvers.pipeline.result import Result
from meshonet_cli.batch.item import Item, Outcome, Pair, made
from meshonet_cli.batch.provenance import provenance
from meshonet_cli.batch.run import Batch, BatchTask
from meshonet_cli.report.grid import Report

if TYPE_CHECKING:
    from meshonet.solvers.progress import HistoryRow
    from meshonet_cli.terminal.session import Session

SHARED = 16  # members that one of several processes gets at a time at the most, when they are solved together


def _grids(
    members: Iterable[Item[Shape]], request: GridRequest, criteria: Criteria, detailed: bool
) -> Iterator[Pair]:
    """Yield each member with its grid and report, or the error that it ended in."""
    for member, result in make_grids_of(((member, member.what) for member in members), request):
        outcome: Outcome
        try:
            outcome = reported(member, made(result), criteria, detailed=detailed)
        except Exception as error:
            outcome = error
        yield member, outcome


def reported(
    member: Item[Any], result: Result, criteria: Criteria, *, detailed: bool = True
) -> tuple[Grid, Report]:
    """Return the grid of `member` with the command in its provenance, and the report, judged by `criteria`.

    A `detailed` one has angles and lines of grids of blocks, which only programs are told.

    Raises InputError: a gate names a figure that these cells do not have.
    """
    solution, grid = result.solution, result.grid
    counts = grid.blocks[0].counts if len(grid.blocks) == 1 else (None, None)
    report = Report(
        member, method=solution.method, ni=counts[0], nj=counts[1], topology=grid.topology,
        wake=grid.wake, quality=result.quality, model=solution.model, path=solution.path,
        residual=solution.residual, cycles=solution.cycles, notes=result.notes, history=result.history,
    )  # fmt: skip
    report.seconds |= result.seconds
    if grid.topology == "blocks":
        from meshonet.geometry.quality.blocks import block_counts, block_figures

        with report.timed("quality"):
            report.blocks = block_figures(grid, result.quality) if detailed else block_counts(grid)
    if criteria:
        with report.timed("quality"):
            report.judgement = criteria.judge(grid, result.quality)
    return grid.with_provenance(**provenance()), report


def write_grids(
    batch: Batch, request: GridRequest, criteria: Criteria, *, history: str | None = None,
    assemble: bool = False,
) -> int:  # fmt: skip
    """Turn every boundary of the inputs into a grid and return the exit code.

    With `assemble` they are one domain. Grids that do not meet `criteria` end the program with 1; the cycles
    go to the file `history`.
    """
    request = replace(request, threads=batch.engine.threads(request.threads))
    session, sampling = batch.session, request.sampling
    nodes = (sampling.ni or DEFAULT_NI) * (sampling.nj or DEFAULT_NJ)
    task = BatchTask(
        partial(read_shapes, fmt=batch.files.from_format),
        partial(_grids, request=request, criteria=criteria, detailed=session.as_json),
        nodes=None if request.asks_for_blocks else nodes,
        together=_together(request), assembled=sampling if assemble else None,
    )  # fmt: skip
    if history:
        from meshonet_cli.report.cycles import check_file

        check_file(history)
    cycles: list[tuple[str, Iterable[HistoryRow]]] = []

    def written(report: Report, path: str) -> None:
        if history:
            cycles.append((report.item.label, report.history))
        session.written(report, path)

    with _shown_live(session) if session.live else contextlib.nullcontext():
        batch.deliver(task, written)
    if history and cycles:
        from meshonet_cli.report.cycles import write

        with whole_file(history) as file:
            write(file, cycles)
    return session.finish()


def _shown_live(session: Session) -> contextlib.AbstractContextManager[None]:
    from meshonet.solvers.progress import listening
    from meshonet_cli.report.cycles import Live

    return listening(Live(session.status))


def _together(request: GridRequest) -> int:
    """Return how many members one of several processes gets at a time: fewer when grids are large."""
    if method_of(request).together is None:
        return 1
    nodes = (request.sampling.ni or 1) * (request.sampling.nj or 1)
    return max(1, min(SHARED, MOST_NODES // nodes))


def initial_grid(text: str | None) -> Grid | None:
    """Return the grid of the file `text`, or None for None."""
    return None if text is None else next(read_grids(text))
