"""``meshonet sweep``."""

from dataclasses import dataclass
from typing import Annotated

import typer

from meshonet_cli import options as o
from meshonet_cli.batch.settings import Files

EXAMPLES = (
    "meshonet sweep circle:0.5 bend.toml -o pipe.h5",
    "meshonet sweep circle:0.5 bend.toml --first-cell 0.005 -o layers.h5",
    "meshonet sweep circle:0.5 --revolve 90 --axis 0,-2,1,0 -o elbow.h5",
    "meshonet sweep duct.csv path.csv --res 41x21 --twist 45 -o duct.h5",
)
_sampling, _volume = o.option_of(o.SAMPLING), o.option_of(o.VOLUME)


# fmt: off
@dataclass(frozen=True, kw_only=True)
class SectionFiles(Files):
    """Options for the files of volumes, and for the format of their sections."""

    output: o.Output
    from_format: o.From = None
    to_format: o.To = None
    skip_existing: o.SkipExisting = False


def sweep(
    names: Annotated[list[str], typer.Argument(
        metavar="OUTLINE... [PATH]", show_default=False,
        help="Cross-sections: circle:RADIUS or a file with a closed curve, a domain, a layout or a planar "
        "grid. Each becomes a grid of its own. Without --revolve the last argument is the path: a TOML file "
        "with lines and arcs, or a file with one point x y z per line.",
    )],
    run: o.RunOptions,
    gates: o.GateOptions,
    files: SectionFiles,
    res: str | None = _sampling(
        metavar="N|NIxNJ", help="Number of nodes along the sides of a four-sided section. [default: 65x33; "
        "with a first cell, as many as --growth needs]",
    ),
    around: int | None = _sampling(
        metavar="N", help="Number of cells around a circle, a multiple of four. [default: 88; if --cells "
        "is given, the number that suits it, but at least 84]",
    ),
    planes: int | None = _volume(
        metavar="K", help="Number of planes of nodes along the path or around the axis. [default: enough for "
        "cells that turn by at most 4 degrees and, along a path, are at most three times as long as wide; 2 "
        "in a wedge]",
    ),
    up: str | None = _volume(
        metavar="X,Y,Z", help="Direction of the y axis of the section at the start of the path. [default: "
        "0,0,1, or 0,1,0 for a path that starts along z]",
    ),
    twist: float = _volume(
        default=0.0, metavar="DEGREES", help="Angle by which the section rotates about the path from start "
        "to end.",
    ),
    scale: float = _volume(
        default=1.0, metavar="F", help="Size of the section at the end of the path, divided by its size at "
        "the start.",
    ),
    revolve: o.Revolve = None,
    axis: o.Axis = None,
    cells: int | None = o.option_of(o.DOMAIN)(
        metavar="N", help="Approximate number of cells in the section. [default: set by --around for a "
        "circle, else 2500]",
    ),
    cell_size: float | None = o.option_of(o.DOMAIN)(
        metavar="H", help="Edge length of cells away from walls, in the unit of the section, instead of "
        "--cells.",
    ),
    layout: str | None = o.option_of(o.DOMAIN)(
        metavar="LAYOUT.json", help="Use the blocks in this file, which meshonet layout wrote, for the "
        "section. [default: new blocks]",
    ),
    walls: o.Walls = None,
    first_cell: str | None = o.option_of(o.BOUNDARY_LAYER)(
        "--first-cell", "--wall-spacing", metavar="H|WALL=H,...", help="Height of the first cell at walls, "
        "in the unit of the section. H applies to the sides of a four-sided section, to holes, and to an "
        "outer curve without corners, but not to sides named inlet, outlet, axis, symmetry or farfield. "
        "WALL=H,WALL=H makes a multi-block section with layers at the named walls only. [default: no layers]",
    ),
    y_plus: o.YPlusAtWalls = None,
    reynolds: o.Reynolds = None,
    length: float | None = o.option_of(o.BOUNDARY_LAYER)(
        metavar="L", help="Reference length of --reynolds, in the unit of the section. [default: the largest "
        "extent of the section]",
    ),
    growth: float | None = o.option_of(o.BOUNDARY_LAYER)(
        metavar="G", help="Largest ratio of the heights of neighbouring cells on a grid line from a wall. It "
        "determines the number of rows of a four-sided section, unless --res gives NJ. [default: 1.2]",
    ),
    allow_invalid: o.AllowInvalid = False,
    threads: o.Threads = None,
    leave_out_failed: o.LeaveOutFailed = False,
) -> int:
    """Sweep cross-sections along curves: pipes and ducts."""
    from meshonet.geometry.blocks.revolve import revolution
    from meshonet.geometry.errors import InputError
    from meshonet.solvers.sweeping.sweep import Sweep
    from meshonet_cli.tasks.sweeps import write_sweeps

    turn = revolution(revolve, planes, o.axis_of(axis))
    outlines, path = (names, turn) if turn else (names[:-1], names[-1])
    if not outlines:
        remedy = f"name it: meshonet sweep {path} PATH -o pipe.h5"
        raise InputError("there is no path", remedy, source="sweep")
    section = {
        "res": res, "cells": cells, "cell_size": cell_size, "walls": walls or (), "layout": layout,
        "first_cell": o.at_walls(first_cell, "first_cell"), "y_plus": o.at_walls(y_plus, "y_plus"),
        "reynolds": reynolds, "length": length, "growth": growth,
        "allow_invalid": allow_invalid, "threads": threads,
    }
    direction = o.numbers(up, (3,), "a direction", "use X,Y,Z, e.g. 0,0,1", "up")
    batch, settings = run.batch(run.inputs(outlines), files), Sweep(planes, direction, twist, scale)
    if turn and settings != Sweep(planes):
        raise InputError("{up}, {twist} and {scale} belong to a path", "leave them out")
    return write_sweeps(batch, path, section, settings, gates.criteria(leave_out_failed), around=around)
# fmt: on
