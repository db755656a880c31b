"""``meshonet solve-pde``."""

from typing import TYPE_CHECKING, Literal, TypeAlias

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
    "hyperbolic outside a body or surface if a first-cell height is given, and in all other C grids unless "
    "{coarse}, {refine}, {tol}, {max_cycles} or {initial} is given. Multi-block grids and six faces: "
    "variational. Else winslow"
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
    sampling: o.SamplingOptions,
    boundary_layer: o.LayerOptions,
    checks: o.CheckOptions,
    sides: o.SideOptions,
    domain: o.DomainOptions,
    volume: o.VolumeOptions,
    blocks: o.BlocksName = "auto",
    method: MethodName = _option(
        default="auto", help=with_options(" ".join(map("{}: {}.".format, SOLVERS, SOLVERS.values()))),
    ),
    tol: float | None = _option(
        metavar="T", help="Stop when the residual is below T times the residual of transfinite "
        "interpolation. The variational method stops when no node moves by more than about T times the "
        "square root of the area. [default: stop when the iteration error is below the discretisation error]",
    ),
    max_cycles: int | None = _option(
        metavar="N", min=1, help="Largest number of multigrid cycles, or of iterations of the variational "
        "method. [default: 30 cycles; 200 iterations]",
    ),
    coarse: str = _option(
        default="auto", metavar="auto|off|N", help="Solve on at most N x N nodes and interpolate to --res by "
        "splines. off: solve on all nodes. auto: off with --tol, --max-cycles or --initial; in four-sided "
        "domains N = 257 for winslow if a side has more than 512 nodes, and N = 129 for variational if a "
        "side has more than 257; otherwise off.",
    ),
    refine: o.Refine = 0,
    initial: str | None = _option(
        metavar="GRID", help="File with the grid from which the iteration starts. [default: transfinite "
        "interpolation]",
    ),
    history: str | None = o.option_of(o.IO)(
        metavar="F.csv", help="Write a CSV file with a row for each cycle: residual, displacement of nodes, "
        "seconds, folded cells and functional.",
    ),
    slide: o.Slide = None,
    wall_angle: o.WallAngle = None,
    repair_margin: int | None = o.option_of(o.CHECKS)(
        metavar="CELLS", min=2, max=24, help="Width, in cells, of the region around folded cells in which "
        "the repair moves nodes. [default: 6, and more if cells stay folded]",
    ),
) -> int:
    """Make elliptic, variational or marched grids.

    Six surface patches, or the faces of a volume grid, are filled with a volume grid. With a first-cell
    height, cells are marched outwards from a surface. Multi-block grids are smoothed across interfaces.
    """
    from meshonet_cli.tasks.grids import initial_grid, write_grids

    request = grids.request(
        method, {"tol": tol, "max_cycles": max_cycles}, sampling, boundary_layer, checks, sides, volume,
        coarse=o.coarse_nodes(coarse), refine=refine, initial=initial_grid(initial),
        history=history is not None, slide=slide, wall_angle=wall_angle, repair_margin=repair_margin,
        blocks=blocks, **domain.parameters(),
    )
    batch, criteria = grids.batch(grids.inputs(boundary), grids), grids.criteria(grids.leave_out_failed)
    return write_grids(batch, request, criteria, history=history, assemble=domain.assemble)
# fmt: on
