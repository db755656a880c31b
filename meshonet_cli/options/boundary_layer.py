"""Options that say how high the cells at walls are, and how they grow."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from meshonet_cli.options.groups import BOUNDARY_LAYER, option_of

_option = option_of(BOUNDARY_LAYER)

# fmt: off
FirstCell = Annotated[float | None, _option(
    "--first-cell", "--wall-spacing", metavar="H",
    help="Height of the first cell at every wall node: around a body in chords, in a four-sided domain off "
    "south and north in its own unit. Around bodies, solve-pde and infer then march the grid from the wall.",
)]
YPlus = Annotated[float | None, _option(
    "--y-plus", metavar="Y",
    help="The same as a y+, estimated for a turbulent flat plate; needs --reynolds.",
)]
Reynolds = Annotated[float | None, _option(
    "--reynolds", metavar="RE",
    help="Reynolds number of the chord; of a four-sided domain, of the extent of its south side.",
)]
ChordFraction = Annotated[float, _option(
    "--chord-fraction", metavar="X", show_default=True,
    help="Where along the chord --y-plus is estimated, 0 to 1.",
)]
Growth = Annotated[float | None, _option(
    "--growth", metavar="G",
    help="Largest ratio of neighbouring cells away from the wall, e.g. 1.15; without --res it decides the "
    "number of rows. [default: what the rows need]",
)]
ConstantLayers = Annotated[int | None, _option(
    "--constant-layers", metavar="K", min=1,
    help="Number of equally high first cells, before they grow. [default: 1]",
)]
WallAngle = Annotated[float | None, _option(
    "--wall-angle", metavar="DEGREES",
    help="Angle at which grid lines leave walls, for --method steger-sorenson: the sides with a first cell, "
    "or else south and north, or the body. [default: 90]",
)]
Slide = Annotated[bool | None, _option(
    "--slide/--no-slide",
    help="Move the nodes of south and north of a four-sided domain along these walls to where grid lines "
    "leave at right angles. [default: with --first-cell, when the nodes were sampled here]",
)]
SpacingSouth = Annotated[float | None, _option(
    "--spacing-south", metavar="H",
    help="Height of the first cell at every node of the south side of a four-sided domain, in its unit.",
)]
SpacingNorth = Annotated[float | None, _option(
    "--spacing-north", metavar="H",
    help="The same off the north side.",
)]
SpacingWest = Annotated[float | None, _option(
    "--spacing-west", metavar="H",
    help="The same off the west side.",
)]
SpacingEast = Annotated[float | None, _option(
    "--spacing-east", metavar="H",
    help="The same off the east side.",
)]
# fmt: on


@dataclass(frozen=True)
class LayerOptions:
    """First cells at walls."""

    first_cell: FirstCell = None
    y_plus: YPlus = None
    reynolds: Reynolds = None
    chord_fraction: ChordFraction = 0.5
    growth: Growth = None
    constant_layers: ConstantLayers = None


@dataclass(frozen=True)
class SideOptions:
    """First cells off single sides of four-sided domains."""

    spacing_south: SpacingSouth = None
    spacing_north: SpacingNorth = None
    spacing_west: SpacingWest = None
    spacing_east: SpacingEast = None
