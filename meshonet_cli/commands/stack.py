"""``meshonet stack``."""

from dataclasses import dataclass
from typing import Annotated, Literal

import typer

from meshonet_cli import options as o
from meshonet_cli.batch.settings import Files

EXAMPLES = (
    "meshonet stack wing.toml -o wing.h5",
    "meshonet stack wing.toml --y-plus 1 --reynolds 6e6 --around 161 --span 65 -o fine.cgns",
    "meshonet stack wing.toml --tip open --surface -o surface.h5",
)
_sampling, _volume = o.option_of(o.SAMPLING), o.option_of(o.VOLUME)
_layer = o.option_of(o.BOUNDARY_LAYER)


# fmt: off
@dataclass(frozen=True, kw_only=True)
class VolumeFiles(Files):
    """Files of volumes, whose inputs have one format."""

    output: o.Output
    to_format: o.To = None
    skip_existing: o.SkipExisting = False


def stack(
    sections: Annotated[list[str], typer.Argument(
        metavar="SECTIONS.toml", show_default=False,
        help="File with two sections or more: airfoil (a file or naca:2412), chord, z, and where needed x, y "
        "and twist, or sweep and dihedral; or a row of blades: profiles, hub, shroud and blades; or - for "
        "standard input.",
    )],
    files: VolumeFiles,
    run: o.RunOptions,
    gates: o.GateOptions,
    around: Annotated[int | None, _sampling(
        "--around", metavar="N", help="Nodes around a section, an odd number. [default: 129]",
    )] = None,
    span: Annotated[int | None, _sampling(
        "--span", metavar="N", help="Nodes from the first section to the last. [default: 49]",
    )] = None,
    base: Annotated[float | None, _sampling(
        "--base", metavar="H",
        help="Least height of trailing edges, in chords of their section; thinner ones are opened to it. "
        "[default: 0.005]",
    )] = None,
    cells: Annotated[int | None, _sampling(
        "--cells", metavar="N", help="About so many cells in the passage of a blade row. [default: 500000]",
    )] = None,
    far_field: Annotated[float | None, _sampling(
        "--far-field", metavar="R", help="Distance of the far field, in longest chords. [default: 15]",
    )] = None,
    tip: Annotated[Literal["round", "flat", "open"] | None, _volume(
        "--tip", metavar="round|flat|open",
        help="How a wing ends: half as high as thick, flat, or not closed. [default: what the file says, or "
        "round]",
    )] = None,
    revolve: Annotated[float | None, _volume(
        "--revolve", metavar="DEG",
        help="Have z of blades and ducts turn about an axis, by this from the first section to the last.",
    )] = None,
    axis: o.Axis = None,
    surface: Annotated[bool, _volume(
        "--surface", help="Write the patches of the surface only, for other programs or solve-pde.",
    )] = False,
    layers: o.Layers = None,
    first_cell: Annotated[float | None, _layer(
        "--first-cell", "--wall-spacing", metavar="H",
        help="Height of the first cell at every node of the wall, in longest chords. [default: 0.001]",
    )] = None,
    y_plus: o.YPlus = None,
    reynolds: Annotated[float | None, _layer(
        "--reynolds", metavar="RE", help="Reynolds number of the longest chord.",
    )] = None,
    growth: Annotated[float | None, _layer(
        "--growth", metavar="G",
        help="Ratio of neighbouring cells away from the wall; it decides the number of layers. "
        "[default: 1.2, or what --layers need]",
    )] = None,
    allow_invalid: o.AllowInvalid = False,
    threads: o.Threads = None,
) -> int:
    """Make volumes around wings, in ducts and blade rows, from sections."""
    from meshonet_cli.tasks.volumes import write_stacks

    chosen = {
        "around": around, "span": span, "base": base, "cells": cells, "far_field": far_field,
        "first_cell": first_cell,
        "y_plus": y_plus, "reynolds": reynolds, "layers": layers, "growth": growth, "threads": threads,
        "revolve": revolve, "axis": o.axis_of(axis),
    }
    parameters = {name: value for name, value in chosen.items() if value is not None}
    return write_stacks(
        run.batch(run.inputs(sections, suffixes=(".toml",)), files),
        parameters | {"allow_invalid": allow_invalid}, gates.criteria(), tip=tip, surface=surface,
    )
# fmt: on
