"""What `tfi`, `solve-pde` and `infer` share: one request, many boundaries, a report of each grid."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from meshonet.formats.inputs import Inputs
from meshonet.formats.output import whole_file
from meshonet.formats.registry import read_grids
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import MeshonetError
from meshonet.geometry.quality.criteria import Criteria
from meshonet.geometry.shapes.shape import Shape
from meshonet.geometry.spacing.sampling import DEFAULT_NI, DEFAULT_NJ
from meshonet.solvers.pipeline.choose_method import method_of
from meshonet.solvers.pipeline.make_grid import MOST_NODES, make_grids
from meshonet.solvers.pipeline.request import GridRequest
from meshonet.solvers.pipeline.result import Result
from meshonet.solvers.progress import Row as Cycle
from meshonet.solvers.progress import listening
from meshonet_cli.batch.destination import Destination
from meshonet_cli.batch.executors.engine import HERE, Engine
from meshonet_cli.batch.item import Item
from meshonet_cli.batch.run import deliver, prepare
from meshonet_cli.batch.sources import shape_items
from meshonet_cli.convergence import Live, check_file, write
from meshonet_cli.provenance import provenance
from meshonet_cli.report.grid import Report
from meshonet_cli.session import Session
from meshonet_cli.summary import Row, figures

if TYPE_CHECKING:
    from meshonet_cli.options import (
        CheckOptions,
        FileOptions,
        LayerOptions,
        SamplingOptions,
        SideOptions,
        VolumeOptions,
    )

SHARED = 16  # members that one of several processes gets at a time at the most, when they are solved together


@dataclass(frozen=True)
class GridMaker:
    """Makes grids, and reports of them, of the members of a batch."""

    request: GridRequest
    criteria: Criteria
    detailed: bool = True

    def __call__(self, members: Iterable[Item[Shape]]) -> Iterator[tuple[Grid, Report] | Exception]:
        """Yield grid and report of each member, or the error that it ended in."""
        taken: list[Item[Shape]] = []

        def shapes() -> Iterator[Shape]:
            for member in members:
                taken.append(member)
                yield member.what

        for result in make_grids(shapes(), self.request):
            member = taken.pop(0)
            yield result if isinstance(result, Exception) else self._reported(member, result)

    def _reported(self, member: Item[Shape], result: Result) -> tuple[Grid, Report] | Exception:
        try:
            return reported(member, result, self.criteria, detailed=self.detailed)
        except MeshonetError as error:
            return error


def reported(
    member: Item[Shape], result: Result, criteria: Criteria, *, detailed: bool = True
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


def request_of(
    method: str, sampling: SamplingOptions, checks: CheckOptions, criteria: Criteria,
    *blocks: LayerOptions | SideOptions | VolumeOptions,
    settings: Mapping[str, Any], **parameters: Any,
) -> GridRequest:  # fmt: skip
    """Return the request that options describe, `parameters` by the names of its fields.

    The quality is measured as far as `criteria` need. Raises InputError: as `GridRequest`.
    """
    for block in blocks:
        parameters |= vars(block)
    return GridRequest(
        sampling.settings(), method, {name: value for name, value in settings.items() if value is not None},
        repair=checks.repair, allow_invalid=checks.allow_invalid,
        percentiles=criteria.percentiles, **parameters,
    )  # fmt: skip


def write_grids(
    inputs: Inputs, output: str, request: GridRequest, criteria: Criteria, files: FileOptions,
    session: Session, *, history: str | None = None, assemble: bool = False, engine: Engine = HERE,
) -> int:  # fmt: skip
    """Turn every boundary of `inputs` into a grid in `output` and return the exit code.

    With `assemble` they are one domain. Grids that do not meet `criteria` end the program with 1; the cycles
    go to the file `history`.
    """
    request = replace(request, threads=engine.threads(request.threads))
    nodes = (request.sampling.ni or DEFAULT_NI) * (request.sampling.nj or DEFAULT_NJ)
    destination = Destination(
        output,
        files.to_format,
        "grids",
        part_size=files.part_size,
        nodes=None if request.asks_for_blocks else nodes,
    )
    members = shape_items(inputs, files.from_format, session, request.sampling if assemble else None)
    prepare(members, destination, session)
    check_file(history)
    cycles: list[tuple[str, Iterable[Cycle]]] = []
    judge = judging(session)

    def written(report: Report, path: str) -> None:
        cycles.append((report.item.label, report.history))
        judge(report, path)

    with listening(Live(session.status)) if session.live else contextlib.nullcontext():
        deliver(
            members, GridMaker(request, criteria, session.as_json), destination, session, written,
            skip_existing=files.skip_existing, together=_together(request), engine=engine,
        )  # fmt: skip
    if history and cycles:
        with whole_file(history) as file:
            write(file, cycles)
    return session.finish()


def judging(session: Session) -> Callable[[Report, str], None]:
    """Return what reports a grid written to a file, warns of folded cells and tells how it was judged."""

    def written(report: Report, path: str) -> None:
        report.finished(path)
        label, folded = report.item.label, report.quality.folded
        if folded:
            session.warn(f"{label}: {folded} folded cells are in {path}")
        session.report(report, report.judgement.problems if report.judgement else ())
        if report.judgement:
            session.judge(Row(label, figures(report.quality), report.judgement))

    return written


def _together(request: GridRequest) -> int:
    """Return how many members one of several processes gets at a time: fewer when grids are large."""
    if method_of(request).together is None:
        return 1
    nodes = (request.sampling.ni or 1) * (request.sampling.nj or 1)
    return max(1, min(SHARED, MOST_NODES // nodes))


def initial_grid(text: str | None) -> Grid | None:
    """Return the grid of the file `text`, or None for None."""
    return None if text is None else next(read_grids(text))
