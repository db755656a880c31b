"""``meshonet quality``."""

from typing import Annotated, Literal

import typer

from meshonet_cli import options as o

EXAMPLES = (
    "meshonet quality grid.vts",
    "meshonet quality grid.vts --fail-on 'max_angle>179' --fail-on 'folded>0' --json",
    "meshonet quality grid.vts --profile openfoam",
    "meshonet quality grid.vts --per-cell metrics.vts",
    "meshonet quality grid.vts --compare other.vts",
    "meshonet quality grids/*.vts --compare grid.vts --summary --fail-on 'relative_l2>0.01'",
)


# fmt: off
def quality(
    grid: o.Grids,
    fail_on: o.FailOn = None,
    profile: Annotated[
        Literal["openfoam", "pointwise", "verdict", "viscous"] | None,
        typer.Option(
            "--profile", metavar="openfoam|pointwise|verdict|viscous", show_default=False,
            help="Judge by the thresholds of others: each one, the figure, and pass, warning or FAIL; "
            "exit with 1 when one fails. See docs/quality.md.",
        ),
    ] = None,
    plot: Annotated[
        str | None,
        typer.Option("--plot", metavar="F.png", show_default=False, help="Draw it, coloured by max_angle."),
    ] = None,
    per_cell: Annotated[
        str | None,
        typer.Option("--per-cell", metavar="F.vts", show_default=False, help="Write every cell's metrics."),
    ] = None,
    other: Annotated[
        str | None,
        typer.Option(
            "--compare", metavar="OTHER", show_default=False,
            help="Reference grids of the same sizes: relative L2, near-wall, largest and boundary distance, "
            "folds, ratios of angles.",
        ),
    ] = None,
    pair: Annotated[
        Literal["auto", "name", "order"] | None,
        typer.Option(
            "--pair", metavar="auto|name|order", show_default=False,
            help="Which grid of OTHER goes with which: auto takes the only one for each, goes by names where "
            "they are known, else by order. [default: auto]",
        ),
    ] = None,
    summary: Annotated[
        bool, typer.Option("--summary", help="One table (or JSON object) over all grids, a row each.")
    ] = False,
    from_format: o.From = None,
    as_json: o.AsJson = False,
    quiet: o.Quiet = False,
    debug: o.Debug = False,
) -> int:
    """Measure grids: folded cells, angles, skewness."""
    from meshonet_cli.drawing import Picture, metrics_file, picture_file
    from meshonet_cli.gates import parse_gates
    from meshonet_cli.grading import COMPARED, grade_grids
    from meshonet_cli.session import Session

    o.only_with("--compare", other is not None, pair=pair)
    session = Session(quiet=quiet, as_json=as_json, debug=debug)
    outputs = [picture_file(plot, None, Picture())] if plot else []
    outputs += [metrics_file(per_cell)] if per_cell else []
    return grade_grids(
        grid, session, parse_gates(fail_on, COMPARED if other else ()),
        fmt=from_format, other=other, pairing=pair or "auto", profile=profile, summary=summary,
        outputs=outputs,
    )
# fmt: on
