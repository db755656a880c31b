"""Output files of a batch."""

from __future__ import annotations

import os
import re
import string
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from meshonet.formats.format import Space, size_of, size_remedy
from meshonet.formats.output import whole_file
from meshonet.formats.registry import Kind, format_for_output
from meshonet.formats.source import printable
from meshonet.formats.table import check_space
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet_cli.batch.item import NO_NUMBER, Item
from meshonet_cli.batch.settings import Files

if TYPE_CHECKING:
    from meshonet.formats.hdf5.parts import PartFiles
    from meshonet.formats.inputs import Inputs
    from meshonet.geometry.layout.layout import Layout
    from meshonet_cli.batch.drawn import DrawnInputs
    from meshonet_cli.terminal.session import Failures

FIELDS = ("stem", "index", "name")  # fields of a pattern for output names
# formats of fields: a width of up to three digits, no conversion of numbers to characters
_FORM = re.compile(r"(?:[^{}]?[<>=^])?[-+ ]?#?\d{0,3}[,_]?(?:\.\d{0,3})?[sdxXobn]?")
_LONGEST_NAME = 255  # longest file name in bytes on Linux, macOS and Windows
MANY = 10_000  # largest number of inputs that are written as a dataset without parts
_PART_BYTES, _LIKELY_NODES = 1 << 28, 40_000  # largest size of a part in bytes; assumed nodes per grid
_MOST_IN_PART, _MOST_FOR_MANY_WORKERS = 1000, 100  # inputs per part at most; if many workers share


class Destination:
    """Output of a batch: standard output (``-``), one file, or a file for each result.

    Parameters
    ----------
    text : file name, or a pattern with ``{stem}``, ``{index}`` or ``{name}`` for several files.
    fmt : name of the format; None: determined by the extension.
    kind : what the results are: ``grids``, ``boundaries`` or ``layouts``.
    put : function that writes to a path; None: the writer of the format.
    part_size : number of inputs in a part of a dataset; None: derived from `nodes`.
    nodes : approximate number of nodes of a result.
    space : "volumes" or "surfaces" for results in three dimensions; None: planar results.

    Raises InputError if a field or extension is unknown, or the format cannot be written or split into parts.
    """

    def __init__(
        self, text: str, fmt: str | None, kind: Kind = "grids",
        put: Callable[[Path, Any], None] | None = None, *,
        part_size: int | None = None, nodes: int | None = None, space: Space | None = None,
    ) -> None:  # fmt: skip
        self.text, self.kind, self._part_size, self._nodes = text, kind, part_size, nodes
        self.each = not {"{", "}"}.isdisjoint(text) and bool(_fields(text))
        self.format = format_for_output(text, fmt, kind)
        if space:
            check_space(self.format, space, printable(text))
        self._put = put or getattr(self.format, f"write_{kind}")
        self._taken: dict[str, str] = {}
        self.is_dataset = self.format.name == "hdf5"
        self.failed: Failures | None = None
        """What a dataset lists as failed, filled while it is written; None for formats without a list."""
        if self.is_dataset and not put:
            self.failed = []
        self.can_have_parts = self.is_dataset and not self.each and text != "-"
        if part_size is not None and not self.can_have_parts:
            remedy = "write one .h5 file, or leave it out"
            raise InputError("only a dataset has parts", remedy, parameter="part_size")
        if text == "-" and sys.stdout.isatty():
            raise InputError("standard output is the terminal", "pipe it on, or write to a file", source="-o")

    def path(self, item: Item[Any]) -> str:
        """Return the path for a member's result. Raises InputError: a path too long or already used."""
        if not self.each:
            return self.format.file_at(self.text)
        if item.index == NO_NUMBER and "index" in _fields(self.text):
            problem = "is one of several in its file, which {shard} leaves without a number"
            raise InputError(problem, "use {{name}} in place of {{index}}", source=item.label)
        name = re.sub(r"[^\w.+-]+", "_", item.name).strip("._") or item.stem
        path = self.format.file_at(self.text.format(stem=item.stem, index=item.index, name=name))
        if max(len(os.fsencode(part)) for part in Path(path).parts) > _LONGEST_NAME:
            problem = f"its output has a name of more than {_LONGEST_NAME} bytes"
            raise InputError(problem, f"use a shorter -o {_escaped(self.text)[:80]}", source=item.label)
        place = str(Path(path).parent) if self.format.fills_folder else path
        if place in self._taken:
            problem, remedy = f"would overwrite {place} of {self._taken[place]}", "put {{index}} into -o "
            raise InputError(problem, remedy + _escaped(self.text), source=item.label)
        self._taken[place] = item.label
        return path

    def check_room(self, remedy: str = "") -> None:
        """Raise InputError, with `remedy`, if the output is one file that cannot store several results."""
        if not (self.each or self.format.many):
            remedies = filter(None, (self._named("stem"), remedy))
            problem = f"several inputs and one {self.format.name} file, which holds one"
            raise InputError(problem, "; ".join(remedies), source=self.text)

    def part_size_for(self, inputs: Inputs | DrawnInputs, files: Files, *, elsewhere: bool) -> int:
        """Return the number of inputs in a part of the dataset; 0 if the output has no parts.

        There are parts if the user asks for them, if a dataset in parts is continued, if there are more than
        `MANY` inputs, or with ``--shard``, where each job has a share of the inputs. Parts are smaller with
        ``--shard``, or if workers may be on other machines (`elsewhere`). Raises InputError if an existing
        dataset would be replaced or cannot be continued.
        """
        if not inputs.more_than(0):
            return 0
        skip_existing = files.skip_existing
        index = Path(self.text)
        shared = inputs.shard != (1, 1)
        continued = skip_existing and index.with_suffix("").is_dir()
        if not (self._part_size or shared or continued or inputs.more_than(MANY)):
            if skip_existing and inputs.more_than(1) and index.exists():
                problem = "is a dataset in one file, which cannot be continued"
                raise InputError(problem, "remove it, or leave {skip_existing} out", source=self.text)
            return 0
        if index.exists() and not index.with_suffix("").is_dir():
            problem = "is there, and the parts would replace it"
            raise InputError(problem, "remove it, or choose another name", source=self.text)
        from meshonet.formats.hdf5.parts import PartFiles

        most = _MOST_FOR_MANY_WORKERS if shared or elsewhere else _MOST_IN_PART
        return self._part_size or PartFiles(index).size_there() or usual_part_size(self._nodes, most)

    def part_files(self, make: object, size: int) -> PartFiles:
        """Return the files of a dataset, each with the grids of `size` inputs, made with settings `make`."""
        from meshonet.formats.hdf5.parts import PartFiles, digest_of
        from meshonet_cli.batch.settings_text import described

        request = digest_of(self.kind, str(size), described(make))
        return PartFiles(Path(self.text), request, size)

    def check_several(self, item: Item[Any]) -> None:
        """Raise InputError, which names the input of `item`, if the output cannot store several results."""
        if not (self.each or self.format.many):
            problem = f"holds several grids or boundaries, and a {self.format.name} file holds one"
            raise InputError(problem, self._named("index"), source=item.source)

    def _named(self, field: str) -> str:
        """Return the remedy: a pattern, or a dataset if the results fit into one."""
        dataset = " or one .h5" if self.kind != "layouts" and self._put == self.format.write_grids else ""
        return f"name the output '{_escaped(_pattern(self.text, field))}'{dataset}"

    def write(self, path: str, what: Iterable[Any]) -> None:
        """Write the results `what` to `path` atomically."""
        folder = self.format.fills_folder
        with whole_file(path, make_folder=self.each or folder, beside=folder or self.format.beside) as part:
            self._put(part, what, *([] if self.failed is None else [self.failed]))


