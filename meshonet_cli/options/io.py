"""Options for input, selection of inputs, output and messages."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import typer

from meshonet_cli.batch.settings import Engine, EngineName, Files
from meshonet_cli.options.groups import IO, bad_value, option_of

if TYPE_CHECKING:
    from meshonet.formats.inputs import Inputs
    from meshonet_cli.batch.run import Batch
    from meshonet_cli.terminal.session import Session

_option = option_of(IO)

# fmt: off
Boundaries = Annotated[list[str], typer.Argument(
    metavar="BOUNDARY", show_default=False,
    help="File with an airfoil, points, a boundary or a grid; a designation such as naca:2412; or - for "
    "standard input. A folder or a .zip file stands for all inputs in it, @FILE for those listed in FILE.",
)]
Grids = Annotated[list[str], typer.Argument(
    metavar="GRID", show_default=False,
    help="File with a grid, or - for standard input. A folder stands for all grids in it, @FILE for those "
    "listed in FILE.",
)]
Output = Annotated[str, _option(
    "-o", "--output", metavar="FILE", help="File to write, or - for standard output. For several inputs: one "
    ".h5 file, or a pattern such as 'dir/{stem}.vts', with {stem} for the name of the input file, {name} for "
    "that of the shape, or {index} (from 0).",
)]
From = Annotated[str | None, _option(
    metavar="FORMAT", help="Format of the input; meshonet convert --list-formats lists all. [default: from "
    "the extension or the content]",
)]
To = Annotated[str | None, _option(
    metavar="FORMAT", help="Format of the output; meshonet convert --list-formats lists all. [default: from "
    "the extension; hdf5 on standard output]",
)]
SkipExisting = Annotated[bool, _option(
    help="Skip inputs whose output file, or part of a dataset, already exists.",
)]
Threads = Annotated[int | None, _option(
    metavar="N", min=1, max=64, help="Number of threads for each grid, without effect on the result. "
    "[default: cores divided by processes]",
)]
AsJson = Annotated[bool, _option("--json", help="Print one JSON object per result on standard output.")]
PartSize = Annotated[int | None, _option(
    metavar="N", min=1, max=1_000_000, help="Write the dataset out.h5 in parts of N inputs each, "
    "out/part-00000.h5 and so on, which out.h5 presents as one. [default: parts of up to 256 MiB with "
    "--shard or more than 10,000 inputs; else no parts]",
)]
Debug = Annotated[bool, _option(help="Show the traceback of errors.")]


@dataclass(frozen=True, kw_only=True)
class FileOptions(Files):
    """Options of commands that write files or datasets."""

    output: Output
    from_format: From = None
    to_format: To = None
    skip_existing: SkipExisting = False
    part_size: PartSize = None


@dataclass(frozen=True, kw_only=True)
class PrintOptions:
    """Options for messages."""

    as_json: AsJson = False
    quiet: bool = _option("-q", "--quiet", default=False, help="Print only warnings and errors.")
    debug: Debug = False

    def session(self) -> "Session":
        """Return the session, which prints messages as these options request."""
        from meshonet_cli.terminal.session import Session

        return Session(quiet=self.quiet, as_json=self.as_json, debug=self.debug)


@dataclass(frozen=True, kw_only=True)
class InputOptions(PrintOptions):
    """Options for inputs from folders, archives and lists, for shards of inputs, and for messages."""

    pick: list[str] | None = _option(
        metavar="PATTERN", help="Use only files whose name matches PATTERN, e.g. 'naca*', of folders, .zip "
        "files and lists. Case does not matter. Repeatable.",
    )
    shard: str | None = _option(
        metavar="K/N", help="Process only every N-th input from the K-th on, or every N-th part of a "
        "dataset, so that N jobs share the work.",
    )

    def inputs(
        self, words: Sequence[str], *, grids: bool = False, suffixes: Sequence[str] = ()
    ) -> "Inputs":
        """Return the inputs that `words` name, such as files and folders.

        From folders, all files that can be read are taken; with `grids` only grids, with `suffixes` only
        these extensions. Raises InputError if ``--shard`` is invalid, or if `Inputs` refuses `words`.
        """
        from meshonet.formats.inputs import Inputs

        shard = self.part() if self.shard else (1, 1)
        return Inputs(tuple(words), frozenset(suffixes), tuple(self.pick or ()), shard, grids)

    def part(self) -> tuple[int, int]:
        """Return K and N of the shard K/N, or 1 and 1 for all inputs. Raises InputError: an invalid shard."""
        match = re.fullmatch(r"(\d{1,9})/(\d{1,9})", self.shard or "1/1", re.ASCII)
        if match is None:
            raise bad_value(str(self.shard), "a shard", "use K/N, e.g. 3/8 for the third of eight", "shard")
        return int(match[1]), int(match[2])

    def batch(self, inputs: Any, files: Files) -> "Batch":
        """Return the batch that processes `inputs` in this process."""
        from meshonet_cli.batch.run import Batch

        return Batch(inputs, files, self.session())


@dataclass(frozen=True, kw_only=True)
class RunOptions(InputOptions):
    """Options for the selection of inputs, for messages, and for the engine of a batch."""

    jobs: int = _option(
        default=1, metavar="N", min=1, max=1024, help="Number of processes that share the inputs.",
    )
    engine: EngineName = _option(
        default="processes", help="What runs the processes. processes: this machine. dask: a Dask cluster. "
        "mpi: N MPI ranks (mpiexec -n N meshonet ...).",
    )
    scheduler: str | None = _option(
        metavar="ADDRESS", help="Address of the Dask scheduler, e.g. tcp://head:8786. [default: a cluster of "
        "--jobs processes on this machine]",
    )

    def batch(self, inputs: Any, files: Files) -> "Batch":
        """Return the batch that processes `inputs`. Raises InputError if options exclude each other."""
        from meshonet_cli.batch.run import Batch

        return Batch(inputs, files, self.session(), Engine(self.engine, self.jobs, self.scheduler))
# fmt: on
