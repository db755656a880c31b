"""The options for first cells off single edges, and the way from all of them to a grid."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from meshonet.geometry.blocks.boundary import Boundary
    from meshonet.geometry.errors import InputError
    from meshonet.solvers.layers.first_cells import Heights
    from meshonet.solvers.solution import Solution
    from meshonet_cli.layers import Layers
    from meshonet_cli.options import LayerOptions, SideOptions

SIDES = ("south", "north", "west", "east")
UPRIGHT = 0.3
"""Degrees by which lines may lean at walls whose nodes have slid."""
LEANING = 1.0
"""Degrees by which they may lean when sources have turned them."""
Method: TypeAlias = "Callable[..., Solution]"


@dataclass(frozen=True)
class Edges:
    """What was asked off single edges of four-sided domains, and of layers everywhere.

    Parameters
    ----------
    heights : by side, in the unit of the domain.
    constant : equal first layers.
    growth, free_rows : as in `meshonet_cli.layers.Layers`.
    slide : whether wall nodes of four-sided domains move; None: when there are layers and no given nodes.
    angle : of lines at walls in degrees.
    """

    heights: Mapping[str, float]
    constant: int = 1
    growth: float | None = None
    free_rows: bool = False
    slide: bool | None = None
    angle: float | None = None


def read_edges(
    sides: SideOptions | None,
    first: LayerOptions,
    res: str | None,
    layers: Layers | None,
    slide: bool | None = None,
    angle: float | None = None,
) -> Edges:
    """Return what the options ask for, off single `sides` where the command has them.

    Raises
    ------
    InputError
        a height that is not positive; constant layers or growth without any height.
    """
    from meshonet.geometry.errors import InputError

    asked = {} if sides is None else {side: getattr(sides, f"spacing_{side}") for side in SIDES}
    heights = {side: height for side, height in asked.items() if height is not None}
    constant, growth = first.constant_layers, first.growth
    for side, height in heights.items():
        if not 0 < height < float("inf"):
            raise InputError(
                f"a first cell of {height:g}", "give a positive height", source=f"--spacing-{side}"
            )
    if not heights and layers is None:
        others = ", --y-plus or --spacing-south" if asked else " or --y-plus"
        for option, value in (("--constant-layers", constant), ("--growth", growth)):
            if value is not None:
                raise InputError(f"{option} without a first cell", f"give --wall-spacing{others} as well")
    return Edges(heights, constant or 1, growth, growth is not None and res is None, slide, angle)


@dataclass(frozen=True)
class WithWalls:
    """A method, and what becomes of its grids at the walls.

    Parameters
    ----------
    name : of the method as it was asked for.
    method : the solver.
    layers : asked for at walls.
    edges : asked for off single edges.
    unused : values by option, not None when given, of no use to a march.
    """

    name: str
    method: Method
    layers: Layers | None
    edges: Edges
    unused: Mapping[str, object] = field(default_factory=dict)

    def __post_init__(self) -> None:
        from meshonet.geometry.errors import InputError

        if self.name == "hyperbolic" and self.layers is None:
            problem = "--method hyperbolic without a first cell"
            raise InputError(problem, "give --wall-spacing or --y-plus as well")
        if self.edges.angle is not None and self.name != "steger-sorenson":
            problem = f"method {self.name} sets no angle"
            raise InputError(problem, "use --method steger-sorenson", source="--wall-angle")

    def __call__(self, boundary: Boundary) -> Solution:
        """Return the grid of `boundary`, its first cells as high as asked.

        Raises
        ------
        InputError
            what was asked does not fit the boundary or the method.
        """
        from meshonet.geometry.errors import InputError

        if boundary.topology != "quad":
            if self.edges.heights:
                raise InputError(
                    f"a height off a single side, around a body (topology {boundary.topology})",
                    "use --wall-spacing",
                    source=f"--spacing-{next(iter(self.edges.heights))}",
                )
            if self.layers is not None and self.name == "auto":
                return self._marched(boundary, self.layers)
        if self.layers is not None and self.name == "hyperbolic":
            return self._marched(boundary, self.layers)
        heights = self.heights(boundary)
        if heights.any and self.unused.get("--refine") is not None:
            raise InputError("--refine with first cells of given heights", "use a finer --res instead")
        if not heights.any and not self.edges.slide:
            return self._solved(boundary, heights)
        return self._walled(boundary, heights)

    def _walled(self, boundary: Boundary, heights: Heights) -> Solution:
        """Return the grid of `boundary` with layers; all that takes is told as the grid's time."""
        from time import perf_counter

        from meshonet.solvers.elliptic import steger_sorenson  # noqa: F401  (loaded before the clock starts)
        from meshonet.solvers.layers import slide_nodes  # noqa: F401
        from meshonet.solvers.layers.redistribute import spread

        begun = perf_counter()
        solution = self._solved(boundary, heights)
        if heights.any:
            solution = spread(solution, solution.boundary or boundary, heights)
        spent = {**solution.seconds, "grid": perf_counter() - begun}
        note = (self.layers.note,) if self.layers and self.layers.note else ()
        return replace(solution, notes=(*note, *solution.notes), seconds=spent)

    def _solved(self, boundary: Boundary, heights: Heights) -> Solution:
        """Return the grid of `boundary` with even rows: wall nodes slid, or lines turned, as they are to be.

        Channels with layers by ``auto``: nodes that were sampled here slide; given ones stay, and sources
        turn the lines.
        """
        channel = boundary.topology == "quad" and self.name == "auto" and self.layers is not None
        slide = self.edges.slide
        if slide is None:
            slide = channel and boundary.sampled
        if slide:
            solution = self._slid(boundary)
            chosen = self.unused.get("--model") is not None
            return self._upright(solution, boundary, heights) if channel and not chosen else solution
        if channel:
            self._refuse(("--model", "--polish", "--answer"), "a channel with given wall nodes")
        fewer = getattr(self._whole_function(), "__module__", "") in (
            "meshonet.solvers.pipeline.coarse",
            "meshonet.solvers.pipeline.sequence",
        )
        if (channel or self.name == "steger-sorenson") and not fewer:
            return self._turned(boundary, heights)
        return self.method(boundary)

    def _whole(self) -> Method:
        """Return the method, solving on all nodes whatever their number."""
        from functools import partial

        from meshonet.solvers.pipeline.select import solve_automatic

        automatic = isinstance(self.method, partial) and self.method.func is solve_automatic
        return self.method.keywords["method"] if automatic else self.method  # type: ignore[attr-defined]

    def _whole_function(self) -> object:
        return getattr(self._whole(), "func", None)

    def _slid(self, boundary: Boundary) -> Solution:
        from meshonet.solvers.layers.slide_nodes import slide_walls

        slid, controls = slide_walls(boundary)
        told = "wall nodes slid along south and north"
        if controls is not None and self._whole_function() is solve_function():
            solution = self._whole()(slid, controls=controls)
        else:
            solution = self.method(slid)
        return replace(solution, boundary=slid, notes=(*solution.notes, told))

    def _upright(self, solution: Solution, boundary: Boundary, heights: Heights) -> Solution:
        """Return `solution`, its wall nodes slid; where lines still lean, sources turn them.

        Where that does not do, sources with the nodes of `boundary` as they were, if those do better.
        """
        from meshonet.solvers.elliptic.steger_sorenson import largest_lean

        slid = solution.boundary
        if slid is None or largest_lean(solution.grid.nodes, slid) < UPRIGHT:
            return solution
        turned = self._turned(slid, heights)
        turned = replace(turned, boundary=slid, notes=(*solution.notes, *turned.notes))
        lean = largest_lean(turned.grid.nodes, slid)
        if lean < LEANING:
            return turned
        kept = self._turned(boundary, heights)
        return kept if largest_lean(kept.grid.nodes, boundary) < lean else turned

    def _turned(self, boundary: Boundary, heights: Heights) -> Solution:
        from meshonet.solvers.elliptic.steger_sorenson import solve_steger_sorenson

        sides = {side: height for side in SIDES if (height := getattr(heights, side))}
        angle = 90.0 if self.edges.angle is None else self.edges.angle
        own = self._whole_function() in (solve_function(), solve_steger_sorenson)
        settings = self._whole().keywords if own else {}  # type: ignore[attr-defined]
        return solve_steger_sorenson(boundary, **settings, heights=sides, angle=angle)

    def heights(self, boundary: Boundary) -> Heights:
        """Return the heights in the unit of `boundary`.

        A wall spacing is in chords around a body and off south and north, in its own unit, in a four-sided
        domain. A y+ gives chords; the chord of a four-sided domain is the extent of its south side.
        """
        from meshonet.solvers.layers.first_cells import Heights

        found: dict[str, float] = {}
        if self.layers is not None:
            chords = boundary.topology != "quad" or self.layers.note
            height = self.layers.wall_spacing * (boundary.chord if chords else 1.0)
            walls = ("south", "north") if boundary.topology == "quad" else ("south",)
            found = dict.fromkeys(walls, height)
        edges = self.edges
        return Heights(
            **found | dict(edges.heights),
            constant=edges.constant,
            growth=edges.growth,
            free_rows=edges.free_rows,
        )

    def _marched(self, boundary: Boundary, layers: Layers) -> Solution:
        from meshonet_cli.layers import march

        what = "a grid marched from the wall"
        self._refuse(self.unused, what)
        if self.edges.slide:
            raise _useless("--slide", what)
        return march(boundary, layers, self.edges.constant)

    def _refuse(self, options: Iterable[str], what: str) -> None:
        """Raise InputError when one of `options` was given, which are of no use to `what`."""
        for option in options:
            if self.unused.get(option) is not None:
                raise _useless(option, what)


def _useless(option: str, what: str) -> InputError:
    from meshonet.geometry.errors import InputError

    return InputError(f"{option} is of no use to {what}", f"drop {option}")


def solve_function() -> Callable[..., Solution]:
    """Return the elliptic solver without sources."""
    from meshonet.solvers.elliptic.solve import solve

    return solve
