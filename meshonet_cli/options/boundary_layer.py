"""Options that say how high the cells at walls are, and how they grow."""

from dataclasses import dataclass
from typing import Annotated

from meshonet_cli.options.groups import BOUNDARY_LAYER, option_of

_option = option_of(BOUNDARY_LAYER)

# fmt: off
WallAngle = Annotated[float | None, _option(
    "--wall-angle", metavar="DEGREES",
    help="Angle at which grid lines leave walls, for --method steger-sorenson. Walls are the sides with a "
    "first cell; without one, south and north, or the body. [default: 90]",
)]
Slide = Annotated[bool | None, _option(
    "--slide/--no-slide",
    help="Move the nodes of south and north of a four-sided domain along these walls to where grid lines "
    "leave at right angles. [default: with first cells there, when this command samples the nodes]",
)]
FirstCell = Annotated[float | None, _option(
    "--first-cell", "--wall-spacing", metavar="H",
    help="Height of the first cell at every wall node: around a body in chords, in a four-sided domain "
    "off south and north, and in one of many blocks around holes, in its own unit. Around bodies, solve-pde "
    "and infer then march the grid from the wall.",
)]
YPlus = Annotated[float | None, _option(
    "--y-plus", metavar="Y",
    help="The same as a y+ of its height, estimated for a turbulent flat plate; needs --reynolds.",
)]
Reynolds = Annotated[float | None, _option(
    "--reynolds", metavar="RE",
    help="Reynolds number of the chord; of a four-sided domain, of the extent of its south side; of many "
    "blocks, of the extent of all holes.",
)]


@dataclass(frozen=True, kw_only=True)
class LayerOptions:
    """First cells at walls."""

    first_cell: FirstCell = None
    y_plus: YPlus = None
    reynolds: Reynolds = None
    chord_fraction: Annotated[float, _option(
        "--chord-fraction", metavar="X", show_default=True,
        help="Where along the chord --y-plus is estimated, 0 to 1.",
    )] = 0.5
    growth: Annotated[float | None, _option(
        "--growth", metavar="G",
        help="Largest ratio of neighbouring cells away from the wall, e.g. 1.15; without --res it decides "
        "the number of rows. [default: what the rows need]",
    )] = None
    constant_layers: Annotated[int | None, _option(
        "--constant-layers", metavar="K", min=1,
        help="Number of equally high first cells, before they grow. [default: 1]",
    )] = None


@dataclass(frozen=True, kw_only=True)
class SideOptions:
    """First cells off single sides of four-sided domains."""

    spacing_south: Annotated[float | None, _option(
        "--spacing-south", metavar="H",
        help="Height of the first cell at every node of the south side of a four-sided domain, in its unit.",
    )] = None
    spacing_north: Annotated[float | None, _option(
        "--spacing-north", metavar="H", help="The same off the north side.",
    )] = None
    spacing_west: Annotated[float | None, _option(
        "--spacing-west", metavar="H", help="The same off the west side.",
    )] = None
    spacing_east: Annotated[float | None, _option(
        "--spacing-east", metavar="H", help="The same off the east side.",
    )] = None
# fmt: on
