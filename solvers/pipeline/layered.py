"""Prescribed first-cell heights: by marching from bodies, otherwise by moving nodes along grid lines."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from operator import itemgetter
from time import perf_counter
from typing import TYPE_CHECKING, Any

from meshonet.geometry.arrays import Topology
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError, SolverError
from meshonet.solvers.hyperbolic.default_spacing import is_abrupt, too_tall
from meshonet.solvers.hyperbolic.march import check_layers
from meshonet.solvers.layers.first_cells import Heights
from meshonet.solvers.pipeline.fallback import guard
from meshonet.solvers.pipeline.first_cells import heights_of, y_plus_notes
from meshonet.solvers.pipeline.named import Each, Wrapper, method_named, solved
from meshonet.solvers.pipeline.uses import CHANNEL, MARCHED, refuse
from meshonet.solvers.solution import Solution

if TYPE_CHECKING:
    from meshonet.solvers.pipeline.methods import Method
    from meshonet.solvers.pipeline.request import OneBlock

UPRIGHT_DEGREES = 0.3  # by which lines may lean at walls whose nodes have slid
LEANING_DEGREES = 1.0  # by which they may lean when sources have turned them
OBLIQUE_DEGREES = 20.0  # beyond which layers that lean are worth a note


@dataclass(frozen=True)
class Layered(Wrapper):
    """Solves by `method`, then redistributes nodes so that first cells have the prescribed heights."""

    request: OneBlock  # its heights and layers; options that are of no use are refused
    # settings of ``steger-sorenson``, whose sources turn lines at walls
    turning: Mapping[str, Any] = field(default_factory=dict)
    full: Method | None = None  # `method` as it solves on all nodes; None when it is not to
    # topologies that are marched from the wall when there is a height off walls
    marched: tuple[Topology, ...] = ()
    # make lines leave the walls of four-sided domains at right angles when there is such a height
    channels: bool = False

    def solve_one(self, boundary: Boundary, start: Grid | None = None) -> Solution:
        """Return the solution of a boundary with the prescribed first-cell heights.

        Raises InputError if heights or settings do not suit the boundary or the method.
        """
        if boundary.around_body and self.request.sides:
            raise InputError(
                f"a height off a single side, around a body (topology {boundary.topology})",
                "use {first_cell}",
                parameter=f"spacing_{next(iter(self.request.sides))}",
            )
        heights = heights_of(self.request, boundary)
        if self.request.at_walls and boundary.topology in self.marched:
            refuse(self.request.chosen, MARCHED)
            solution = self._marched(boundary, heights.south)
            if solution is not None:
                return solution
            check_layers(self.request.height() or 0.0, self.request.growth)
        elif heights.any and self.request.refine:
            raise InputError("{refine} with first cells of given heights", "use a finer {res} instead")
        if not heights.any and not self.request.slide:
            return self._even(boundary, heights, start)
        return self._in_layers(boundary, heights, start)

    def _marched(self, boundary: Boundary, height: float) -> Solution | None:
        """Return the marched grid; None if marched lines do not suit first cells of this `height`."""
        if self.request.method == "hyperbolic":
            return self._march(boundary)
        if too_tall(boundary, height):
            return None
        solution = self._march(boundary)
        abrupt = is_abrupt(boundary, height, self.request.growth, solution.grid.nodes)
        return None if abrupt else solution

    def _march(self, boundary: Boundary) -> Solution:
        height, of_heights = self.request.height() or 0.0, y_plus_notes(self.request, boundary)
        march = method_named("hyperbolic", wall_spacing=height, **self.request.rows_at_walls)
        solution = march.solve([boundary])[0]
        return replace(solution, notes=(*of_heights, *solution.notes))

    def _in_layers(self, boundary: Boundary, heights: Heights, start: Grid | None) -> Solution:
        """Return the grid of `boundary` with layers; its time includes all stages."""
        from meshonet.solvers.elliptic import steger_sorenson  # noqa: F401 - loaded before the clock starts
        from meshonet.solvers.layers import slide_nodes  # noqa: F401
        from meshonet.solvers.layers.redistribute import check_columns, spread

        begun = perf_counter()
        check_columns(boundary, heights)
        solution = self._even(boundary, heights, start)
        if heights.any:
            edges = solution.boundary or boundary
            slid = solution.boundary is not None
            if solution.method == "hyperbolic":  # its notes are on first cells that the result does not have
                solution = replace(solution, notes=())
            solution = spread(guard(solution, edges, allow_invalid=True), edges, heights)
            solution = solution if slid else _noted_lean(solution, boundary, heights)
        seconds = {**solution.seconds, "grid": perf_counter() - begun}
        notes = (*y_plus_notes(self.request, boundary), *solution.notes)
        return replace(solution, notes=notes, seconds=seconds)

    def _even(self, boundary: Boundary, heights: Heights, start: Grid | None) -> Solution:
        """Return the grid of `boundary` without layers; wall nodes may slide or grid lines be turned."""
        channel = self.channels and not boundary.around_body and bool(heights.south or heights.north)
        slide = channel and boundary.sampled if self.request.slide is None else self.request.slide
        if slide:
            solution = self._slid(boundary, start)
            if channel and "model" not in self.request.chosen:
                return self._upright(solution, boundary, heights, start)
            return solution
        if channel:
            refuse((each for each in ("model", "polish", "answer") if each in self.request.chosen), CHANNEL)
        if self.full is not None and (channel or self.name == "steger-sorenson"):
            return self._turned(boundary, heights, start)
        return self.inner(boundary, start)

    def _slid(self, boundary: Boundary, start: Grid | None) -> Solution:
        from meshonet.solvers.layers.slide_nodes import slide_walls

        slid, controls = slide_walls(boundary)
        if self.name == "best":  # lines of an elliptic grid leave slid walls at right angles, others do not
            try:
                solution = solved(method_named("winslow", controls=controls), slid, start)
            except SolverError:
                solution = solved(self.method, slid, start)
        else:
            method = self.method
            if controls is not None and isinstance(self.full, Each) and self.full.takes("controls"):
                method = replace(self.full, settings={**self.full.settings, "controls": controls})
            solution = solved(method, slid, start)
        note = "wall nodes slid along south and north"
        return replace(solution, boundary=slid, notes=(*solution.notes, note))

    def _upright(
        self, solution: Solution, boundary: Boundary, heights: Heights, start: Grid | None
    ) -> Solution:
        """Return `solution` with wall nodes slid, or with lines turned by sources, whichever is better."""
        from meshonet.solvers.elliptic.steger_sorenson import largest_lean

        slid, walls = solution.boundary, replace(heights, west=0.0, east=0.0)
        if slid is None:
            return solution
        leans = [(largest_lean(solution.grid.nodes, slid), solution)]
        if leans[0][0] < UPRIGHT_DEGREES:
            return solution
        turned = self._turned(slid, walls, start)
        turned = replace(turned, boundary=slid, notes=(*solution.notes, *turned.notes))
        leans.append((largest_lean(turned.grid.nodes, slid), turned))
        if leans[1][0] >= LEANING_DEGREES:
            kept = self._turned(boundary, walls, start)
            leans.append((largest_lean(kept.grid.nodes, boundary), kept))
        return min(leans, key=itemgetter(0))[1]

    def _turned(self, boundary: Boundary, heights: Heights, start: Grid | None) -> Solution:
        return solved(
            method_named("steger-sorenson", **self.turning, heights=heights.by_side), boundary, start
        )


def _noted_lean(solution: Solution, boundary: Boundary, heights: Heights) -> Solution:
    """Return a solution whose wall nodes did not slide, with a note if lines lean much in its layers."""
    from meshonet.solvers.elliptic.steger_sorenson import largest_lean

    if (
        boundary.topology != "quad"
        or not (heights.south or heights.north)
        or min(solution.grid.nodes.shape[:2]) < 3
    ):
        return solution
    lean = largest_lean(solution.grid.nodes, boundary)
    if lean <= OBLIQUE_DEGREES:
        return solution
    note = (
        f"grid lines leave south or north up to {lean:.0f} degrees off the right angle; elliptic methods "
        "with {slide} move the wall nodes to where there is none"
    )
    return replace(solution, notes=(note, *solution.notes))
