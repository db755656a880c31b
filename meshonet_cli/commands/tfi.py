"""``meshonet tfi``."""

from typing import Annotated, Literal

from meshonet_cli import options as o

EXAMPLES = (
    "meshonet tfi duct.csv --res 80x40 -o duct.vts",
    "meshonet tfi duct.csv --res 80x40 --spacing-south 1e-3 --growth 1.5 -o layers.vts",
    "meshonet sample-boundary naca:2412 -o - | meshonet tfi - -o - | meshonet quality -",
)
BlendingName = Literal["arclength", "linear"]
_option = o.option_of(o.METHOD)


# fmt: off
@o.expanded
def tfi(
    boundary: o.Boundaries,
    many: o.InputOptions,
    output: o.Output,
    sampling: o.SamplingOptions,
    first: o.LayerOptions,
    sides: o.SideOptions,
    checks: o.CheckOptions,
    gates: o.GateOptions,
    files: o.FileOptions,
    printing: o.PrintOptions,
    workers: o.EngineOptions,
    blending: Annotated[BlendingName, _option(
        "--blending", metavar="arclength|linear", show_default=True,
        help="Blend the edges by their arc length, or linearly by index.",
    )] = "arclength",
    threads: o.Threads = None,
) -> int:
    """Make grids by transfinite interpolation."""
    from meshonet_cli.grid_batch import request_of, write_grids

    criteria = gates.criteria()
    request = request_of(
        "tfi", sampling, checks, criteria, first, sides, settings={"blending": blending}, threads=threads
    )
    return write_grids(
        many.of(boundary), output, request, criteria, files, printing.session(), engine=workers.chosen()
    )
# fmt: on
