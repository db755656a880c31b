"""``meshonet convert``."""

from dataclasses import dataclass, replace
from typing import Annotated

import typer

from meshonet_cli import options as o

EXAMPLES = (
    "meshonet convert grid.vts grid.p3d",
    "meshonet convert grid.vts grid3d.msh --extrude 0.1",
    "meshonet convert grid.vts grid3d.p3d --normalise --extrude 1 --planes 5",
    "meshonet convert grids/*.vts -o 'plot3d/{stem}.p3d'",
    "meshonet tfi duct.csv --res 41x21 -o - | meshonet convert - coarse.vts --coarsen 2",
    "meshonet convert grid.vts case/case.foam --extrude 0.1",
    "meshonet convert grid.vts wedge/case.foam --revolve 5 --axis 0,-40,1,0",
    "meshonet convert rotor.cgns annulus.cgns --copies 23",
    "meshonet convert cell.cgns bank/case.foam --copies 3x2 --scale .001 --extrude .001",
    "meshonet convert grid.vts grid.p3d --plot3d fortran,big,single",
    "meshonet convert --list-formats",
)
_option, _output = o.option_of(o.METHOD), o.option_of(o.IO)


# fmt: off
@dataclass(frozen=True, kw_only=True)
class ConvertedFiles(o.FileOptions):
    """Options for files, with the name of the output file as the last argument or after ``-o``."""

    output: o.Output = ""


def convert(
    files: ConvertedFiles,
    run: o.InputOptions,
    names: Annotated[list[str] | None, typer.Argument(
        metavar="IN... [OUT]", show_default=False,
        help="Files to read, or - for standard input. Without -o the last argument is the file to write.",
    )] = None,
    extrude: float | None = _option(
        metavar="H", help="Extrude the planar grid by H along z. The result has one layer of cells, or more "
        "with --planes.",
    ),
    planes: int | None = _option(
        metavar="K", min=2, max=10_000, help="Number of planes of nodes for --extrude or --revolve. "
        "[default: 2; if --revolve is above 10 degrees, at least one every 4 degrees]",
    ),
    plot3d: str | None = _output(
        metavar="WORDS", help="Variant of the Plot3D output or, if only the input is Plot3D, of the "
        "input. Give words with commas between them, at most one of each group: ascii/binary/fortran, "
        "multi/single, 2d/3d, no-iblank/iblank, little/big, float64/float32; for reading also whole/planes; "
        "for writing also span-k/span-i/span-j. The documentation's page on conventions of formats explains "
        "them. [default: for writing the first of each group or as the extension implies; for reading as "
        "recognised]",
    ),
    swap: bool = _option(
        default=False, help="Exchange xi and eta of a four-sided grid. The result is still right-handed.",
    ),
    normalise: bool = _option(
        default=False, help="Move, turn and scale an O or C grid: leading edge to (0, 0), trailing edge to "
        "(1, 0). Other grids: lower left corner of the bounding box to (0, 0), largest extent 1.",
    ),
    coarsen: int | None = _option(
        metavar="K", min=2, max=10_000, help="Keep every K-th node along each direction. K must divide the "
        "numbers of cells and the node indices of wall corners. [default: 1]",
    ),
    scale: float | None = _option(
        metavar="S", help="Multiply all lengths by S, e.g. by 0.001 for millimetres to metres. --extrude and "
        "--axis are in the new unit. [default: 1]",
    ),
    copies: str | None = _option(
        metavar="K[xL]", help="Join K copies of a periodic grid, e.g. passages of a blade row. KxL joins K "
        "copies along the first period and L along the second; meshonet quality lists periods in this "
        "order. [default: 1]",
    ),
    revolve: o.Revolve = None,
    axis: o.Axis = None,
    list_formats: bool = _output(
        default=False, help="Print the formats that can be read and written, and exit.",
    ),
) -> int:
    """Convert files from one format to another."""
    from meshonet.formats.convert import Conversion
    from meshonet.geometry.errors import InputError
    from meshonet_cli.tasks.conversions import convert_files, print_formats

    if list_formats:
        return print_formats(run.session())
    *sources, target = words = [*(names or []), *([files.output] if files.output else [])] or [""]
    if not sources:
        remedy = f"name it: meshonet convert {words[0] or 'IN'} OUT"
        raise InputError("there is no file to write", remedy, source="convert")
    batch = run.batch(run.inputs(sources), replace(files, output=target))
    conversion = Conversion(
        extrude, planes, swap, normalise, coarsen or 1, revolve, o.axis_of(axis), o.copies_of(copies),
        1.0 if scale is None else scale,
    )
    return convert_files(batch, conversion, plot3d)
# fmt: on
