"""``meshonet tfi``."""

from typing import TYPE_CHECKING, Literal, TypeAlias

from meshonet.solvers.pipeline.methods import METHODS
from meshonet_cli import options as o

EXAMPLES = (
    "meshonet tfi duct.csv --res 80x40 -o duct.vts",
    "meshonet tfi duct.csv --res 80x40 --spacing-south 1e-3 --growth 1.5 -o layers.vts",
    "meshonet sample-boundary naca:2412 -o - | meshonet tfi - -o - | meshonet quality -",
)
BlendingName = Literal["arclength", "linear"]
ALGEBRAIC = {name: row.summary for name, row in METHODS.items() if row.algebraic}
if TYPE_CHECKING:
    MethodName: TypeAlias = str
else:
    MethodName = Literal[tuple(ALGEBRAIC)]
_option = o.option_of(o.METHOD)


# fmt: off
def tfi(
    boundary: o.Boundaries,
    grids: o.GridOptions,
    sampling: o.SamplingOptions,
    boundary_layer: o.LayerOptions,
    checks: o.CheckOptions,
    sides: o.SideOptions,
    method: MethodName = _option(
        default="tfi", help=" ".join(map("{}: {}.".format, ALGEBRAIC, ALGEBRAIC.values())),
    ),
    blending: BlendingName | None = _option(
        metavar="arclength|linear", help="Variable of the blending functions. arclength: relative "
        "arc length along the edges. linear: node index. [default: arclength]",
    ),
) -> int:
    """Make grids by transfinite interpolation."""
    from meshonet_cli.tasks.grids import write_grids

    request = grids.request(method, {"blending": blending}, sampling, boundary_layer, checks, sides)
    batch = grids.batch(grids.inputs(boundary), grids)
    return write_grids(batch, request, grids.criteria(grids.leave_out_failed))
# fmt: on
