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
        help="File with an airfoil, points, a boundary or a grid; a designation such as naca:2412; or - for "
        "standard input. A folder or a .zip file stands for all inputs in it, @FILE for those listed in "
        "FILE. Not with --family.",
    )] = None,
    family: str | None = _option(
        metavar="NAME", help="Make shapes with random parameters instead of reading files. arch, hexagon, "
        "wrench, semicircle, airfoil, hole: families of the MeshONet paper. procedural: airfoils. "
        "four-sided: four-sided domains. bodies: bodies in far fields. Without --res, boundaries have "
        "101x101 nodes.",
    ),
    count: int | None = _option(metavar="N", min=1, help="Number of shapes of the --family. [default: 1]"),
    spread: str | None = _option(
        "--range", metavar="A:B", help="Interval of the parameter of a family of the MeshONet paper. "
        "[default: the interval in the paper]",
    ),
    seed: int | None = _option(
        metavar="S", min=0, help="Seed of the random numbers of --family. [default: 0]",
    ),
    split: str | None = _option(
        metavar="HOW", help="Reserve a sixth of the shapes for tests. interpolation: from the middle of the "
        "parameter range. extrapolation: from one end of it. random: at random. The .h5 file stores the "
        "split for meshonet train; FILE.h5#test reads the test shapes. [default: no split]",
    ),
    sensors: int | None = _option(
        metavar="M", min=2, help="Store M boundary nodes of each shape in the .h5 file, in the array "
        "sensors, as input of neural operators. [default: no sensors]",
    ),
) -> int:
    """Place nodes on the four edges of a boundary.

    Faces of STEP and B-rep files become patches of a surface, from which solve-pde can march a volume.
    """
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
