"""The record that describes a file format; `meshonet.formats.table` holds one of each."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from meshonet.formats.source import Source
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.shape import Shape

if TYPE_CHECKING:
    from meshonet.geometry.layout.layout import Layout

Space: TypeAlias = Literal["volumes", "surfaces"]  # three-dimensional grids: volumes, or patches of surfaces
Options: TypeAlias = frozenset[str]  # options of a format: words after its name (``plot3d:big,float32``)


@dataclass(frozen=True)
class Format:
    """Name, recognition and capabilities of a file format.

    Parameters
    ----------
    name : name of the format for users.
    suffixes : file extensions in lower case, with the dot.
    description : short description for users.
    read_shapes : function that yields shapes; None if the format has grids only or is not read.
    read_grids, write_grids, write_boundaries, write_layouts : functions; None if not supported.
    sniff : function that recognises a file by its first `HEAD_BYTES` bytes.
    names_patches : whether the format stores the topology and the names of patches.
    blocks : ``kept`` if planar blocks are written as blocks, ``merged`` if as one mesh; empty if never.
    space : kinds of three-dimensional grids that can be read and written.
    many : whether one file can contain several grids or boundaries.
    one_size : whether all samples of a file must have the same node counts and topology.
    beside : whether other files are written next to the file, so that it cannot be written to a stream.
    fills_folder : whether a grid is a folder of files; a user names one of them, such as ``case.foam``.
    choices : groups of options that a user may append to the name; options of one group exclude each other.
    reads_options : whether `read_grids` has a parameter ``options``, as `write_grids` has.
    suffix_options : for an extension, the option that it implies when a file is written.
    """

    name: str
    suffixes: tuple[str, ...]
    description: str
    read_shapes: Callable[[Source], Iterator[Shape]] | None = None
    read_grids: Callable[[Source], Iterator[Grid]] | None = None
    write_grids: Callable[..., None] | None = None
    write_boundaries: Callable[[Path, Iterable[Boundary]], None] | None = None
    write_layouts: Callable[[Path, Iterable[Layout]], None] | None = None
    sniff: Callable[[bytes], bool] | None = None
    names_patches: bool = False
    blocks: Literal["", "kept", "merged"] = ""
    space: tuple[Space, ...] = ()
    many: bool = False
    one_size: bool = False
    beside: bool = False
    fills_folder: bool = False
    choices: tuple[tuple[str, ...], ...] = ()
    reads_options: bool = False
    suffix_options: Mapping[str, str] = field(default_factory=dict)

    def file_at(self, path: str) -> str:
        """Return the file to write for a user's `path`, which may be a folder if the format writes a folder.

        >>> case = Format("openfoam", (".foam",), "", fills_folder=True)
        >>> case.file_at("runs/first"), case.file_at("runs/first/case.foam")
        ('runs/first/first.foam', 'runs/first/case.foam')
        """
        place = Path(path)
        if not self.fills_folder or path == "-" or place.suffix.lower() in self.suffixes:
            return path
        return str(place / f"{place.resolve().name}{self.suffixes[0]}")

    def with_options(self, text: str) -> Format:
        """Return the format with comma-separated options; those after a colon override those before it.

        Raises InputError: an unknown option; options that exclude each other and have no colon between them.
        """
        if not text.strip(":"):
            return self
        words: Options = frozenset()
        for group in text.split(":"):
            new = self._options(group)
            excluded = {word for row in self.choices if new & set(row) for word in row}
            words = words - excluded | new
        if not words:
            return self
        ordered = ",".join(word for row in self.choices for word in row if word in words)
        functions: dict[str, Any] = {"write_grids": self.write_grids}
        if self.reads_options:
            functions["read_grids"] = self.read_grids
        bound: Any = {name: partial(function, options=words) for name, function in functions.items()}
        return replace(self, name=f"{self.name}:{ordered}", **bound)

    def _options(self, text: str) -> Options:
        words = [word.strip() for word in text.lower().split(",") if word.strip()]
        known = [word for row in self.choices for word in row]
        for word in words:
            if not known:
                raise InputError(f"{self.name} files have no options", "leave them out", source=text)
            if word not in known:
                raise InputError(f"{word!r} is no option of {self.name} files", "use " + " ".join(known))
        for row in self.choices:
            both = [word for word in row if word in words]
            if len(both) > 1:
                raise InputError(" and ".join(both) + " exclude each other", "give one")
        return frozenset(words)


def later(function: str, /, *args: Any, **settings: Any) -> Any:
    """Import and call `function`, named ``package.module:name``, and return its result."""
    module, _, name = function.partition(":")
    return getattr(importlib.import_module(module), name)(*args, **settings)


def only_one(grids: Iterable[Grid], what: str) -> Grid:
    """Return the only grid of `grids`. Raises InputError: none or several; its message starts with `what`."""
    several = iter(grids)
    first = at_least_one(several)
    if next(several, None) is not None:
        raise InputError(
            f"{what} holds one grid and there are several",
            "write one file each ({output} 'name-{{index}}'), or one .h5",
        )
    return first


def at_least_one(grids: Iterator[Grid]) -> Grid:
    """Return the next grid of `grids`. Raises InputError if there is none."""
    first = next(grids, None)
    if first is None:
        raise InputError("there is no grid to write", "check the input")
    return first


def kinds_in_space(grid: Grid) -> tuple[Space, ...]:
    """Return the kinds of blocks of a three-dimensional grid, volumes or surfaces; () for a planar grid."""
    if grid.form == "plane":
        return ()
    directions = {len(block.counts) for block in grid.blocks if block.nodes.shape[-1] == 3}
    kinds: dict[int, Space] = {3: "volumes", 2: "surfaces"}
    return tuple(kind for count, kind in kinds.items() if count in directions)


def size_of(sample: Boundary | Grid) -> str:
    """Return the node counts and the topology of a grid or boundary as text."""
    if isinstance(sample, Grid) and sample.topology == "blocks":
        return "blocks of " + ", ".join("x".join(map(str, block.nodes.shape)) for block in sample.blocks)
    return f"{sample.ni}x{sample.nj} {sample.topology}"


def size_remedy(own: str, first: str) -> str:
    """Return advice for a sample of size `own` where the first sample has size `first` (see `size_of`)."""
    kinds = {size.partition(" of ")[0].rpartition(" ")[2] for size in (own, first)}
    if "blocks" not in kinds:
        return "set {res} and {topology}"
    if "x3," in f"{own},{first},":
        return "use the same numbers of nodes"
    # a base makes two blocks of a C grid, with as many nodes on and behind it as it needs
    options = "{base} T, {base_nodes}, {res} and {wake_nodes}"
    bases = f"close bases of airfoils with {{te}} wedge, or give all of them one with {options}"
    # variants of a domain that differ much may still have other counts inside
    domains = "; for domains try one {layout} with the {count} of every side"
    return bases if "c" in kinds else bases + domains
