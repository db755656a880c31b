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


@o.expanded
def tfi(
    boundary: o.Boundaries,
    output: o.Output,
    sampling: o.SamplingOptions,
    first: o.LayerOptions,
    sides: o.SideOptions,
    checks: o.CheckOptions,
    files: o.FileOptions,
    printing: o.PrintOptions,
    blending: Annotated[
        BlendingName,
        _option(
            "--blending",
            metavar="arclength|linear",
            show_default=True,
            help="Blend the edges by their arc length, or linearly by index.",
        ),
    ] = "arclength",
    jobs: o.Jobs = 1,
) -> int:
    """Make grids by transfinite interpolation."""
    from functools import partial

    from meshonet_cli import layers as layer
    from meshonet_cli import walls as wall
    from meshonet_cli.batch import Destination
    from meshonet_cli.gates import parse_gates
    from meshonet_cli.gridding import Recipe, interpolated, make_grids

    layers = layer.read_layers(first, sampling.res)
    edges = wall.read_edges(sides, first, sampling.res, layers)
    recipe = Recipe(
        sampling.settings(),
        wall.WithWalls("tfi", partial(interpolated, blending=blending), layers, edges),
        checks.allow_invalid,
        parse_gates(checks.fail_on),
        bool(checks.repair),
    )
    destination = Destination(output, files.to_format, "grids")
    return make_grids(
        boundary, recipe, destination, printing.session(),
        fmt=files.from_format, skip_existing=files.skip_existing, jobs=jobs,
    )  # fmt: skip
