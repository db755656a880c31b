"""``meshonet solve-pde``."""

from typing import Annotated, Literal

from meshonet_cli import options as o

EXAMPLES = (
    "meshonet solve-pde duct.csv --res 80x40 -o duct.vts",
    "meshonet solve-pde naca:2412 --res 200 --tol 1e-8 --history cycles.csv -o naca2412.vts",
    "meshonet solve-pde duct.csv --res 400 --coarse 65 -o fine.vts",
    "meshonet solve-pde duct.csv --method thomas-middlecoff --spacing tanh -o layers.vts",
    "meshonet solve-pde duct.csv --res 25x13 --refine 3 -o finest.vts",
    "meshonet solve-pde duct.csv --method variational --res 129 -o best.vts",
    "meshonet solve-pde duct.csv --method steger-sorenson --spacing-south 1e-3 -o upright.vts",
    "meshonet solve-pde duct.csv --res 200x80 --first-cell 1e-4 --slide -o channel.vts",
    "meshonet solve-pde airfoil.dat --res 250x100 --y-plus 1 --reynolds 6e6 -o viscous.vts",
)

_option = o.option_of(o.METHOD)

# fmt: off
Method = Annotated[
    Literal["auto", "winslow", "thomas-middlecoff", "steger-sorenson", "variational", "hyperbolic"],
    _option(
        "--method", metavar="auto|winslow|thomas-middlecoff|steger-sorenson|variational|hyperbolic",
        show_default=True,
        help="winslow: elliptic, without control functions. thomas-middlecoff: with control functions that "
        "carry the spacing of the edges inside. steger-sorenson: with sources at walls that turn grid lines "
        "to --wall-angle there. variational: minimises a functional of angles and edge lengths; better "
        "angles, no folds. hyperbolic: marches from the wall. auto: hyperbolic around bodies with a first "
        "cell and on C grids (with a first cell of its own), unless --coarse, --refine, --tol, --max-cycles "
        "or --initial is given; else winslow.",
    ),
]
Tolerance = Annotated[
    float | None,
    _option(
        "--tol", metavar="T",
        help="Stop at this residual, relative to that of the interpolated start (variational: when no node "
        "moves further, in square roots of the area). [default: where more cycles change the grid by less "
        "than a finer one would]",
    ),
]
MaxCycles = Annotated[
    int | None,
    _option(
        "--max-cycles", metavar="N", min=1,
        help="Multigrid cycles (variational: iterations at full resolution) at the most. [default: 30 (200)]",
    ),
]
Coarse = Annotated[
    str,
    _option(
        "--coarse", metavar="auto|off|N", show_default=True,
        help="Solve on N x N nodes and interpolate to --res by splines. auto does so on large quads and C "
        "grids, where it measures as well: winslow above 512 nodes a side with 257, variational above 257 "
        "with 129; not with --tol, --max-cycles or --initial.",
    ),
]
Refine = Annotated[
    int,
    _option(
        "--refine", metavar="K", min=0, max=8,
        help="Solve at --res, halve all cells and solve again, K times: the finest grid of a family; "
        "convert --coarsen 2 makes the others of it.",
    ),
]
Initial = Annotated[
    str | None, _option("--initial", metavar="GRID", help="Grid to start from.")
]
RepairMargin = Annotated[
    int | None,
    o.option_of(o.CHECKS)(
        "--repair-margin", metavar="CELLS", min=2, max=24,
        help="Width of the band of cells around folded ones that moves when they are unfolded; 12 is slower "
        "and smoother. [default: 6, more where that is not enough]",
    ),
]
History = Annotated[
    str | None,
    o.option_of(o.IO)(
        "--history", metavar="F.csv",
        help="Write residual, change, seconds, folded cells and functional of every cycle to F.csv.",
    ),
]
# fmt: on


@o.expanded
def solve_pde(
    boundary: o.Boundaries,
    output: o.Output,
    sampling: o.SamplingOptions,
    first: o.LayerOptions,
    sides: o.SideOptions,
    checks: o.CheckOptions,
    files: o.FileOptions,
    printing: o.PrintOptions,
    method: Method = "auto",
    tol: Tolerance = None,
    max_cycles: MaxCycles = None,
    coarse: Coarse = "auto",
    refine: Refine = 0,
    initial: Initial = None,
    history: History = None,
    slide: o.Slide = None,
    wall_angle: o.WallAngle = None,
    repair_margin: RepairMargin = None,
    jobs: o.Jobs = 1,
) -> int:
    """Make grids by elliptic equations, a variational method, or marching from the wall."""
    from functools import partial

    from meshonet_cli import layers as layer
    from meshonet_cli import walls as wall
    from meshonet_cli.batch import Destination
    from meshonet_cli.gates import parse_gates
    from meshonet_cli.gridding import Recipe, initial_grid, make_grids
    from meshonet_cli.solving import at_any_resolution, given, solver_of

    layers = layer.read_layers(first, sampling.res)
    edges = wall.read_edges(sides, first, sampling.res, layers, slide, wall_angle)
    settings = given(tol=o.tolerance(tol), max_cycles=max_cycles, initial=initial_grid(initial))
    solver = partial(solver_of(method), **settings)
    recipe = Recipe(
        sampling.settings(spacing=layer.spacing_along(layers, sampling.spacing), viscous=layers is not None),
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
        checks.allow_invalid,
        parse_gates(checks.fail_on),
        checks.repair is not False,
        margin=repair_margin,
        refine=refine,
        history=history,
    )
    destination = Destination(output, files.to_format, "grids")
    return make_grids(
        boundary, recipe, destination, printing.session(),
        fmt=files.from_format, skip_existing=files.skip_existing, jobs=jobs,
    )  # fmt: skip
