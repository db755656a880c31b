"""``meshonet solve-pde``."""

from typing import Annotated, Literal

import typer

from meshonet_cli import layers as layer
from meshonet_cli import options as o
from meshonet_cli import walls as wall

EXAMPLES = (
    "meshonet solve-pde duct.csv --res 80x40 -o duct.vts",
    "meshonet solve-pde naca:2412 --res 200 --tol 1e-8 --history cycles.csv -o naca2412.vts",
    "meshonet solve-pde duct.csv --res 400 --coarse 65 -o fine.vts",
    "meshonet solve-pde duct.csv --method thomas-middlecoff --spacing tanh -o layers.vts",
    "meshonet solve-pde duct.csv --res 25x13 --refine 3 -o finest.vts",
    "meshonet solve-pde duct.csv --method variational --res 129 -o best.vts",
    "meshonet solve-pde duct.csv --method steger-sorenson --spacing-south 1e-3 -o upright.vts",
    "meshonet solve-pde duct.csv --res 200x80 --wall-spacing 1e-4 --slide -o channel.vts",
    "meshonet solve-pde airfoil.dat --res 250x100 --y-plus 1 --reynolds 6e6 -o viscous.vts",
)

# fmt: off
Method = Annotated[
    Literal["auto", "winslow", "thomas-middlecoff", "steger-sorenson", "variational", "hyperbolic"],
    typer.Option(
        "--method", metavar="auto|winslow|thomas-middlecoff|steger-sorenson|variational|hyperbolic",
        help="Equations to solve: winslow is elliptic; thomas-middlecoff too, with control functions that "
        "carry the spacing of the edges inside; steger-sorenson has sources at walls that turn the lines "
        "there to --wall-angle; variational minimises a functional of angles "
        "and edge lengths: better angles, no folds; hyperbolic marches from the wall. auto: hyperbolic "
        "around bodies when a first cell is given, and on C grids, with one of its own choice, unless "
        "--coarse, --refine, --tol, --max-cycles or --initial is given; else winslow.",
    ),
]
Tolerance = Annotated[
    float | None,
    typer.Option(
        "--tol", metavar="T", show_default=False,
        help="Stop at this residual, relative to that of the interpolated start (variational: when no node "
        "moves further, in square roots of the area). [default: where more cycles change the grid by less "
        "than a finer one would]",
    ),
]
MaxCycles = Annotated[
    int | None,
    typer.Option(
        "--max-cycles", metavar="N", min=1, show_default=False,
        help="Multigrid cycles (variational: iterations at full resolution) at the most. [default: 30 (200)]",
    ),
]
Coarse = Annotated[
    str,
    typer.Option(
        "--coarse", metavar="auto|off|N",
        help="Solve on N x N nodes and evaluate at --res by splines. auto: on quads (C grids), winslow "
        "above 512 nodes a side with 257 and variational above 257 with 129, which measures as good; in full "
        "with --tol, --max-cycles or --initial.",
    ),
]
Refine = Annotated[
    int,
    typer.Option(
        "--refine", metavar="K", min=0, max=8, show_default=False,
        help="Solve at --res, halve all cells and solve again, K times: the finest grid of a family; "
        "convert --coarsen 2 makes the others of it.",
    ),
]
Initial = Annotated[
    str | None, typer.Option("--initial", metavar="GRID", show_default=False, help="Grid to start from.")
]
Repair = Annotated[
    bool,
    typer.Option(
        "--repair/--no-repair",
        help="Unfold folded cells; without it a grid is as its equations have it, or refused.",
    ),
]
RepairMargin = Annotated[
    int | None,
    typer.Option(
        "--repair-margin", metavar="CELLS", min=2, max=24, show_default=False,
        help="Cells around folded ones that move with them when they are unfolded. 12 takes longer and "
        "blends in better. [default: 6, more where that is not enough]",
    ),
]
History = Annotated[
    str | None,
    typer.Option(
        "--history", metavar="F.csv", show_default=False,
        help="Write residual, change, seconds, folded cells and functional of every cycle to F.csv.",
    ),
]
# fmt: on


def solve_pde(
    boundary: o.Boundaries,
    output: o.Output,
    res: o.Resolution = None,
    method: Method = "auto",
    tol: Tolerance = None,
    max_cycles: MaxCycles = None,
    coarse: Coarse = "auto",
    refine: Refine = 0,
    initial: Initial = None,
    history: History = None,
    topology: o.TopologyOption = "auto",
    spacing: o.SpacingOption = "auto",
    le_spacing: o.LeSpacing = None,
    te_spacing: o.TeSpacing = None,
    wall_spacing: layer.WallSpacing = None,
    y_plus: layer.YPlus = None,
    reynolds: layer.Reynolds = None,
    chord_fraction: layer.ChordFraction = 0.5,
    growth: layer.Growth = None,
    constant_layers: wall.ConstantLayers = None,
    slide: wall.Slide = None,
    wall_angle: wall.WallAngle = None,
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
    repair: Repair = True,
    repair_margin: RepairMargin = None,
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
    """Make smooth grids by solving an elliptic equation, or grids for boundary layers by marching."""
    from functools import partial

    from meshonet_cli.batch import Destination
    from meshonet_cli.gates import parse_gates
    from meshonet_cli.gridding import Recipe, initial_grid, make_grids
    from meshonet_cli.session import Session
    from meshonet_cli.solving import at_any_resolution, given, solver_of

    layers = layer.read_layers(wall_spacing, y_plus, reynolds, chord_fraction, growth, res)
    sides = (spacing_south, spacing_north, spacing_west, spacing_east)
    edges = wall.read_edges(sides, constant_layers, growth, res, layers, slide, wall_angle)
    lengths = {
        "le_spacing": le_spacing, "te_spacing": te_spacing, "far_field": far_field, "te": te, "wake": wake,
        "wake_nodes": wake_nodes, "viscous": layers is not None,
    }  # fmt: skip
    settings = given(tol=o.tolerance(tol), max_cycles=max_cycles, initial=initial_grid(initial))
    solver = partial(solver_of(method), **settings)
    recipe = Recipe(
        o.sampling(
            res, topology, layer.spacing_along(layers, spacing), corners, normalise=normalise, **lengths
        ),
        wall.WithWalls(
            method,
            at_any_resolution(solver, o.coarse_nodes(coarse), refine, method),
            layers,
            edges,
            {
                "--tol": tol,
                "--max-cycles": max_cycles,
                "--initial": initial,
                "--coarse": None if coarse == "auto" else coarse,
                "--refine": refine or None,
            },
        ),
        allow_invalid,
        parse_gates(fail_on),
        repair,
        margin=repair_margin,
        refine=refine,
        history=history,
    )
    session = Session(quiet=quiet, as_json=as_json, debug=debug)
    destination = Destination(output, to_format, "grids")
    return make_grids(
        boundary, recipe, destination, session, fmt=from_format, skip_existing=skip_existing, jobs=jobs
    )