def usual_part_size(nodes: int | None, most: int = _MOST_IN_PART) -> int:
    """Return how many grids of `nodes` nodes (None: unknown) fit into a part of 256 MiB, at most `most`.

    The number is rounded down to 1, 2 or 5 times a power of ten.

    >>> usual_part_size(200 * 100), usual_part_size(65 * 65), usual_part_size(800 * 400)
    (500, 1000, 20)
    """
    fitting = min(_PART_BYTES // (17 * (nodes or _LIKELY_NODES) + 2000), most)
    sizes = (digit * 10**power for power in range(4) for digit in (1, 2, 5))
    return max((size for size in sizes if size <= fitting), default=1)


def _escaped(text: str) -> str:
    """Return `text` for an error message, which replaces names in single braces by options."""
    return re.sub(r"\{(\w+)\}", r"{{\1}}", text)


def _pattern(text: str, field: str = "stem") -> str:
    path = Path(text)
    return str(path.with_name(f"{path.stem}-{{{field}}}{path.suffix}")) if text != "-" else f"{{{field}}}.vts"


def _fields(text: str) -> list[str]:
    """Return the fields of a pattern. Raises InputError: an unknown or unsuitable field."""
    fields: list[str] = []
    problem = "has a field that is not known"
    remedy = "use {{stem}}, {{index}} or {{name}}; write {{ and }} for braces"
    try:
        for _, field, form, _ in string.Formatter().parse(text):
            if field is not None and field not in FIELDS:
                raise ValueError
            if field is not None and not _FORM.fullmatch(form or ""):
                problem, remedy = "has a field in a format that makes no name", "use e.g. {{index:04d}}"
                raise ValueError
            fields += [field] if field else []
        text.format(stem="", index=0, name="")
    except ValueError:
        raise InputError(f"{_escaped(repr(text[:200]))} {problem}", remedy, source="-o") from None
    return fields


def same_size(what: Grid | Boundary | Layout, size: str) -> str:
    """Return the size of a result as text. Raises InputError if `size` is not empty and differs from it."""
    if not isinstance(what, Grid | Boundary):  # files of layouts hold one
        return ""
    own = size_of(what)
    if size and own != size:
        problem = f"{own} does not fit a dataset of {size}"
        raise InputError(problem, f"{size_remedy(own, size)}, or write one file each: -o '{{{{stem}}}}.h5'")
    return own
