"""``meshonet tfi``."""

from typing import Annotated, Literal

import typer

from meshonet_cli import layers as layer
from meshonet_cli import options as o
from meshonet_cli import walls as wall

EXAMPLES = (
    "meshonet tfi duct.csv --res 80x40 -o duct.vts",
    "meshonet tfi duct.csv --res 80x40 --spacing-south 1e-3 --growth 1.5 -o layers.vts",
    "meshonet sample-boundary naca:2412 -o - | meshonet tfi - -o - | meshonet quality -",
)
BlendingName = Literal["arclength", "linear"]


def tfi(
    boundary: o.Boundaries,
    output: o.Output,
    res: o.Resolution = None,
    blending: Annotated[
        BlendingName,
        typer.Option("--blending", metavar="arclength|linear", help="What the edges are blended by."),
    ] = "arclength",
    topology: o.TopologyOption = "auto",
    spacing: o.SpacingOption = "auto",
    le_spacing: o.LeSpacing = None,
    te_spacing: o.TeSpacing = None,
    wall_spacing: layer.WallHeight = None,
    y_plus: layer.YPlus = None,
    reynolds: layer.Reynolds = None,
    chord_fraction: layer.ChordFraction = 0.5,
    growth: layer.Growth = None,
    constant_layers: wall.ConstantLayers = None,
    spacing_south: wall.SpacingSouth = None,
    spacing_north: wall.SpacingNorth = None,
    spacing_west: wall.SpacingWest = None,
    spacing_east: wall.SpacingEast = None,
    te: o.TrailingEdge = "auto",
    far_field: o.FarField = None,
    wake: o.Wake = None,
    wake_nodes: o.WakeNodes = None,
    corners: o.Corners = "auto",
    normalise: o.Normalise = False,
    repair: Annotated[
        bool, typer.Option("--repair", help="Unfold folded cells, which interpolation alone does not.")
    ] = False,
    allow_invalid: o.AllowInvalid = False,
    fail_on: o.FailOn = None,
    from_format: o.From = None,
    to_format: o.To = None,
    skip_existing: o.SkipExisting = False,
    jobs: o.Jobs = 1,
    as_json: o.AsJson = False,
    quiet: o.Quiet = False,
    debug: o.Debug = False,
) -> int:
    """Make grids by transfinite interpolation."""
    from functools import partial

    from meshonet_cli.batch import Destination
    from meshonet_cli.gates import parse_gates
    from meshonet_cli.gridding import Recipe, interpolated, make_grids
    from meshonet_cli.session import Session

    layers = layer.read_layers(wall_spacing, y_plus, reynolds, chord_fraction, growth, res)
    sides = (spacing_south, spacing_north, spacing_west, spacing_east)
    edges = wall.read_edges(sides, constant_layers, growth, res, layers)
    lengths = {"le_spacing": le_spacing, "te_spacing": te_spacing, "far_field": far_field, "te": te}
    lengths |= {"wake": wake, "wake_nodes": wake_nodes}
    recipe = Recipe(
        o.sampling(res, topology, spacing, corners, normalise=normalise, **lengths),
        wall.WithWalls("tfi", partial(interpolated, blending=blending), layers, edges),
        allow_invalid,
        parse_gates(fail_on),
        repair,
    )
    session = Session(quiet=quiet, as_json=as_json, debug=debug)
    destination = Destination(output, to_format, "grids")
    return make_grids(
        boundary, recipe, destination, session, fmt=from_format, skip_existing=skip_existing, jobs=jobs
    )
