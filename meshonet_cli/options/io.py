"""Options that say what is read, which of many inputs, what is written and what is printed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import typer

from meshonet_cli.batch.files import Files
from meshonet_cli.options.groups import IO, bad_value, option_of

if TYPE_CHECKING:
    from meshonet.formats.inputs import Inputs
    from meshonet_cli.batch.run import Batch
    from meshonet_cli.batch.sources import DrawnInputs
    from meshonet_cli.options.engine import EngineOptions
    from meshonet_cli.terminal.session import Session

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
class VolumeFiles(Files):
    """Files of a command whose inputs have one format and which writes no datasets in parts."""

    output: Output
    to_format: To = None
    skip_existing: SkipExisting = False


@dataclass(frozen=True)
class SectionFiles(VolumeFiles):
    """Files of a command that writes no datasets in parts."""

    from_format: From = None


@dataclass(frozen=True)
class FileOptions(SectionFiles):
    """Files of a command that turns files into files or datasets."""

    part_size: PartSize = None


@dataclass(frozen=True)
class PrintOptions:
    """What is printed."""

    as_json: AsJson = False
    quiet: Annotated[bool, _option("-q", "--quiet", help="Print warnings and errors only.")] = False
    debug: Debug = False

    def session(self) -> Session:
        """Return the session that prints so."""
        from meshonet_cli.terminal.session import Session

        return Session(quiet=self.quiet, as_json=self.as_json, debug=self.debug)

    def batch(
        self, inputs: Inputs | DrawnInputs, files: Files, workers: EngineOptions | None = None
    ) -> Batch:
        """Return the run over inputs that prints so."""
        from meshonet_cli.batch.run import Batch

        session = self.session()
        return Batch(inputs, files, session, workers.chosen()) if workers else Batch(inputs, files, session)


@dataclass(frozen=True)
class InputOptions:
    """Which inputs are taken of folders, zip archives and lists, and which of all inputs."""

    pick: Annotated[list[str] | None, _option(
        "--pick", metavar="PATTERN",
        help="Of folders, .zip files and lists take files of these names only, e.g. 'naca*'; case does not "
        "matter. Can be repeated.",
    )] = None
    shard: Annotated[str | None, _option(
        "--shard", metavar="K/N",
        help="Take every N-th input from the K-th on, for N jobs that share the work; of a dataset in parts, "
        "every N-th part.",
    )] = None
# fmt: on

    def of(self, words: Sequence[str], *, grids: bool = False, suffixes: Sequence[str] = ()) -> Inputs:
        """Return the inputs that `words` name: shapes, or `grids`, or files of other endings.

        Raises InputError: as `Inputs`; a shard that is none.
        """
        from meshonet.formats.inputs import Inputs, readable_suffixes

        endings = frozenset(suffixes) or readable_suffixes(grids_only=grids)
        return Inputs(tuple(words), endings, tuple(self.pick or ()), self.part())

    def part(self) -> tuple[int, int]:
        """Return K and N of the shard, 1 and 1 for all inputs. Raises InputError: it is none."""
        if self.shard is None:
            return 1, 1
        words = self.shard.split("/")
        if len(words) != 2 or not all(word.isascii() and word.isdigit() and len(word) < 10 for word in words):
            raise bad_value(self.shard, "a shard", "use K/N, e.g. 3/8 for the third of eight", "shard")
        return int(words[0]), int(words[1])
