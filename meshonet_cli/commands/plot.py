"""``meshonet plot``."""

from dataclasses import dataclass
from typing import Annotated

from meshonet_cli import options as o
from meshonet_cli.batch.settings import Files

EXAMPLES = (
    "meshonet plot grid.vts -o grid.png",
    "meshonet plot grid.vts --zoom 0.9,1.1,-0.1,0.1 --every 1 --metric skewness -o edge.svg",
    "meshonet plot wing.cgns --slice y=.5 -o slice.png",
    "meshonet plot rotor.cgns --span .1,.5,.9 -o sections.png",
    "meshonet plot wing.cgns -o wing.html",
)
# descriptions, remedies and parameters for errors
_BOX = ("a box", "use x0,x1,y0,y1", "zoom")
_DIRECTION = ("a direction", "use azimuth and elevation in degrees, e.g. -125,25", "seen_from")
_SPANS = ("parts of the span", "use numbers between 0 and 1, e.g. .1,.5,.9", "span")
_option, _output = o.option_of(o.METHOD), o.option_of(o.IO)


# fmt: off
@dataclass(frozen=True, kw_only=True)
class PictureFiles(Files):
    """Options for the files of pictures."""

    output: Annotated[str, _output(
        "-o", "--output", metavar="PICTURE", help="Picture (.png, .svg or .pdf) or interactive page (.html) "
        "to write, or - for standard output. For several inputs: a pattern such as 'dir/{stem}.png', with "
        "{stem} for the name of the input file, {name} for that of the shape, or {index} (from 0).",
    )]
    to_format: str | None = _output(
        metavar="FORMAT", help="Format of the picture: png, svg, pdf or html. [default: from the extension; "
        "png on standard output]",
    )
    from_format: o.From = None
    skip_existing: o.SkipExisting = False


def plot(
    grid: o.Grids,
    files: PictureFiles,
    run: o.InputOptions,
    metric: str = _option(
        default="max_angle", metavar="METRIC", help="Metric that colours the cells: a metric of cells in the "
        "report of meshonet quality, or growth, non_orthogonality, face_skewness or box_ratio. none: grid "
        "lines only.",
    ),
    zoom: str | None = _option(
        metavar="x0,x1,y0,y1", help="Show only this region of a planar grid; in space give "
        "x0,x1,y0,y1,z0,z1. For a --slice, four numbers may limit its two axes instead: y0,y1,z0,z1 in the "
        "plane x=2.9. [default: the whole grid]",
    ),
    slice_: str | None = _option(
        "--slice", metavar="SLICE", help="Draw this slice of a volume: a grid surface such as i=10 or k=-1 "
        "(the last), or a plane such as x=.5. [default: the walls, not a slice; without walls the whole "
        "boundary]",
    ),
    span: str | None = _option(
        metavar="S,...", help="Draw sections of a blade row side by side, at these fractions of the span, "
        "from 0 (hub) to 1 (shroud).",
    ),
    meridional: bool = _option(
        default=False, help="Draw the meridional section of a blade row, in the coordinates x and r: the "
        "cells cut by a half-plane through the axis and the blade.",
    ),
    seen_from: str | None = _option(
        metavar="AZIMUTH,ELEVATION", help="Direction from which volumes and surfaces are seen: azimuth and "
        "elevation in degrees. [default: -125,25]",
    ),
    up: str | None = _option(
        metavar="AXIS", help="Axis that points upwards in pictures of volumes and surfaces: x, y or z. "
        "Azimuths count from y if x is up, from z if y is up, and from x if z is up. [default: z]",
    ),
    every: int | None = _option(
        metavar="K", help="Draw every K-th grid line. [default: as many lines as can be distinguished]",
    ),
) -> int:
    """Draw grids, coloured by a quality metric."""
    from meshonet.formats.figure.picture import Picture
    from meshonet_cli.tasks.pictures import plot_grids

    box, direction = o.numbers(zoom, (4, 6), *_BOX), o.numbers(seen_from, (2,), *_DIRECTION)
    spans = o.numbers(span, tuple(range(1, 10)), *_SPANS) or ()
    colours = None if metric == "none" else metric
    picture = Picture(box, every, slice_, direction, up, spans, meridional, colours)
    return plot_grids(run.batch(run.inputs(grid, grids=True), files), picture)
# fmt: on
