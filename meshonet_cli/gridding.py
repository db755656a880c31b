"""What `tfi`, `solve-pde` and `infer` have in common: boundaries in, checked grids out, each told about."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING

from meshonet.formats.output import whole_file
from meshonet.formats.registry import read_grids, read_shapes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import NoValidGridError
from meshonet.geometry.quality.measure import count_folded, measure, worst_cells
from meshonet.geometry.shapes.shape import Shape, edges_of
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.pipeline.fallback import guard
from meshonet.solvers.progress import listening
from meshonet.solvers.solution import Solution
from meshonet_cli.batch import Destination, items
from meshonet_cli.delivery import deliver, prepare
from meshonet_cli.gates import Gate, need_percentiles
from meshonet_cli.member import Item
from meshonet_cli.provenance import provenance
from meshonet_cli.report import Report
from meshonet_cli.session import Session
from meshonet_cli.together import Sampled, Together, shared
from meshonet_cli.watching import Live, Recorder, Row, check_file, write

if TYPE_CHECKING:
    from meshonet.solvers.algebraic.tfi import Blending


@dataclass(frozen=True)
class Recipe:
    """How a boundary becomes a grid.

    Parameters
    ----------
    sampling : node counts and spacing of the boundary.
    method : the solver.
    allow_invalid : whether a folded grid is a result.
    gates : conditions that end the program with 1.
    repair : whether a folded grid goes to the guard, which unfolds it or makes another.
    margin : cells around folded ones that the guard moves with them; None for its own.
    refine : how often the cells that `sampling` asks for are halved.
    history : file that the cycles go to.
    together : the part of `method` that solves many boundaries in one go, when it has one.
    """

    sampling: Sampling
    method: Callable[[Boundary], Solution]
    allow_invalid: bool = False
    gates: tuple[Gate, ...] = ()
    repair: bool = True
    margin: int | None = None
    refine: int = 0
    history: str | None = None
    facts: dict[str, object] = field(default_factory=dict)
    together: Together | None = None

    def grid(self, item: Item[Shape]) -> tuple[Grid, Report]:
        """Return the grid of one shape and what there is to tell of it.

        Raises
        ------
        NoValidGridError
            cells are folded, and that was not allowed.
        """
        clock = Clock()
        if isinstance(item.what, Sampled):  # and looked through
            boundary = item.what.boundary(self.sampling)
        else:
            boundary = edges_of(item.what, self.sampling)
        if self.refine:
            boundary = edges_of(item.what, finer(self.sampling, item.what, boundary, 2**self.refine))
        clock.lap("boundary")
        recorder = Recorder()
        with listening(recorder) if self.history else contextlib.nullcontext():
            solution = self.method(boundary)
        # what a method takes beside its grid are modules and models, loaded once a process
        inside = {stage: solution.seconds[stage] for stage in ("grid", "guard") if stage in solution.seconds}
        clock.lap("load" if "grid" in inside else "grid", inside=inside)
        grid, path = self._guarded(solution, boundary)
        told = self._first_cells(grid) if path else ()
        clock.lap("guard")
        quality = measure(grid, percentiles=need_percentiles(self.gates))
        clock.lap("quality")
        report = Report(
            item,
            method=solution.method,
            ni=grid.ni,
            nj=grid.nj,
            topology=grid.topology,
            quality=quality,
            model=solution.model,
            path=(*solution.path, *path),
            residual=solution.residual,
            cycles=solution.cycles,
            notes=(*boundary.notes, *solution.notes, *told),
        )
        report.seconds |= clock.seconds
        report.history = recorder.of(solution) if self.history else ()
        grid = replace(grid, origin=boundary.origin)
        return grid.with_provenance(**provenance(), **self.facts), report

    @staticmethod
    def _first_cells(grid: Grid) -> tuple[str, ...]:
        """Return what there is to tell of first cells that the guard changed."""
        if not any(key == "wall_spacing" or key.startswith("spacing_") for key in grid.provenance):
            return ()
        from meshonet.solvers.layers.redistribute import worst_first_cell

        error = worst_first_cell(grid)
        if error < 1e-8:
            return ()
        return (f"the guard changed first cells: they miss what was asked by up to {error:.1g} of it",)

    def _guarded(self, solution: Solution, boundary: Boundary) -> tuple[Grid, tuple[str, ...]]:
        grid = solution.grid
        if self.repair:
            return guard(
                grid, solution.boundary or boundary, allow_invalid=self.allow_invalid, margin=self.margin
            )
        folded = count_folded(grid.nodes)
        if folded and not self.allow_invalid:
            cells = (grid.ni - 1) * (grid.nj - 1)
            remedy = "use --repair (infer: --answer valid), solve-pde or --allow-invalid"
            problem = f"{folded} of {cells} cells are folded; {remedy}"
            raise NoValidGridError(problem, worst_cells(grid.nodes))
        return grid, ()


def make_grids(
    sources: Sequence[str], recipe: Recipe, destination: Destination, session: Session, *,
    fmt: str | None = None, skip_existing: bool = False, jobs: int = 1,
) -> int:  # fmt: skip
    """Turn every boundary of `sources` into a grid in `destination` and return the exit code.

    Parameters
    ----------
    fmt : format of the sources, or None to go by endings and content.
    skip_existing : pass over members whose own file is there.
    jobs : processes at work.

    Raises
    ------
    InputError
        several members and room for one.
    """
    prepare(sources, destination, session)
    check_file(recipe.history)
    found = items(sources, lambda source: read_shapes(source, fmt), session)
    together = recipe.together
    ahead = partial(together.ahead, sampling=recipe.sampling) if together is not None else None
    members: list[tuple[str, Iterable[Row]]] = []

    def tell(report: Report, path: str) -> None:
        members.append((report.item.label, report.history))
        _tell(recipe, session, report, path)

    with listening(Live(session.status)) if session.live else contextlib.nullcontext():
        deliver(
            found, recipe.grid, destination, session, tell,
            skip_existing=skip_existing, ahead=ahead, together=shared(recipe.sampling), jobs=jobs,
        )  # fmt: skip
    if recipe.history and members:
        with whole_file(recipe.history) as file:
            write(file, members)
    return session.finish()


def _tell(recipe: Recipe, session: Session, report: Report, path: str) -> None:
    report.finished(path)
    if report.quality.folded:
        session.warn(f"{report.item.label}: {report.quality.folded} folded cells are in {path}")
    session.tell(report)
    session.gate(report.item.label, [told for gate in recipe.gates if (told := gate.broken(report.quality))])


def finer(sampling: Sampling, shape: Shape, boundary: Boundary, k: int) -> Sampling:
    """Return `sampling` with `k` times the cells of the `boundary` of `shape`, those along a wake included.

    Edges that were given share their nodes out as they are.
    """
    wakes = [part.stop - part.start for part in boundary.patches if part.name == "wake"]
    made = boundary.topology == "c" and wakes and not isinstance(shape, Boundary)
    nodes = k * wakes[0] + 1 if made else sampling.wake_nodes
    return replace(sampling, ni=k * (boundary.ni - 1) + 1, nj=k * (boundary.nj - 1) + 1, wake_nodes=nodes)


class Clock:
    """Wall-clock seconds by stage."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._last = time.perf_counter()

    def lap(self, stage: str, inside: dict[str, float] | None = None) -> None:
        """Add the time since the last lap to `stage`, less what stages `inside` it took."""
        now = time.perf_counter()
        spent = now - self._last
        for name, part in (inside or {}).items():
            self.seconds[name] = self.seconds.get(name, 0.0) + part
            spent -= part
        # a grid made earlier, together with others, takes longer than the lap
        self.seconds[stage] = self.seconds.get(stage, 0.0) + max(spent, 0.0)
        self._last = now


def interpolated(edges: Boundary, blending: Blending) -> Solution:
    """Return the transfinite interpolation of `edges` as a solution."""
    from meshonet.solvers.algebraic.tfi import tfi

    begun = time.perf_counter()
    grid = tfi(edges, blending)
    return Solution(grid, "tfi", seconds={"grid": time.perf_counter() - begun})


def initial_grid(text: str | None) -> Grid | None:
    """Return the grid of the file `text`, or None for None."""
    return None if text is None else next(read_grids(text))
