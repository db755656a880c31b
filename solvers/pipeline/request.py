"""What a user can ask of a grid, and the method that makes it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal

from meshonet.geometry.arrays import SIDES, TOPOLOGIES
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.geometry.spacing.y_plus import first_cell, height_note
from meshonet.solvers.method import METHODS, Method, method_named
from meshonet.solvers.pipeline.coarse import Coarse
from meshonet.solvers.pipeline.select import best, elliptic, fewer_on_quads
from meshonet.solvers.pipeline.sequence import Sequenced

if TYPE_CHECKING:
    from meshonet.geometry.layout.layout import Layout
    from meshonet.solvers.pipeline.layered import FirstCells

OF_VOLUMES = ("layers", "symmetry", "energy")
"""Parameters that only grids in space have a use for."""

OPERATOR_SETTINGS = ("model", "polish", "device")  # settings any of which asks for a network

OF_BLOCKS = ("cells", "cell_size", "walls", "pitch", "inlet", "outlet", "layout")
"""Parameters any of which asks for many blocks."""

DEFAULTS = {"coarse": "auto", "refine": 0, "polish": "auto", "answer": "valid", "blending": "arclength"}
"""Values that say nothing; of other parameters None is one."""


@dataclass(frozen=True)
class GridRequest:
    """How to make grids from shapes; the values are checked when it is made.

    Parameters
    ----------
    sampling : Sampling, optional
        Node counts and spacing of the boundary.
    method : str, optional
        A name in `METHODS`, or ``best``: what measures best for the topology, and marching around bodies with
        a first cell; or ``auto``: marching where ``best`` marches, Winslow's equations elsewhere.
    settings : dict, optional
        Keywords of the method.
    first_cell : float, optional
        Height of the first cell at every wall node, around a body in chords; in a four-sided domain the walls
        are south and north, and the unit is that of the domain.
    y_plus, reynolds : float, optional
        The same height by its y+, converted for a flat plate; the Reynolds number is based on the chord.
    chord_fraction : float, optional
        Where along the chord the y+ is converted to a height, 0 to 1.
    growth : float, optional
        Largest ratio of neighbouring cells away from the wall; without `nj` in the sampling there are as many
        rows as it needs.
    constant_layers : int, optional
        Number of first layers of equal height.
    spacing_south, spacing_north, spacing_west, spacing_east : float, optional
        Heights of first cells off single sides of a four-sided domain.
    slide : bool, optional
        Move the nodes of south and north along these walls; None: if a first cell is given and this request
        samples the nodes.
    wall_angle : float, optional
        Angle of grid lines at walls in degrees, for ``steger-sorenson``.
    coarse : int or 'auto', optional
        Nodes along each direction to solve on, before the grid is evaluated at its own node counts; ``auto``
        chooses by method and size, None solves on all nodes of the grid.
    refine : int, optional
        How many times, after the first solve, to halve all cells and solve again.
    initial : Grid, optional
        Grid to start from.
    repair : bool, optional
        Whether folded grids are repaired or made by another method; else they are refused. None: all are
        repaired but those of algebraic methods and of networks asked for raw answers.
    repair_margin : int, optional
        Cells around folded ones that move with them.
    allow_invalid : bool, optional
        Whether a folded grid is a result.
    percentiles : bool, optional
        Whether the quality includes percentiles.
    history : bool, optional
        Whether the cycles of the solve are kept.
    blocks : {'auto', 'single'}, optional
        ``single`` for one block also where many would be made.
    cells : int, optional
        About how many cells a grid of many blocks has. This and those down to `layout` ask for many blocks.
    cell_size : float, optional
        Length of edges, in place of `cells`.
    walls : tuple of str, optional
        Names of the walls that get layers; empty means all holes.
    pitch : tuple of 2 float, optional
        From one blade of a cascade to the next.
    inlet, outlet : float, optional
        Axial chords before and behind the blade of a cascade.
    layout : Layout, optional
        Blocks to use again.
    layers : int, optional
        Nodes along the lines of a volume marched from a surface, the wall's included.
    symmetry : {'x', 'y', 'z', 'none'}, optional
        Axis that the open edges of a surface lie across.
    energy : {'angles', 'shape'}, optional
        What is minimised inside six faces; None: angles.
    threads : int, optional
        Threads that kernels work with; None: all there are.

    Raises
    ------
    InputError
        A value out of its range; parameters that need or exclude each other.
    """

    sampling: Sampling = field(default_factory=Sampling)
    method: str = "best"
    settings: Mapping[str, Any] = field(default_factory=dict)
    first_cell: float | None = None
    y_plus: float | None = None
    reynolds: float | None = None
    chord_fraction: float = 0.5
    growth: float | None = None
    constant_layers: int | None = None
    spacing_south: float | None = None
    spacing_north: float | None = None
    spacing_west: float | None = None
    spacing_east: float | None = None
    slide: bool | None = None
    wall_angle: float | None = None
    coarse: int | Literal["auto"] | None = "auto"
    refine: int = 0
    initial: Grid | None = None
    repair: bool | None = None
    repair_margin: int | None = None
    allow_invalid: bool = False
    percentiles: bool = False
    history: bool = False
    blocks: Literal["auto", "single"] = "auto"
    cells: int | None = None
    cell_size: float | None = None
    walls: tuple[str, ...] = ()
    pitch: tuple[float, float] | None = None
    inlet: float | None = None
    outlet: float | None = None
    layout: Layout | None = None
    layers: int | None = None
    symmetry: Literal["x", "y", "z", "none"] | None = None
    energy: Literal["angles", "shape"] | None = None
    threads: int | None = None

    def __post_init__(self) -> None:
        if self.method not in ("best", "auto") and self.method.partition(":")[0] not in METHODS:
            method_named(self.method)  # which says what there is
        self._check_first_cells()
        if self.method == "hyperbolic" and not self.at_walls:
            raise InputError(
                "{method} hyperbolic without a first cell", "give {first_cell} or {y_plus} as well"
            )
        if self.wall_angle is not None and self.method != "steger-sorenson":
            problem = f"method {self.method} sets no angle"
            raise InputError(problem, "use {method} steger-sorenson", parameter="wall_angle")
        if isinstance(self.coarse, int):
            if self.refine:
                raise InputError("{coarse} and {refine} both solve on fewer nodes first", "give one of them")
            if self.initial is not None:
                problem = "a coarse solve has no use for a grid to start from"
                raise InputError(problem, "drop {initial} or {coarse}")
        if self.repair and self.settings.get("answer") == "raw":
            problem = "{repair} would change a raw answer"
            raise InputError(problem, "leave one of {repair} and {answer} out")
        tol = self.settings.get("tol")
        if tol is not None and not 0 < tol < 1:
            raise InputError(f"{tol:g} is not between 0 and 1", "use e.g. 1e-8", parameter="tol")
        for name, least in (("threads", 1), ("layers", 3)):
            value = getattr(self, name)
            if value is not None and value < least:
                raise InputError(f"{value} is too few", f"give {least} or more", parameter=name)
        if self.blocks not in ("auto", "single"):
            raise InputError(f"blocks {self.blocks!r} is not known", "use auto or single")
        if self.asks_for_blocks:
            from meshonet.solvers.pipeline.blocks import check_asked

            check_asked(self)

    @property
    def asks_for_blocks(self) -> tuple[str, ...]:
        """Names of the parameters that are given and that only many blocks have a use for."""
        return tuple(name for name in OF_BLOCKS if getattr(self, name) not in (None, ()))

    def _check_first_cells(self) -> None:
        if self.first_cell is not None and self.y_plus is not None:
            problem = "{first_cell} and {y_plus} both say how high the first cell is"
            raise InputError(problem, "give one of them")
        if (self.y_plus is None) != (self.reynolds is None):
            needed, known = ("reynolds", "y_plus") if self.reynolds is None else ("y_plus", "reynolds")
            raise InputError(f"{{{known}}} without {{{needed}}}", f"give {{{needed}}} as well")
        if self.y_plus is None and self.chord_fraction != 0.5:
            raise InputError("{chord_fraction} without {y_plus}", "give {y_plus} and {reynolds} as well")
        heights = {
            "first_cell": self.first_cell,
            **{f"spacing_{side}": h for side, h in self._sides().items()},
        }
        for name, height in heights.items():
            if height is not None and not 0 < height < math.inf:
                raise InputError(f"a first cell of {height:g}", "give a positive height", parameter=name)
        if not self.at_walls and not self._sides():
            for name, value in (("constant_layers", self.constant_layers), ("growth", self.growth)):
                if value is not None:
                    problem = f"{{{name}}} without a first cell"
                    raise InputError(problem, "give {first_cell} or {y_plus} as well")
        if self.constant_layers is not None and self.constant_layers < 1:
            raise InputError(f"{self.constant_layers} layers", "give at least 1", parameter="constant_layers")
        if self.at_walls and self.growth is not None and not 1 < self.growth <= 10:
            remedy = "give the ratio of neighbouring cells, such as 1.15"
            raise InputError(f"a growth of {self.growth:g}", remedy, parameter="growth")
        self._height()

    @property
    def at_walls(self) -> bool:
        """Whether there is a first cell off walls, not only off single sides."""
        return self.first_cell is not None or self.y_plus is not None

    def _sides(self) -> dict[str, float]:
        return {side: h for side in SIDES if (h := getattr(self, f"spacing_{side}")) is not None}

    def _height(self) -> float | None:
        if self.y_plus is None or self.reynolds is None:
            return self.first_cell
        return first_cell(self.y_plus, self.reynolds, self.chord_fraction)

    def first_cells(self) -> FirstCells:
        """Return the heights of first cells and the layers that begin with them."""
        from meshonet.solvers.pipeline.layered import FirstCells

        height = self._height()
        where = f"and x/c {self.chord_fraction:g}"
        note = height_note(self.y_plus, self.reynolds, where, f"{height or 0.0:.6g} chords")
        free_rows = self.growth is not None and self.sampling.nj is None
        layers = self.constant_layers or 1, self.growth, free_rows
        return FirstCells(height, self._sides(), *layers, in_chords=bool(note), note=note)

    def shape_sampling(self) -> Sampling:
        """Return the sampling of shapes: with thin first cells, wall nodes whose spacing changes slowly."""
        if not self.at_walls or self._algebraic:
            return self.sampling
        spacing = "curvature" if self.sampling.spacing == "auto" else self.sampling.spacing
        return replace(self.sampling, spacing=spacing, viscous=True)

    def repairs(self) -> bool:
        """Return whether folded grids are repaired."""
        if self.repair is not None:
            return self.repair
        return not self._algebraic and self.settings.get("answer", "valid") == "valid"

    def solver(self) -> Method:
        """Return the method that makes the grids, without the guard.

        Raises InputError: settings that the method does not have.
        """
        base = self._base()
        method = self._at_any_resolution(base)
        if not self.at_walls and not self._sides() and not self.slide:
            return method
        from meshonet.solvers.pipeline.layered import Layered

        automatic = self.method in ("best", "auto") or self._operator
        full = None if self.refine or isinstance(self.coarse, int) else base
        own = full is not None and base.name in ("winslow", "steger-sorenson")
        return Layered(
            method, self.first_cells(), {**(self.settings if own else {}), **self._angle()}, full,
            marched=TOPOLOGIES if self.method == "hyperbolic" else ("o", "c") if automatic else (),
            channels=automatic, slide=self.slide, chosen=self.chosen,
        )  # fmt: skip

    def _base(self) -> Method:
        """Return the method with its settings, on all nodes."""
        if self._operator or self.method == "best":
            return method_named("operator" if self.method == "best" else self.method, **self.settings)
        if self.method == "auto":
            return method_named("winslow", **self.settings)
        if self.method == "hyperbolic":  # whose settings are the first cells
            return method_named("hyperbolic")
        return method_named(self.method, **self.settings, **self._angle())

    def _at_any_resolution(self, base: Method) -> Method:
        """Return `base` on fewer nodes where that is asked for, or left open and as good."""
        if self.refine:
            return Sequenced(base, self.refine)
        if isinstance(self.coarse, int):
            return Coarse(base, self.coarse)
        if self._operator or self.method == "best":
            network = ":" in self.method or any(name in self.chosen for name in OPERATOR_SETTINGS)
            return base if network else best(base)
        if self.coarse is None or self.settings or self.initial is not None:
            return base
        return elliptic() if self.method == "auto" else fewer_on_quads(base)

    @property
    def _algebraic(self) -> bool:
        return self.method in METHODS and METHODS[self.method].algebraic

    @property
    def _operator(self) -> bool:
        return self.method.partition(":")[0] == "operator"

    def _angle(self) -> dict[str, float]:
        return {} if self.wall_angle is None else {"angle": self.wall_angle}

    @property
    def chosen(self) -> tuple[str, ...]:
        """What was given and is not so by default, in the order in which it is refused."""
        values = {**self.settings, "initial": self.initial, "coarse": self.coarse, "refine": self.refine}
        return tuple(name for name, value in values.items() if value != DEFAULTS.get(name))
