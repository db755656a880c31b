"""Options for the first-cell height at walls and the growth of cells."""

from dataclasses import dataclass
from typing import Annotated, Any

from meshonet_cli.options.groups import BOUNDARY_LAYER, by_name, number, option_of

_option = option_of(BOUNDARY_LAYER)

# fmt: off
WallAngle = Annotated[float | None, _option(
    "--wall-angle", metavar="DEGREES",
    help="Angle in degrees between grid lines and walls, for --method steger-sorenson. Walls are the sides "
    "with a first cell. If no side has a first cell, the walls are south and north, or the body. [default: "
    "90]",
)]
Slide = Annotated[bool | None, _option(
    "--slide/--no-slide",
    help="Move the nodes of south and north along these walls, so that grid lines leave the walls at right "
    "angles. Applies to four-sided domains. [default: --slide if these walls have first cells and this "
    "command places their nodes, else --no-slide]",
)]
FirstCell = Annotated[str | None, _option(
    "--first-cell", "--wall-spacing", metavar="H|WALL=H,...",
    help="Height of the first cell at every wall node. Around a body the unit is the chord, otherwise that "
    "of the input. Walls of a four-sided domain: south, north and sides that are called wall. Walls of a "
    "multi-block grid: the holes; without holes all sides, if at least one of them is called inlet, outlet, "
    "axis or symmetry, else none. Sides with one of these four names are no walls. --walls selects other "
    "walls. WALL=H,WALL=H selects walls and gives each its own height. Around a body, solve-pde and infer "
    "then march the grid from the wall.",
)]
YPlus = Annotated[float | None, _option(
    "--y-plus", metavar="Y",
    help="Height of the first cell as y+, instead of --first-cell; y+ at the centre of the cell is half of "
    "this. The conversion assumes a turbulent flat plate and needs --reynolds.",
)]
YPlusAtWalls = Annotated[str | None, _option(
    "--y-plus", metavar="Y|WALL=Y,...",
    help="Height of the first cell as y+, instead of --first-cell; y+ at the centre of the cell is half of "
    "this. WALL=Y,WALL=Y gives each named wall of a multi-block grid its own y+. The conversion assumes a "
    "turbulent flat plate and needs --reynolds.",
)]
Length = Annotated[float | None, _option(
    "--length", metavar="L",
    help="Reference length of --reynolds, in the unit of --first-cell. [default: the length described at "
    "--reynolds]",
)]
Reynolds = Annotated[float | None, _option(
    "--reynolds", metavar="RE",
    help="Reynolds number for --y-plus. The reference length is the chord of a body, the extent of the south "
    "side of a four-sided domain, or the extent of all holes of a multi-block grid.",
)]


def at_walls(text: str | None, parameter: str) -> Any:
    """Return one value, or values by wall; None for None. Raises InputError: other text.

    >>> at_walls("1e-3", "first_cell"), at_walls("tubes=1e-3,floor=5e-3", "first_cell")
    (0.001, {'tubes': 0.001, 'floor': 0.005})
    """
    if text is None:
        return None
    remedy = "use a number, or WALL=NUMBER, e.g. tubes=1e-3,floor=5e-3"
    return by_name(text, float, remedy, parameter) if "=" in text else number(text, remedy, parameter)


@dataclass(frozen=True, kw_only=True)
class LayerOptions:
    """First cells at walls."""

    first_cell: FirstCell = None
    y_plus: YPlusAtWalls = None
    reynolds: Reynolds = None
    length: Length = None
    chord_fraction: Annotated[float, _option(
        "--chord-fraction", metavar="X", show_default=True,
        help="Position along the reference length, from 0 to 1, at which --y-plus is converted to a height.",
    )] = 0.5
    growth: Annotated[float | None, _option(
        "--growth", metavar="G",
        help="Largest ratio of the heights of neighbouring cells along a grid line away from the wall, e.g. "
        "1.15. The number of rows follows from it, unless --res gives this number as NJ. [default: 1.2 for "
        "multi-block grids, else the ratio that follows from the number of rows]",
    )] = None
    constant_layers: Annotated[int | None, _option(
        "--constant-layers", metavar="K", min=1,
        help="Number of rows at the wall with the height of the first cell, before the cells grow. "
        "[default: 1]",
    )] = None
# fmt: on
