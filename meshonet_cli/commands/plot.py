"""``meshonet plot``."""

from typing import Annotated

import typer

from meshonet_cli import options as o

EXAMPLES = (
    "meshonet plot grid.vts -o grid.png",
    "meshonet plot grid.vts --zoom 0.9,1.1,-0.1,0.1 --every 1 --metric skewness -o edge.svg",
)


# fmt: off
def plot(
    grid: o.Grids,
    output: Annotated[
        str,
        typer.Option(
            "-o", "--output", metavar="PICTURE", show_default=False,
            help="Picture to write, .png, .svg or .pdf, or - for standard output. For several inputs: "
            "'dir/{stem}.png' (also {name}, {index}).",
        ),
    ],
    metric: Annotated[
        str, typer.Option("--metric", metavar="METRIC", help="Colour the cells by it; none draws lines only.")
    ] = "max_angle",
    zoom: Annotated[
        str | None,
        typer.Option("--zoom", metavar="x0,x1,y0,y1", show_default=False, help="Show this part only."),
    ] = None,
    every: Annotated[
        int | None,
        typer.Option(
            "--every", metavar="K", show_default=False,
            help="Draw every K-th grid line. [default: as many as can be told apart]",
        ),
    ] = None,
    from_format: o.From = None,
    to_format: Annotated[
        str | None,
        typer.Option(
            "--to", metavar="FORMAT", show_default=False,
            help="png, svg or pdf, when the ending does not say. Standard output is png unless told.",
        ),
    ] = None,
    skip_existing: o.SkipExisting = False,
    as_json: o.AsJson = False,
    quiet: o.Quiet = False,
    debug: o.Debug = False,
) -> int:
    """Draw grids, coloured by a quality metric."""
    from meshonet_cli.drawing import Picture, metric_named, picture_file, zoom_box
    from meshonet_cli.plotting import plot_grids
    from meshonet_cli.session import Session

    session = Session(quiet=quiet, as_json=as_json, debug=debug)
    picture = Picture(metric_named(metric), zoom_box(zoom), every)
    destination = picture_file(output, to_format, picture)
    return plot_grids(
        grid, destination, picture.metric, session, fmt=from_format, skip_existing=skip_existing
    )
# fmt: on
