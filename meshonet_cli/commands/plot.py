"""``meshonet plot``."""

from typing import Annotated

from meshonet_cli import options as o

EXAMPLES = (
    "meshonet plot grid.vts -o grid.png",
    "meshonet plot grid.vts --zoom 0.9,1.1,-0.1,0.1 --every 1 --metric skewness -o edge.svg",
)
_option, _output = o.option_of(o.METHOD), o.option_of(o.IO)


# fmt: off
@o.expanded
def plot(
    grid: o.Grids,
    output: Annotated[str, _output(
        "-o", "--output", metavar="PICTURE",
        help="Picture to write, .png, .svg or .pdf, or - for standard output. For several inputs: "
        "'dir/{stem}.png' (also {name}, {index}).",
    )],
    printing: o.PrintOptions,
    metric: Annotated[str, _option(
        "--metric", metavar="METRIC", show_default=True,
        help="Colour the cells by this metric; none draws lines only.",
    )] = "max_angle",
    zoom: Annotated[str | None, _option("--zoom", metavar="x0,x1,y0,y1", help="Show this part only.")] = None,
    every: Annotated[int | None, _option(
        "--every", metavar="K",
        help="Draw every K-th grid line. [default: as many as can be distinguished]",
    )] = None,
    from_format: o.From = None,
    to_format: Annotated[str | None, _output(
        "--to", metavar="FORMAT",
        help="png, svg or pdf, when the ending does not say. [default on standard output: png]",
    )] = None,
    skip_existing: o.SkipExisting = False,
) -> int:
    """Draw grids, coloured by a quality metric."""
    from meshonet.formats.figure.picture import Picture
    from meshonet_cli.plot_batch import plot_grids

    picture = Picture(None if metric == "none" else metric, _box(zoom), every)
    return plot_grids(
        grid, output, picture, printing.session(),
        from_format=from_format, to_format=to_format, skip_existing=skip_existing,
    )
# fmt: on


def _box(text: str | None) -> tuple[float, float, float, float] | None:
    """Return the box ``x0,x1,y0,y1``."""
    if text is None:
        return None
    try:
        x0, x1, y0, y1 = (float(word) for word in text.split(","))
    except ValueError:
        from meshonet.geometry.errors import InputError

        raise InputError(f"{text!r} is not a box", "use x0,x1,y0,y1", parameter="zoom") from None
    return x0, x1, y0, y1
