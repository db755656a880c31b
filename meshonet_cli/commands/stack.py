"""``meshonet stack``."""

from dataclasses import dataclass
from typing import Annotated, Literal

import typer

from meshonet_cli import options as o
from meshonet_cli.batch.settings import Files

EXAMPLES = (
    "meshonet stack wing.toml -o wing.h5",
    "meshonet stack wing.toml --y-plus 1 --reynolds 6e6 --around 161 --span 65 -o fine.cgns",
    "meshonet stack rotor.toml --cells 100000 --copies 2 -o passages.cgns",
    "meshonet stack wing.toml --tip open --surface -o surface.h5",
    "meshonet stack aircraft.toml --first-cell 0.02 --growth 1.4 --surface -o surface.cgns",
)
_sampling, _volume = o.option_of(o.SAMPLING), o.option_of(o.VOLUME)
_layer = o.option_of(o.BOUNDARY_LAYER)


# fmt: off
@dataclass(frozen=True, kw_only=True)
class VolumeFiles(Files):
    """Options for the output files of volumes. The input is always TOML, so it needs no option."""

    output: o.Output
    to_format: o.To = None
    skip_existing: o.SkipExisting = False


def stack(
    sections: Annotated[list[str], typer.Argument(
        metavar="SECTIONS.toml", show_default=False,
        help="File that describes the shape, or - for standard input. A wing or blade: sections with an "
        "airfoil, a chord and a position. A duct: sections with an outline. A blade row: profiles, hub and "
        "shroud. An aircraft: a body and wings. The documentation's guides list the entries.",
    )],
    files: VolumeFiles,
    run: o.RunOptions,
    gates: o.GateOptions,
    around: int | None = _sampling(
        metavar="N", help="Odd number of nodes around each section; the first node is also the last and "
        "counts twice. [default: 129]",
    ),
    span: int | None = _sampling(
        metavar="N", help="Number of nodes along z, from the first to the last section. [default: 49; more "
        "in ducts and blades with unevenly spaced sections]",
    ),
    base: float | None = _sampling(
        metavar="H", help="Smallest height of trailing edges, in chords of each section. Thinner trailing "
        "edges are opened to this height. [default: 0.005; 0.001 for wings from surface files]",
    ),
    cells: int | None = _sampling(
        metavar="N", help="Approximate number of cells of the volume grid, or of each passage of a blade "
        "row. Not for ducts. For a wing or blade, instead of --around, --span or both; for an aircraft, "
        "instead of --around. [default: 500000 in a blade row; else set by --around and --span]",
    ),
    copies: int | None = _sampling(
        metavar="K", min=1, help="Number of adjacent passages of a blade row, up to the number of blades. "
        "[default: 1]",
    ),
    far_field: float | None = _sampling(
        metavar="R", help="Distance of the far field from a wing, blade or aircraft, in longest chords. "
        "[default: 15]",
    ),
    tip: Literal["round", "flat", "open"] | None = _volume(
        help="Tip of a wing. round: closed by a cap of half the local thickness. flat: closed by a plane. "
        "open: the tip is not closed and lies in a plane of symmetry. [default: as given in the file, else "
        "round]",
    ),
    revolve: float | None = _volume(
        metavar="DEGREES", help="Bend the z axis of a blade or duct around --axis, by this angle from the "
        "first section to the last. [default: straight]",
    ),
    axis: o.Axis = None,
    surface: bool = _volume(
        default=False, help="Write only the surface patches, for other programs or for solve-pde.",
    ),
    layers: o.Layers = None,
    first_cell: float | None = _layer(
        "--first-cell", "--wall-spacing", metavar="H", help="Height of the first cell at every wall, in "
        "longest chords; in ducts in the unit of the file. [default: 0.001; in ducts about the height of the "
        "cells in the middle]",
    ),
    y_plus: o.YPlus = None,
    reynolds: o.Reynolds = None,
    length: float | None = _layer(
        metavar="L", help="Reference length of --reynolds, in the unit of --first-cell. [default: the "
        "longest chord; in ducts the largest extent of the sections]",
    ),
    growth: float | None = _layer(
        metavar="G", help="Largest ratio of the heights of neighbouring cells on a grid line from a wall. It "
        "determines the number of rows. Not with --layers. [default: 1.2]",
    ),
    allow_invalid: o.AllowInvalid = False,
    threads: o.Threads = None,
    leave_out_failed: o.LeaveOutFailed = False,
) -> int:
    """Make volume grids of wings, ducts, blade rows and aircraft.

    The grid surrounds a wing, blade or aircraft, fills a duct, or fills one passage of a blade row.
    """
    from meshonet_cli.tasks.volumes import write_stacks

    chosen = {
        "around": around, "span": span, "base": base, "cells": cells, "copies": copies,
        "far_field": far_field, "first_cell": first_cell, "y_plus": y_plus, "reynolds": reynolds,
        "length": length, "layers": layers, "growth": growth, "threads": threads,
        "revolve": revolve, "axis": o.axis_of(axis),
    }
    parameters = {name: value for name, value in chosen.items() if value is not None}
    return write_stacks(
        run.batch(run.inputs(sections, suffixes=(".toml",)), files),
        parameters | {"allow_invalid": allow_invalid}, gates.criteria(leave_out_failed),
        tip=tip, surface=surface,
    )
# fmt: on
