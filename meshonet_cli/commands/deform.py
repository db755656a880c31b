"""``meshonet deform``."""

from meshonet_cli import options as o

EXAMPLES = (
    "meshonet deform grid.vts --wall naca:0014 -o moved.vts",
    "meshonet deform grid.vts --rotate wall=-5@0.25,0 --shift wall=0,0.01 -o turned.cgns",
    "meshonet infer main.dat flap.dat --assemble --cells 1200 -o two.cgns && meshonet deform two.cgns "
    "--wall main=airfoil.dat --rotate flap=-5@1.1,-0.1 -o moved.cgns",
    "meshonet deform wing.cgns --shift bottom=0,0,-0.1 -o deeper.cgns",
)
_option = o.option_of(o.METHOD)


# fmt: off
def deform(
    grid: o.Grids,
    files: o.FileOptions,
    run: o.RunOptions,
    gates: o.GateOptions,
    wall: list[str] | None = _option(
        metavar="[NAME=]FILE", help="New shape of a wall: a file with an outline, a designation such as "
        "naca:2412, or a grid with equally many nodes on its wall. NAME, a wall or another named part of the "
        "boundary, may be omitted if GRID has one wall. Repeatable.",
    ),
    rotate: list[str] | None = _option(
        metavar="NAME=DEGREES@X,Y", help="Rotate the wall NAME counter-clockwise by DEGREES about the point "
        "(X, Y). Repeatable.",
    ),
    shift: list[str] | None = _option(
        metavar="NAME=DX,DY[,DZ]", help="Translate the wall NAME by (DX, DY, DZ), after its rotation. "
        "Repeatable.",
    ),
    allow_invalid: o.AllowInvalid = False,
    threads: o.Threads = None,
    leave_out_failed: o.LeaveOutFailed = False,
) -> int:
    """Deform grids to fit changed walls; layers are kept."""
    from meshonet_cli.tasks.deformations import walls_of, write_deformed

    walls = walls_of(wall or (), rotate or (), shift or ())
    return write_deformed(
        run.batch(run.inputs(grid, grids=True), files), walls, gates.criteria(leave_out_failed),
        allow_invalid=allow_invalid, threads=threads,
    )
# fmt: on
