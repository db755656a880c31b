"""``meshonet quality``."""

from typing import Annotated, Literal

from meshonet_cli import options as o

EXAMPLES = (
    "meshonet quality grid.vts",
    "meshonet quality grid.vts --fail-on 'max_angle>179' --fail-on 'folded>0' --json",
    "meshonet quality grid.vts --profile openfoam",
    "meshonet quality grid.vts --profile openfoam --html report.html",
    "meshonet quality grid.vts --per-cell metrics.vts",
    "meshonet quality grid.vts --compare other.vts",
    "meshonet quality grids/*.vts --compare grid.vts --summary --fail-on 'relative_l2>0.01'",
)
_check, _output = o.option_of(o.CHECKS), o.option_of(o.IO)


# fmt: off
def quality(
    grid: o.Grids,
    run: o.InputOptions,
    gates: o.GateOptions,
    plot: Annotated[str | None, _output(
        "--plot", metavar="F.png", help="Draw the grid, coloured by max_angle.",
    )] = None,
    html: Annotated[str | None, _output(
        "--html", metavar="F.html",
        help="Write a report as one page, with pictures, histograms, worst places, and what --fail-on and "
        "--profile find; of more than 20 grids the worst are shown.",
    )] = None,
    per_cell: Annotated[str | None, _output(
        "--per-cell", metavar="F.vts", help="Write every metric of every cell; of many blocks to an F.vtm.",
    )] = None,
    compare: Annotated[str | None, _check(
        "--compare", metavar="OTHER",
        help="Reference grids of the same sizes: prints the relative L2 distance, the distance near walls, "
        "the largest one and that of the boundary, folded cells, and ratios of angles.",
    )] = None,
    pair: Annotated[Literal["auto", "name", "order"] | None, _check(
        "--pair", metavar="auto|name|order",
        help="How grids are matched with those of --compare. auto: a single reference serves every grid; "
        "several are matched by name where they have names, else by order. [default: auto]",
    )] = None,
    summary: Annotated[bool, _output(
        "--summary", help="One table (or JSON object) over all grids, a row each.",
    )] = False,
    from_format: o.From = None,
    threads: o.Threads = None,
) -> int:
    """Measure grids: folded cells, angles, skewness."""
    from meshonet.geometry.quality.report import COMPARED
    from meshonet.geometry.threads import limited_to
    from meshonet_cli.tasks.qualities import measure_grids

    o.only_with("compare", compare is not None, pair=pair)
    with limited_to(threads):
        return measure_grids(
            run.inputs(grid, grids=True), run.session(),
            fmt=from_format, criteria=gates.criteria(COMPARED if compare else ()), compare=compare,
            pairing=pair or "auto", summary=summary, plot=plot, html=html, per_cell=per_cell,
        )
# fmt: on
