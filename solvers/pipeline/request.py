"""Options of the grid generation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING, Any, Literal

from meshonet.geometry.arrays import SIDES
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.spacing.first_cell import FirstCell
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.pipeline.check_request import check_request
from meshonet.solvers.pipeline.methods import METHODS
from meshonet.solvers.pipeline.uses import ALWAYS, COUNTED, FOR_MANY, OF_SURFACE, SETTINGS

if TYPE_CHECKING:
    from meshonet.geometry.layout.layout import Layout


@dataclass(frozen=True)
class Request(FirstCell):
    """Options that every kind of grid has; `GridRequest` explains them."""

    sampling: Sampling = field(default_factory=Sampling)
    method: str = "best"
    settings: Mapping[str, Any] = field(default_factory=dict)
    growth: float | None = None
    allow_invalid: bool = False
    percentiles: bool = False
    threads: int | None = None

    @property
    def chosen(self) -> tuple[str, ...]:
        """Names of the options, then of the settings, whose values are not the defaults."""
        names: list[str] = []
        plain = vars(Sampling())
        for name, value in vars(self.sampling).items():
            if value != plain[name]:
                names.append("res" if name in COUNTED else name)
        for each in fields(self):
            value = getattr(self, each.name)
            if each.name not in ALWAYS and value != each.default and value is not False and value != {}:
                names.append(each.name)
        for name, value in self.settings.items():
            if value != SETTINGS.get(name):
                names.append(name)
        return tuple(dict.fromkeys(names))


@dataclass(frozen=True)
class OneBlock(Request):
    """Options of single-block grids."""

    constant_layers: int | None = None
    walls: tuple[str, ...] = ()
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
        """First-cell heights that are prescribed for single sides, by side."""
        heights = self.spacing_south, self.spacing_east, self.spacing_north, self.spacing_west
        if heights == (None,) * 4:
            return {}
        return {side: h for side, h in zip(SIDES, heights, strict=True) if h is not None}

    @property
    def rows_at_walls(self) -> dict[str, Any]:
        """Parameters of `march.hyperbolic` that concern the growth and the number of rows at walls."""
        free = self.growth is not None and self.sampling.nj is None
        constant, multiple = self.constant_layers or 1, 2**self.refine
        return {"growth": self.growth, "free_rows": free, "constant": constant, "multiple": multiple}

    @property
    def algebraic(self) -> bool:
        """Whether the method solves no equations."""
        return self.method in METHODS and METHODS[self.method].algebraic

    @property
    def by_network(self) -> bool:
        """Whether the method is a neural operator."""
        return self.method.partition(":")[0] == "operator"

    def shape_sampling(self) -> Sampling:
        """Return the sampling; if first-cell heights are given, spacing ``auto`` becomes ``curvature``."""
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
    """Options of multi-block grids."""

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
    count: Mapping[str, int] = field(default_factory=dict)

    @property
    def asks_for_blocks(self) -> tuple[str, ...]:
        """Names of the given options that apply to multi-block grids only."""
        return tuple(filter(FOR_MANY.__contains__, self.chosen))

    @property
    def names_walls(self) -> tuple[str, ...]:
        """Name of the option that selects the walls with layers, in a tuple; () if no option does."""
        if self.by_wall:
            return ("first_cell" if self.y_plus is None else "y_plus",)
        return ("walls",) if self.walls else ()


@dataclass(frozen=True)
class Volume(Request):
    """Options of three-dimensional grids."""

    slide: bool | None = None
    coarse: int | Literal["auto"] | None = "auto"
    layers: int | None = None
    symmetry: Literal["x", "y", "z", "none"] | None = None
    poles: Literal["replace", "refuse"] = "replace"
    energy: Literal["angles", "shape"] | None = None

    @property
    def of_surface(self) -> bool:
        """Whether options require that a volume is marched from a surface."""
        return self.method == "hyperbolic" and not (OF_SURFACE | {"far_field"}).isdisjoint(self.chosen)


@dataclass(frozen=True)
class GridRequest(OneBlock, ManyBlocks, Volume):
    """All options of a grid, or of many grids of similar shapes. Values are checked on construction.

    Parameters
    ----------
    sampling : Sampling, optional
        Numbers of nodes and spacing of the boundary.
    method : str, optional
        A key of `METHODS`, ``best`` (the default for the topology) or ``auto`` (Winslow's equations). With
        ``best`` and ``auto``, C grids are marched; so are grids around bodies with a first-cell height.
    settings : dict, optional
        Settings of the method by name.
    first_cell : float or mapping, optional
        Height of first cells at the walls in `walls`, in chords for grids around bodies, else in the domain's
        unit. In four-sided and multi-block domains, a mapping from names to heights selects walls.
    y_plus : float or mapping, optional
        First-cell height as y+ of a turbulent flat plate, instead of `first_cell`.
    reynolds : float, optional
        Reynolds number for `y_plus`.
    length : float, optional
        Reference length of the Reynolds number, in the unit of `first_cell`. None: the chord of a body; the
        extent of the south side of a four-sided domain; the extent of all holes of a multi-block domain, or
        of its outer boundary if it has no holes; 1 for marching from a surface.
    chord_fraction : float, optional
        Position along the reference length, from 0 to 1, at which y+ is converted to a height.
    growth : float, optional
        Greatest growth ratio of cells away from the wall. It determines the number of rows if `sampling`
        has none.
    constant_layers : int, optional
        Number of rows at the wall that have the height of the first cell.
    spacing_south, spacing_north, spacing_west, spacing_east : float, optional
        First-cell heights at single sides of a four-sided domain.
    slide : bool, optional
        Whether nodes move along the walls south and north, so that grid lines leave them at right angles.
        None: they move if three conditions are true: the method is ``auto`` or ``best``, south or north has
        a first-cell height, and meshonet has placed the nodes of the walls.
    wall_angle : float, optional
        Angle between grid lines and walls in degrees, for ``steger-sorenson``.
    coarse : int or 'auto', optional
        Greatest number of nodes per direction to solve for; the solution is then interpolated to all nodes.
        ``auto``: selected by method and size. None: all nodes.
    refine : int, optional
        Number of refinements after the first solution; each halves all cells and solves again.
    initial : Grid, optional
        Grid from which the solution starts.
    repair : bool, optional
        Whether a grid with folded cells is repaired, or made again by another method; otherwise it is an
        error. None: True, except for algebraic methods, and neural networks with ``answer="raw"``.
    repair_margin : int, optional
        Width in cells of the region around folded cells in which the repair moves nodes.
    allow_invalid : bool, optional
        Whether a grid with folded cells is returned instead of an error.
    percentiles : bool, optional
        Whether the quality includes percentiles.
    history : bool, optional
        Whether the result contains the convergence history of the iteration.
    blocks : {'auto', 'single'}, optional
        ``single`` makes one block where ``auto`` would make several.
    cells : int, optional
        Approximate number of cells of a multi-block grid. A grid has several blocks if one of `cells`,
        `cell_size`, `count`, `pitch`, `inlet`, `outlet`, `layout` and `periodic` is given.
    cell_size : float, optional
        Edge length of cells, instead of `cells`.
    walls : tuple of str, optional
        Names of the walls with layers. If none are given, south, north and sides called wall have layers in
        a four-sided domain. In a multi-block domain, all holes have layers. If there are no holes, but some
        sides cannot be walls because of names such as ``inlet``, all other sides have layers.
    pitch : tuple of 2 float, optional
        Displacement vector from one blade of a cascade to the next.
    inlet, outlet : float, optional
        Lengths of the passage upstream and downstream of the blade, in axial chords.
    layout : Layout, optional
        Blocks of another grid, which are used again.
    periodic : tuple of tuple of str, optional
        Pairs of sides of a domain, by name, that are periodic.
    count : mapping, optional
        Numbers of cells along sides of a domain by name; with `refine`, numbers in the coarsest grid.
    layers : int, optional
        Number of nodes along each grid line of a volume marched from a surface, including the wall node.
    symmetry : {'x', 'y', 'z', 'none'}, optional
        Axis normal to the plane of symmetry, which contains the open edges of a surface.
    poles : {'replace', 'refuse'}, optional
        Treatment of surface patches with a side that is a point: ``replace`` covers the point by another
        patch, ``refuse`` raises an error.
    energy : {'angles', 'shape'}, optional
        Functional that is minimised in a volume inside six faces: ``angles`` favours right angles and gradual
        changes of length, ``shape`` cells like cubes. None: ``angles``.
    threads : int, optional
        Number of threads; None: all cores.

    Raises
    ------
    InputError
        A value out of its range; parameters that exclude each other or lack another that they need.
    """

    def __post_init__(self) -> None:
        check_request(self)
