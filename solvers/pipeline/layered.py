"""Prescribed first-cell heights: by marching from bodies, otherwise by moving nodes along grid lines.

::

    body ----------------------------------- march ------------------------------> grid
    channel, free wall nodes ---- slide wall nodes, solve ------+
    channel, given wall nodes --- turn lines by source terms ---+-- move nodes along lines --> grid
    other domains --------------- solve ------------------------+
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from time import perf_counter
from typing import TYPE_CHECKING, Any

from meshonet.geometry.arrays import Topology
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.solvers.layers.first_cells import Heights
from meshonet.solvers.pipeline.fallback import guard
from meshonet.solvers.pipeline.methods import Each, method_named, solved
from meshonet.solvers.pipeline.uses import CHANNEL, MARCHED, refuse
from meshonet.solvers.pipeline.wrapper import Wrapper
from meshonet.solvers.solution import Solution

if TYPE_CHECKING:
    from meshonet.solvers.pipeline.methods import Method

UPRIGHT_DEGREES = 0.3  # by which lines may lean at walls whose nodes have slid
LEANING_DEGREES = 1.0  # by which they may lean when sources have turned them
OBLIQUE_DEGREES = 20.0  # beyond which layers that lean are worth a note


@dataclass(frozen=True)
class FirstCells:
    """First-cell heights, and the layers that start with them."""

    # off walls, or None: around a body in chords, off south and north of a four-sided domain in its own unit
    height: float | None = None
    # heights off single sides of four-sided domains, in their unit
    sides: Mapping[str, float] = field(default_factory=dict)
    constant: int = 1  # so many first layers are equally high
    growth: float | None = None  # largest ratio of neighbouring cells, or None
    free_rows: bool = False  # whether growth decides how many rows there are
    multiple: int = 1  # of which the number of rows is one then
    # the height is in chords everywhere; that of a four-sided domain is the extent of its south
    in_chords: bool = False
    note: str = ""  # where the height comes from, when it was computed

    def heights(self, boundary: Boundary) -> Heights:
        """Return the heights in the unit of `boundary`."""
        walls: dict[str, float] = {}
        if self.height is not None:
            quad = not boundary.around_body
            height = self.height * (boundary.chord if self.in_chords or not quad else 1.0)
            walls = dict.fromkeys(("south", "north") if quad else ("south",), height)
        return Heights(
            **walls | dict(self.sides),
            constant=self.constant, growth=self.growth, free_rows=self.free_rows,
        )  # fmt: skip


@dataclass(frozen=True)
class Layered(Wrapper):
    """`method`, followed by a redistribution of nodes to the prescribed first-cell heights."""

    cells: FirstCells  # heights and layers
    # settings of ``steger-sorenson``, whose sources turn lines at walls
    turning: Mapping[str, Any] = field(default_factory=dict)
    full: Method | None = None  # `method` as it solves on all nodes; None when it is not to
    # topologies that are marched from the wall when there is a height off walls
    marched: tuple[Topology, ...] = ()
    # make lines leave the walls of four-sided domains at right angles when there is such a height
    channels: bool = False
    # move wall nodes of four-sided domains; None: in channels, when they were sampled here
    slide: bool | None = None
    # options that are not the defaults; they are refused where they are of no use
    chosen: tuple[str, ...] = ()

    def solve_one(self, boundary: Boundary, start: Grid | None = None) -> Solution:
        """Return the solution of a boundary with the prescribed first-cell heights.

        Raises InputError: heights or settings that do not suit the boundary or the method.
        """
        if boundary.around_body and self.cells.sides:
            raise InputError(
                f"a height off a single side, around a body (topology {boundary.topology})",
                "use {first_cell}",
                parameter=f"spacing_{next(iter(self.cells.sides))}",
            )
        if self.cells.height is not None and boundary.topology in self.marched:
            return self._march(boundary, self.cells.height)
        heights = self.cells.heights(boundary)
        if heights.any and "refine" in self.chosen:
            raise InputError("{refine} with first cells of given heights", "use a finer {res} instead")
        if not heights.any and not self.slide:
            return self._even(boundary, heights, start)
        return self._in_layers(boundary, heights, start)

    def _march(self, boundary: Boundary, height: float) -> Solution:
        refuse(self.chosen, MARCHED)
        cells = self.cells
        settings = {
            "growth": cells.growth,
            "free_rows": cells.free_rows,
            "constant": cells.constant,
            "multiple": cells.multiple,
        }
        solution = method_named("hyperbolic", wall_spacing=height, **settings).solve([boundary])[0]
        return replace(solution, notes=(cells.note, *solution.notes)) if cells.note else solution

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
            solution = spread(guard(solution, edges, allow_invalid=True), edges, heights)
            solution = solution if slid else _noted_lean(solution, boundary, heights)
        seconds = {**solution.seconds, "grid": perf_counter() - begun}
        note = (self.cells.note,) if self.cells.note else ()
        return replace(solution, notes=(*note, *solution.notes), seconds=seconds)

    def _even(self, boundary: Boundary, heights: Heights, start: Grid | None) -> Solution:
        """Return the grid of `boundary` without layers; wall nodes may slide or grid lines be turned."""
        channel = self.channels and not boundary.around_body and bool(heights.south or heights.north)
        slide = channel and boundary.sampled if self.slide is None else self.slide
        if slide:
            solution = self._slid(boundary, start)
            if channel and "model" not in self.chosen:
                return self._upright(solution, boundary, heights, start)
            return solution
        if channel:
            refuse((each for each in ("model", "polish", "answer") if each in self.chosen), CHANNEL)
        if self.full is not None and (channel or self.name == "steger-sorenson"):
            return self._turned(boundary, heights, start)
        return self.inner(boundary, start)

    def _slid(self, boundary: Boundary, start: Grid | None) -> Solution:
        from meshonet.solvers.layers.slide_nodes import slide_walls

        slid, controls = slide_walls(boundary)
        method = self.method
        if controls is not None and isinstance(self.full, Each) and self.full.takes("controls"):
            method = self.full.having(controls=controls)
        solution = solved(method, slid, start)
        note = "wall nodes slid along south and north"
        return replace(solution, boundary=slid, notes=(*solution.notes, note))

    def _upright(
        self, solution: Solution, boundary: Boundary, heights: Heights, start: Grid | None
    ) -> Solution:
        """Return `solution` with wall nodes slid, or with lines turned by sources, whichever is better."""
        from meshonet.solvers.elliptic.steger_sorenson import largest_lean

        slid = solution.boundary
        if slid is None or largest_lean(solution.grid.nodes, slid) < UPRIGHT_DEGREES:
            return solution
        turned = self._turned(slid, heights, start)
        turned = replace(turned, boundary=slid, notes=(*solution.notes, *turned.notes))
        lean = largest_lean(turned.grid.nodes, slid)
        if lean < LEANING_DEGREES:
            return turned
        kept = self._turned(boundary, heights, start)
        return kept if largest_lean(kept.grid.nodes, boundary) < lean else turned

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
