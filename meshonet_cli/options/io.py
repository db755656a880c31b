"""Options that say what is read, what is written and what is printed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import typer

from meshonet_cli.options.groups import IO, option_of

if TYPE_CHECKING:
    from meshonet_cli.session import Session

_option = option_of(IO)

# fmt: off
Boundaries = Annotated[list[str], typer.Argument(
    metavar="BOUNDARY", show_default=False,
    help="File with a boundary (airfoil, points, dataset, grid), naca:2412, or - for standard input; a "
    "folder or .zip of them, or @FILE, a list of them.",
)]
Grids = Annotated[list[str], typer.Argument(
    metavar="GRID", show_default=False,
    help="Grid file, or - for standard input; a folder of them, or @FILE, a list of them.",
)]
Output = Annotated[str, _option(
    "-o", "--output", metavar="FILE",
    help="File to write, or - for standard output. For several inputs: 'dir/{stem}.vts' (also {name}, "
    "{index}) or one .h5.",
)]
From = Annotated[str | None, _option(
    "--from", metavar="FORMAT", help="Format of the input, when neither its ending nor its content says.",
)]
To = Annotated[str | None, _option(
    "--to", metavar="FORMAT",
    help="Format of the output, when its ending does not say. [default on standard output: hdf5]",
)]
SkipExisting = Annotated[bool, _option(
    "--skip-existing", help="Skip inputs whose output file, or part of a dataset, exists already.",
)]
Threads = Annotated[int | None, _option(
    "--threads", metavar="N", min=1, max=64,
    help="Threads that work on one large grid; the result is the same for any number. [default: all cores, "
    "divided among --jobs]",
)]
AsJson = Annotated[bool, _option("--json", help="Print one JSON object on standard output for each result.")]
PartSize = Annotated[int | None, _option(
    "--part-size", metavar="N", min=1, max=1_000_000,
    help="Write an .h5 dataset in parts of N inputs, out/part-00000.h5 and on, which out.h5 shows as one; "
    "--skip-existing continues it. [default: in parts of up to 256 MiB where there are more than 10,000 "
    "inputs, or a --shard]",
)]
Debug = Annotated[bool, _option("--debug", help="Show the traceback of errors.")]


@dataclass(frozen=True)
class FileOptions:
    """Formats of a command that turns files into files."""

    from_format: From = None
    to_format: To = None
    skip_existing: SkipExisting = False
    part_size: PartSize = None


@dataclass(frozen=True)
class PrintOptions:
    """What is printed."""

    as_json: AsJson = False
    quiet: Annotated[bool, _option("-q", "--quiet", help="Print warnings and errors only.")] = False
    debug: Debug = False

    def session(self) -> Session:
        """Return the session that prints so."""
        from meshonet_cli.session import Session

        return Session(quiet=self.quiet, as_json=self.as_json, debug=self.debug)
# fmt: on
