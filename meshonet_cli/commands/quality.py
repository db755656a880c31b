"""``meshonet quality``."""

from typing import Literal

from meshonet_cli import options as o

EXAMPLES = (
    "meshonet quality grid.vts",
    "meshonet quality grid.vts --fail-on 'max_angle>179' --fail-on 'folded>0' --json",
    "meshonet quality grid.vts --profile openfoam",
    "meshonet quality grid.vts --profile openfoam --html report.html",
    "meshonet quality grid.vts --per-cell metrics.vts",
    "meshonet quality grid.vts --reynolds 6e6 --length 1",
    "meshonet quality grid.vts --compare other.vts",
    "meshonet quality grids/*.vts --compare grid.vts --summary --fail-on 'relative_l2>0.01'",
)
_check, _output = o.option_of(o.CHECKS), o.option_of(o.IO)


# fmt: off
def quality(
    grid: o.Grids,
    run: o.InputOptions,
    gates: o.GateOptions,
    plot: str | None = _output(
        metavar="F.png", help="Draw the grid, coloured by max_angle, into this picture. For several grids: a "
        "pattern such as '{stem}.png'.",
    ),
    html: str | None = _output(
        metavar="F.html", help="Write a report page with pictures, histograms, the worst cells, and the "
        "results of --fail-on and --profile. It shows at most the 20 worst grids.",
    ),
    per_cell: str | None = _output(
        metavar="F.vts", help="Write all metrics of every cell into this file: .vts, or .vtm for a "
        "multi-block grid.",
    ),
    compare: str | None = _check(
        metavar="OTHER", help="File with reference grids of the same size. The report then gives the "
        "distances of nodes from the reference, the folded cells of the reference, and maximum and mean of "
        "max_angle divided by those of the reference.",
    ),
    pair: Literal["auto", "name", "order"] | None = _check(
        help="Rule that assigns grids to the references of --compare. name: equal names. order: first to "
        "first, and so on. auto: a single reference for all grids; several by name if the names agree, else "
        "by order. [default: auto]",
    ),
    reynolds: float | None = _check(
        metavar="RE", help="Reynolds number, based on --length. The report then gives y+ of the first cells "
        "at each wall, as on a turbulent flat plate. --fail-on 'y_plus>2' tests the largest y+. [default: "
        "no y+]",
    ),
    length: float | None = _check(
        metavar="L", help="Reference length of --reynolds, in the unit of the grid. [default: 1]",
    ),
    summary: bool = _output(
        default=False, help="Print one table with a row for each grid; with --json one object.",
    ),
    from_format: o.From = None,
    threads: o.Threads = None,
) -> int:
    """Measure quality: folded cells, angles, growth."""
    from meshonet.geometry.quality.report import COMPARED, Y_PLUS
    from meshonet.geometry.threads import limited_to
    from meshonet_cli.tasks.qualities import measure_grids

    o.only_with("compare", compare is not None, pair=pair)
    o.only_with("reynolds", reynolds is not None, length=length)
    names = (*(COMPARED if compare else ()), *((Y_PLUS,) if reynolds else ()))
    with limited_to(threads):
        return measure_grids(
            run.inputs(grid, grids=True), run.session(),
            fmt=from_format, criteria=gates.criteria(more=names), compare=compare,
            pairing=pair or "auto", summary=summary, plot=plot, html=html, per_cell=per_cell,
            reynolds=reynolds, length=length,
        )
# fmt: on
