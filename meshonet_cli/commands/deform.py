"""``meshonet deform``."""

from typing import Annotated

from meshonet_cli import options as o

EXAMPLES = (
    "meshonet deform grid.cgns --wall new.dat -o moved.cgns",
    "meshonet deform wing.cgns --wall flap=new-flap.dat --wall slat=new-slat.dat -o moved.cgns",
    "meshonet deform wing.cgns --rotate flap=-5@0.9,0.02 -o flap5.cgns",
    "meshonet deform volume.cgns --wall wall=moved-surface.cgns -o moved.cgns",
)
_option = o.option_of(o.METHOD)


# fmt: off
@o.expanded
def deform(
    grid: o.Grids,
    output: o.Output,
    files: o.FileOptions,
    printing: o.PrintOptions,
    wall: Annotated[list[str] | None, _option(
        "--wall", metavar="[NAME=]FILE",
        help="New shape of a wall: an outline, naca:2412, or a grid with as many nodes there, taken node by "
        "node. NAME is needed where there are several walls; it may be any part of the boundary. Repeatable.",
    )] = None,
    rotate: Annotated[list[str] | None, _option(
        "--rotate", metavar="NAME=DEGREES@X,Y",
        help="Turn a wall counter-clockwise about a point of the plane. Repeatable.",
    )] = None,
    shift: Annotated[list[str] | None, _option(
        "--shift", metavar="NAME=DX,DY[,DZ]",
        help="Shift a wall, after its turn when it has one. Repeatable.",
    )] = None,
    allow_invalid: o.AllowInvalid = False,
    fail_on: o.FailOn = None,
    jobs: o.Jobs = 1,
    threads: o.Threads = None,
) -> int:
    """Make grids follow a changed boundary, their layers as they were."""
    from meshonet_cli.deform_batch import write_deformed

    return write_deformed(
        grid, output, printing.session(), wall=wall or (), rotate=rotate or (), shift=shift or (),
        allow_invalid=allow_invalid, fail_on=fail_on, from_format=files.from_format,
        to_format=files.to_format, skip_existing=files.skip_existing, jobs=jobs, threads=threads,
    )
# fmt: on
