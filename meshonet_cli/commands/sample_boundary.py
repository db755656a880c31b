"""``meshonet sample-boundary``."""

from typing import Annotated

import typer

from meshonet_cli import options as o

EXAMPLES = (
    "meshonet sample-boundary airfoil.dat --res 200x100 --te-spacing 0.001 -o boundary.h5",
    "meshonet sample-boundary --family wrench --count 8 --seed 1 -o wrenches.h5",
    "meshonet sample-boundary naca:2412 -o - | meshonet tfi - -o - | meshonet quality -",
)

# fmt: off
Source = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="SOURCE", show_default=False,
        help="File with a boundary (airfoil, points, dataset, grid), naca:2412, or - for standard input. "
        "None with --family.",
    ),
]
FamilyName = Annotated[
    str | None,
    typer.Option(
        "--family", metavar="NAME", show_default=False,
        help="Draw from a family instead: arch, hexagon, wrench, semicircle, airfoil, hole (the six of "
        "the paper), procedural (random airfoils), four-sided (random quads) or bodies (random bodies in "
        "far fields). 101x101 nodes unless --res says otherwise.",
    ),
]
Count = Annotated[int, typer.Option("--count", metavar="N", min=1, help="Members of the family.")]
Range = Annotated[
    str | None,
    typer.Option(
        "--range", metavar="A:B", show_default=False,
        help="Range that the family's parameter is drawn from. [default: the paper's]",
    ),
]
Sensors = Annotated[
    int | None,
    typer.Option(
        "--sensors", metavar="M", min=2, show_default=False,
        help="Also keep M boundary nodes as sensors (dataset sensors of an .h5 file).",
    ),
]
Split = Annotated[
    str | None,
    typer.Option(
        "--split", metavar="HOW", show_default=False,
        help="Keep a sixth of the family for tests: interpolation (the middle of the range), extrapolation "
        "(one end of it) or random. Kept in an .h5 file: train honours it, and FILE.h5#test reads it.",
    ),
]
Seed = Annotated[int, typer.Option("--seed", metavar="S", min=0, help="Seed of the draw.")]
# fmt: on


def sample_boundary(
    output: o.Output,
    source: Source = None,
    res: o.Resolution = None,
    family: FamilyName = None,
    count: Count = 1,
    spread: Range = None,
    seed: Seed = 0,
    split: Split = None,
    sensors: Sensors = None,
    topology: o.TopologyOption = "auto",
    spacing: o.SpacingOption = "auto",
    le_spacing: o.LeSpacing = None,
    te_spacing: o.TeSpacing = None,
    te: o.TrailingEdge = "auto",
    far_field: o.FarField = None,
    wake: o.Wake = None,
    wake_nodes: o.WakeNodes = None,
    corners: o.Corners = "auto",
    normalise: o.Normalise = False,
    from_format: o.From = None,
    to_format: o.To = None,
    skip_existing: o.SkipExisting = False,
    jobs: o.Jobs = 1,
    as_json: o.AsJson = False,
    quiet: o.Quiet = False,
    debug: o.Debug = False,
) -> int:
    """Turn geometry into boundaries of four edges."""
    from meshonet_cli.bounding import from_family, from_files, sample
    from meshonet_cli.session import Session

    o.either(source, family)
    drawn = {"range": spread, "split": split, "count": None if count == 1 else count, "seed": seed or None}
    o.only_with("--family", family is not None, **drawn)
    lengths = {"le_spacing": le_spacing, "te_spacing": te_spacing, "far_field": far_field, "te": te}
    lengths |= {"wake": wake, "wake_nodes": wake_nodes}
    sampling = o.sampling(res, topology, spacing, corners, normalise=normalise, **lengths)
    session = Session(quiet=quiet, as_json=as_json, debug=debug)
    if family is not None:
        found, destination = from_family((family, count, spread, seed, split), output, to_format, session)
    else:
        found, destination = from_files(source or [], output, to_format, session, from_format)
    return sample(
        found, sampling, destination, session, sensors=sensors, skip_existing=skip_existing, jobs=jobs
    )
