"""Options for the first-cell height at walls and the growth of cells."""

from dataclasses import dataclass
from typing import Annotated, Any

from meshonet_cli.options.groups import BOUNDARY_LAYER, by_name, number, option_of

_option = option_of(BOUNDARY_LAYER)

# fmt: off
WallAngle = Annotated[float | None, _option(
    metavar="DEGREES", help="Angle between grid lines and walls, for --method steger-sorenson. It "
    "applies to sides with a first cell; if there are none, to south and north, or to the wall of a body. "
    "[default: 90]",
)]
Slide = Annotated[bool | None, _option(
    "--slide/--no-slide", help="Move wall nodes along the walls until grid lines leave the walls at right "
    "angles: on south and north of a four-sided domain, or on all sides of a multi-block grid that is read. "
    "[default: --slide if --method is auto, south or north has a first cell, and their nodes are not given; "
    "else --no-slide]",
)]
FirstCell = Annotated[str | None, _option(
    "--first-cell", "--wall-spacing", metavar="H|WALL=H,...", help="Height of the first cell at walls, in "
    "the unit of the input. In a one-block grid around a body the unit is the chord of an airfoil, or the "
    "largest extent of another body. WALL=H,WALL=H applies to the named walls only. H applies to the body "
    "or the holes; in a four-sided domain to south, north and sides with 'wall' in the name; never to sides "
    "named inlet, outlet, axis, symmetry or farfield. If a multi-block grid has such sides but no holes, H "
    "applies to all other sides. [default: no layers]",
)]
YPlus = Annotated[float | None, _option(
    metavar="Y", help="y+ at the height of the first cell, instead of --first-cell; y+ at the cell "
    "centre is half as large. The height follows from --reynolds for a turbulent flat plate.",
)]
YPlusAtWalls = Annotated[str | None, _option(
    metavar="Y|WALL=Y,...", help="y+ at the height of the first cell, instead of --first-cell; y+ at the "
    "cell centre is half as large. The height follows from --reynolds for a turbulent flat plate. "
    "WALL=Y,WALL=Y applies to the named walls only.",
)]
Length = Annotated[float | None, _option(
    metavar="L", help="Reference length of --reynolds, in the unit of --first-cell. [default: chord or "
    "largest extent of a body; in a four-sided domain, distance from the first to the farthest node of "
    "south; in a multi-block grid, largest extent of all holes together, or of the domain if it has no "
    "holes; 1 for a marched volume]",
)]
Reynolds = Annotated[float | None, _option(
    metavar="RE", help="Reynolds number for --y-plus, based on --length.",
)]


def at_walls(text: str | None, parameter: str) -> Any:
    """Return the value of an option, or its values by wall; None for None. Raises InputError: not a value.

    >>> at_walls("1e-3", "first_cell"), at_walls("tubes=1e-3,floor=5e-3", "first_cell")
    (0.001, {'tubes': 0.001, 'floor': 0.005})
    """
    if text is None:
        return None
    remedy = "use a number, or WALL=NUMBER, e.g. tubes=1e-3,floor=5e-3"
    return by_name(text, float, remedy, parameter) if "=" in text else number(text, remedy, parameter)


@dataclass(frozen=True, kw_only=True)
class LayerOptions:
    """Options for the height of first cells at walls."""

    first_cell: FirstCell = None
    y_plus: YPlusAtWalls = None
    reynolds: Reynolds = None
    length: Length = None
    chord_fraction: float = _option(
        default=0.5, metavar="X", help="Position on the flat plate where y+ is as given, as a fraction of "
        "--length.",
    )
    growth: float | None = _option(
        metavar="G", help="Largest ratio of the heights of neighbouring cells on a grid line from a wall. It "
        "determines the number of rows, unless --res gives NJ. [default: 1.2 for multi-block grids and "
        "marched volumes; otherwise set by the number of rows]",
    )
    constant_layers: int | None = _option(
        metavar="K", min=1, help="Number of rows at the wall that are as high as the first cell. [default: "
        "1]",
    )


@dataclass(frozen=True, kw_only=True)
class SideOptions:
    """Options for the height of first cells at individual sides of four-sided domains."""

    spacing_south: float | None = _option(
        metavar="H", help="Height of the first cell at the south side of a four-sided domain, in the unit of "
        "the input. [default: as --first-cell]",
    )
    spacing_north: float | None = _option(metavar="H", help="The same for the north side.")
    spacing_west: float | None = _option(metavar="H", help="The same for the west side.")
    spacing_east: float | None = _option(metavar="H", help="The same for the east side.")
# fmt: on
