"""Options for the first-cell height at walls and the growth of cells."""

from dataclasses import dataclass
from typing import Annotated, Any

from meshonet_cli.options.groups import BOUNDARY_LAYER, by_name, number, option_of

_option = option_of(BOUNDARY_LAYER)

# fmt: off
WallAngle = Annotated[float | None, _option(
    metavar="DEGREES", help="Angle between grid lines and walls in degrees, for --method steger-sorenson. "
    "Walls are the sides with a first cell; if there are none, south and north, or the body. [default: 90]",
)]
Slide = Annotated[bool | None, _option(
    "--slide/--no-slide", help="Move wall nodes along the walls, so that grid lines leave these at right "
    "angles: along south and north of a four-sided domain, or along all sides of a given multi-block grid. "
    "[default: --slide if south and north have first cells and this command places their nodes, else "
    "--no-slide]",
)]
FirstCell = Annotated[str | None, _option(
    "--first-cell", "--wall-spacing", metavar="H|WALL=H,...", help="Height of the first cell at walls. For "
    "a grid of one block around a body the unit is the chord, or the bounding-box length of a body without "
    "a chord; otherwise it is that of the input. WALL=H,WALL=H gives named walls a height each, and other "
    "walls no layers. Walls of a four-sided domain: south, north and sides named wall. Walls of a "
    "multi-block grid: the holes; without holes, all sides, if one is named inlet, outlet, axis or symmetry "
    "(these four are no walls). --walls selects others. [default: no layers]",
)]
YPlus = Annotated[float | None, _option(
    metavar="Y", help="y+ of the height of the first cell, instead of --first-cell; y+ at the centre of the "
    "cell is half of it. The conversion assumes a turbulent flat plate and needs --reynolds.",
)]
YPlusAtWalls = Annotated[str | None, _option(
    metavar="Y|WALL=Y,...", help="y+ of the height of the first cell, instead of --first-cell; y+ at the "
    "centre of the cell is half of it. WALL=Y,WALL=Y gives named walls of a multi-block grid a value each. "
    "The conversion assumes a turbulent flat plate and needs --reynolds.",
)]
Length = Annotated[float | None, _option(
    metavar="L", help="Reference length of --reynolds, in the unit of --first-cell. [default: chord or "
    "bounding-box length of a body; extent of the south side of a four-sided domain; bounding-box length of "
    "all holes of a multi-block grid]",
)]
Reynolds = Annotated[float | None, _option(
    metavar="RE", help="Reynolds number for --y-plus, based on --length.",
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
    chord_fraction: float = _option(
        default=0.5, metavar="X", help="Position, as a fraction of --length from the leading edge, at which "
        "--y-plus becomes a height.",
    )
    growth: float | None = _option(
        metavar="G", help="Largest ratio of the heights of neighbouring cells along a grid line away from "
        "the wall, e.g. 1.15. The number of rows follows from it, unless --res gives NJ. [default: 1.2 for "
        "multi-block grids; otherwise the ratio follows from the number of rows]",
    )
    constant_layers: int | None = _option(
        metavar="K", min=1, help="Number of rows at the wall with the height of the first cell, before "
        "cells grow. [default: 1]",
    )


@dataclass(frozen=True, kw_only=True)
class SideOptions:
    """First cells at single sides of four-sided domains."""

    spacing_south: float | None = _option(
        metavar="H", help="Height of the first cell at the south side of a four-sided domain, in the unit "
        "of the input. [default: the height that --first-cell gives]",
    )
    spacing_north: float | None = _option(metavar="H", help="The same for the north side.")
    spacing_west: float | None = _option(metavar="H", help="The same for the west side.")
    spacing_east: float | None = _option(metavar="H", help="The same for the east side.")
# fmt: on
