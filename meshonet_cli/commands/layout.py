"""``meshonet layout``."""

from dataclasses import dataclass
from typing import Annotated

import typer

from meshonet_cli import options as o
from meshonet_cli.batch.settings import Files

EXAMPLES = (
    "meshonet layout plate.geojson -o plate.json",
    "meshonet layout main.dat flap.dat --assemble --far-field 20 -o wing.json",
    "meshonet layout main.dat flap.dat --assemble --first-cell 1e-5 -o layers.json",
    "meshonet infer plate.geojson --layout plate.json --cells 10000 -o plate.cgns",
    "meshonet plot plate.json -o blocks.png",
)
_sampling = o.option_of(o.SAMPLING)


# fmt: off
@dataclass(frozen=True, kw_only=True)
class LayoutFiles(Files):
    """Options for the files of block layouts."""

    output: Annotated[str, o.option_of(o.IO)(
        "-o", "--output", metavar="LAYOUT.json", help="File to write, or - for standard output. For several "
        "inputs: a pattern such as 'dir/{stem}.json', with {stem} for the name of the input file, {name} for "
        "that of the shape, or {index} (from 0).",
    )]
    from_format: o.From = None
    skip_existing: o.SkipExisting = False


def layout(
    domain: Annotated[list[str], typer.Argument(
        metavar="DOMAIN", show_default=False,
        help="File with a domain (WKT, GeoJSON, points of closed curves, DXF, or the boundary of a mesh) or "
        "an airfoil; a designation such as naca:2412; or - for standard input.",
    )],
    files: LayoutFiles,
    blocks: o.BlockOptions,
    run: o.RunOptions,
    far_field: float | None = _sampling(
        metavar="R", help="Distance of the far field from the middle of all bodies, divided by the largest "
        "extent of all bodies together. [default: 15]",
    ),
    first_cell: o.FirstCell = None, y_plus: o.YPlusAtWalls = None, reynolds: o.Reynolds = None,
    length: o.Length = None,
) -> int:
    """Split domains into blocks and write the block layout.

    If a first-cell height is given, the layout has only the blocks outside the boundary layers. The blocks of
    the layers are added by meshonet infer or meshonet solve-pde.
    """
    from meshonet_cli.tasks.layouts import write_layouts

    first = {
        "first_cell": o.at_walls(first_cell, "first_cell"), "y_plus": o.at_walls(y_plus, "y_plus"),
        "reynolds": reynolds, "length": length,
    }
    return write_layouts(
        run.batch(run.inputs(domain), files), blocks.parameters() | first, far_field,
        assemble=blocks.assemble,
    )
# fmt: on
