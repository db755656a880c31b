"""What a user can ask of a grid."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal

from meshonet.geometry.arrays import SIDES
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.spacing.first_cell import FirstCell
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.pipeline.check_request import check_request
from meshonet.solvers.pipeline.methods import METHODS
from meshonet.solvers.pipeline.uses import FOR_MANY, OF_SURFACE, chosen

if TYPE_CHECKING:
    from meshonet.geometry.layout.layout import Layout


@dataclass(frozen=True)
class Request(FirstCell):
    """What every way of making grids reads; `GridRequest` explains all fields."""

    sampling: Sampling = field(default_factory=Sampling)
    method: str = "best"
    settings: Mapping[str, Any] = field(default_factory=dict)
    growth: float | None = None
    allow_invalid: bool = False
    percentiles: bool = False
    threads: int | None = None

    @property
    def chosen(self) -> tuple[str, ...]:
        """Names of the options that are not what they are by default, settings at the end."""
        return chosen(self)


@dataclass(frozen=True)
class OneBlock(Request):
    """What a grid of one block needs."""

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
    history: bool = False

    @property
    def sides(self) -> dict[str, float]:
        """Heights of first cells off single sides, by the side."""
        heights = self.spacing_south, self.spacing_east, self.spacing_north, self.spacing_west
        if heights == (None,) * 4:
            return {}
        return {side: h for side, h in zip(SIDES, heights, strict=True) if h is not None}

    @property
    def algebraic(self) -> bool:
        """Whether the method solves no equations."""
        return self.method in METHODS and METHODS[self.method].algebraic

    @property
    def by_network(self) -> bool:
        """Whether the method is a neural operator by its name."""
        return self.method.partition(":")[0] == "operator"

    def shape_sampling(self) -> Sampling:
        """Return the sampling of shapes: with thin first cells, wall nodes whose spacing changes slowly."""
        if not self.at_walls or self.algebraic:
            return self.sampling
        spacing = "curvature" if self.sampling.spacing == "auto" else self.sampling.spacing
        return replace(self.sampling, spacing=spacing, viscous=True)

    def repairs(self) -> bool:
        """Return whether folded grids are repaired."""
        if self.repair is not None:
            return self.repair
        return not self.algebraic and self.settings.get("answer", "valid") == "valid"


@dataclass(frozen=True)
class ManyBlocks(Request):
    """What a grid of many blocks needs."""

    constant_layers: int | None = None
    slide: bool | None = None
    refine: int = 0
    blocks: Literal["auto", "single"] = "auto"
    cells: int | None = None
    cell_size: float | None = None
    walls: tuple[str, ...] = ()
    pitch: tuple[float, float] | None = None
    inlet: float | None = None
    outlet: float | None = None
    layout: Layout | None = None
    periodic: tuple[tuple[str, str], ...] = ()

    @property
    def asks_for_blocks(self) -> tuple[str, ...]:
        """Names of the options that are given and that only many blocks have a use for."""
        return tuple(filter(FOR_MANY.__contains__, self.chosen))


@dataclass(frozen=True)
class Volume(Request):
    """What a grid in space needs."""

    slide: bool | None = None
    coarse: int | Literal["auto"] | None = "auto"
    layers: int | None = None
    symmetry: Literal["x", "y", "z", "none"] | None = None
    energy: Literal["angles", "shape"] | None = None

    @property
    def of_surface(self) -> bool:
        """Whether options that only surfaces have a use for ask for a march from one, be it flat."""
        return self.method == "hyperbolic" and not OF_SURFACE.isdisjoint(self.chosen)


@dataclass(frozen=True)
class GridRequest(OneBlock, ManyBlocks, Volume):
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
    periodic : tuple of tuple of str, optional
        Pairs of sides of a domain, by name, that are periodic.
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

    def __post_init__(self) -> None:
        check_request(self)
