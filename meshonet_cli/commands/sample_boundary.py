"""``meshonet sample-boundary``."""

from typing import Annotated

import typer

from meshonet_cli import options as o

EXAMPLES = (
    "meshonet sample-boundary airfoil.dat --res 200x100 --te-spacing 0.001 -o boundary.h5",
    "meshonet sample-boundary --family wrench --count 8 --seed 1 -o wrenches.h5",
    "meshonet sample-boundary naca:2412 -o - | meshonet tfi - -o - | meshonet quality -",
)

_option = o.option_of(o.SAMPLING)


# fmt: off
def sample_boundary(
    sampling: o.SamplingOptions,
    files: o.FileOptions,
    run: o.RunOptions,
    source: Annotated[list[str] | None, typer.Argument(
        metavar="SOURCE", show_default=False,
        help="File with a boundary (airfoil, points, dataset, grid), naca:2412, or - for standard input; a "
        "folder or .zip of them, or @FILE, a list of them. None with --family.",
    )] = None,
    family: Annotated[str | None, _option(
        "--family", metavar="NAME",
        help="Draw from a family instead: arch, hexagon, wrench, semicircle, airfoil, hole (the six of the "
        "paper), procedural (random airfoils), four-sided (random quads) or bodies (random bodies in far "
        "fields). 101x101 nodes unless --res says otherwise.",
    )] = None,
    count: Annotated[int | None, _option(
        "--count", metavar="N", min=1, help="Number of members to draw of the family. [default: 1]",
    )] = None,
    spread: Annotated[str | None, _option(
        "--range", metavar="A:B", help="Range that the family's parameter is drawn from. [default: the "
        "paper's]",
    )] = None,
    seed: Annotated[int | None, _option(
        "--seed", metavar="S", min=0, help="Seed of the draw. [default: 0]",
    )] = None,
    split: Annotated[str | None, _option(
        "--split", metavar="HOW",
        help="Keep a sixth of the family for tests: interpolation (the middle of the range), extrapolation "
        "(one end of it) or random. The .h5 file records the split: train uses it, and FILE.h5#test reads "
        "the test part.",
    )] = None,
    sensors: Annotated[int | None, _option(
        "--sensors", metavar="M", min=2,
        help="Also keep M boundary nodes as sensors (dataset sensors of an .h5 file).",
    )] = None,
) -> int:
    """Turn geometry into boundaries of four edges."""
    from meshonet.geometry.errors import InputError
    from meshonet.geometry.families.draw import draws
    from meshonet_cli.batch.drawn import DrawnInputs
    from meshonet_cli.tasks.boundaries import write_boundaries

    if bool(source) == bool(family):
        problem = "both a source and {family}" if source else "neither a source nor {family}"
        raise InputError(problem, "give one of them, see meshonet sample-boundary --help")
    o.only_with("family", family is not None, range=spread, split=split, count=count, seed=seed)
    inputs = (
        DrawnInputs(draws(family, 1 if count is None else count, spread, seed or 0, split), run.part())
        if family
        else run.inputs(source or [])
    )
    return write_boundaries(run.batch(inputs, files), sampling.placed(), sensors)
# fmt: on
