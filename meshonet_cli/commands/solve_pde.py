"""``meshonet solve-pde``."""

from typing import TYPE_CHECKING, Annotated, Literal, TypeAlias

from meshonet.solvers.pipeline.methods import METHODS
from meshonet_cli import options as o
from meshonet_cli.terminal.errors import with_options

EXAMPLES = (
    "meshonet solve-pde duct.csv --res 80x40 -o duct.vts",
    "meshonet solve-pde naca:2412 --res 200 --tol 1e-8 --history cycles.csv -o naca2412.vts",
    "meshonet solve-pde duct.csv --res 400 --coarse 65 -o fine.vts",
    "meshonet solve-pde duct.csv --method thomas-middlecoff --spacing tanh -o layers.vts",
    "meshonet solve-pde duct.csv --res 25x13 --refine 3 -o finest.vts",
    "meshonet solve-pde duct.csv --method variational --res 129 -o best.vts",
    "meshonet solve-pde duct.csv --method steger-sorenson --spacing-south 1e-3 -o upright.vts",
    "meshonet solve-pde duct.csv --res 200x80 --first-cell 1e-4 --slide -o channel.vts",
    "meshonet solve-pde box.xyz --method variational --energy shape -o cubes.vts",
    "meshonet solve-pde airfoil.dat --res 250x100 --y-plus 1 --reynolds 6e6 -o viscous.vts",
)

_option = o.option_of(o.METHOD)

AUTO = (
    "hyperbolic around bodies with a first cell and for C grids (whose first cell it chooses if none is "
    "given), unless {coarse}, {refine}, {tol}, {max_cycles} or {initial} is given; else winslow"
)
SOLVERS = {name: row.summary for name, row in METHODS.items() if row.solves} | {"auto": AUTO}
if TYPE_CHECKING:
    MethodName: TypeAlias = str
else:
    MethodName = Literal[tuple(SOLVERS)]


# fmt: off
def solve_pde(
    boundary: o.Boundaries,
    grids: o.GridOptions,
    sides: o.SideOptions,
    domain: o.DomainOptions,
    volume: o.VolumeOptions,
    blocks: o.BlocksName = "auto",
    method: Annotated[MethodName, _option(
        "--method", metavar="|".join(SOLVERS), show_default=True,
        help=with_options(" ".join(f"{name}: {text}." for name, text in SOLVERS.items())),
    )] = "auto",
    tol: Annotated[float | None, _option(
        "--tol", metavar="T",
        help="Stop at this residual, relative to that of the interpolated start (variational: stop when no "
        "node moves by more than about T times the square root of the domain's area). [default: where more "
        "cycles would change the grid by less than its discretisation error]",
    )] = None,
    max_cycles: Annotated[int | None, _option(
        "--max-cycles", metavar="N", min=1,
        help="Multigrid cycles (variational: iterations at full resolution) at the most. [default: 30 (200)]",
    )] = None,
    coarse: Annotated[str, _option(
        "--coarse", metavar="auto|off|N", show_default=True,
        help="Solve on N x N nodes and interpolate to --res by splines. auto does so for quads and C grids "
        "of more than 512 nodes a side with winslow (N is then 257) and of more than 257 with variational "
        "(129), where the quality measures the same; not with --tol, --max-cycles or --initial.",
    )] = "auto",
    refine: o.Refine = 0,
    initial: Annotated[str | None, _option("--initial", metavar="GRID", help="Grid to start from.")] = None,
    history: Annotated[str | None, o.option_of(o.IO)(
        "--history", metavar="F.csv",
        help="Write residual, change, seconds, folded cells and functional of every cycle to F.csv.",
    )] = None,
    slide: o.Slide = None,
    wall_angle: o.WallAngle = None,
    repair_margin: Annotated[int | None, o.option_of(o.CHECKS)(
        "--repair-margin", metavar="CELLS", min=2, max=24,
        help="Width of the band of cells around folded ones that moves when they are unfolded; 12 is slower "
        "and smoother. [default: 6, more where that is not enough]",
    )] = None,
) -> int:
    """Make grids by elliptic equations, a variational method, or marching.

    In space, six faces (of a grid, or six patches that enclose a volume) are filled, volumes are marched
    from the patches of a surface by --method hyperbolic, and several blocks are smoothed across their
    interfaces.
    """
    from meshonet_cli.tasks.grids import initial_grid, write_grids

    request = grids.request(
        method, {"tol": tol, "max_cycles": max_cycles}, sides, volume, coarse=o.coarse_nodes(coarse),
        refine=refine, initial=initial_grid(initial), history=history is not None, slide=slide,
        wall_angle=wall_angle, repair_margin=repair_margin, blocks=blocks, **domain.parameters(),
    )
    batch, criteria = grids.batch(grids.inputs(boundary), grids), grids.criteria()
    return write_grids(batch, request, criteria, history=history, assemble=domain.assemble)
# fmt: on
