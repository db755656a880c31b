"""Determines the format of a file by its name, its extension or its content."""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Literal, TypeVar

from meshonet.formats.format import Format, later
from meshonet.formats.source import Source, nearest, open_source, printable
from meshonet.formats.table import BY_SUFFIX, TABLE
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError, MeshonetError, in_source, meant
from meshonet.geometry.shapes.shape import Shape

Kind = Literal["grids", "boundaries", "layouts"]
T = TypeVar("T")


_OLD_NAMES = {
    "gmsh41": "gmsh:4.1",
    "gmsh41-ascii": "gmsh:4.1,ascii",
    **dict.fromkeys(("stl", "ply", "obj", "off", "abaqus", "medit"), "meshio"),
}
_DESIGNATIONS = {
    "naca:": "meshonet.geometry.shapes.airfoil.naca:naca",
    "circle:": "meshonet.geometry.shapes.circle:circle",
}
"""Prefixes of designations of shapes, and the functions that interpret the rest."""
_LIKE_DESIGNATION = re.compile(r"([a-z]+)[\s:_-]*(\d[\w.-]*)", re.IGNORECASE)


def format_named(name: str) -> Format:
    """Return the format with a name or extension, such as ``gmsh:4.1`` or ``.vts``; InputError if unknown."""
    word, _, options = name.lower().lstrip(".").partition(":")
    if word in _OLD_NAMES:
        base, _, own = _OLD_NAMES[word].partition(":")
        return TABLE[base].with_options(f"{own or word}:{options}")
    if word in TABLE:
        return TABLE[word].with_options(options)
    for record in BY_SUFFIX.get(f".{word}", ()):
        return record.with_options(f"{record.suffix_options.get(f'.{word}', '')}:{options}")
    family, _, own = word.partition("-")
    if own and family in TABLE:  # as in plot3d-binary, which was a format of its own that read any other too
        record = TABLE[family]
        variant = record.with_options(f"{own}:{options}")
        return variant if options else replace(variant, read_grids=record.read_grids)
    remedy = meant(word, TABLE) + "use one of " + ", ".join(TABLE)
    raise InputError(f"format {name!r} is not known", remedy)


def format_of(source: Source, fmt: str | None = None) -> Format:
    """Return the format called `fmt`, or else find it by extension or content. Raises InputError: unknown."""
    if fmt:
        return format_named(fmt)
    claimed = BY_SUFFIX.get(source.suffix, [])
    if len(claimed) == 1:
        return claimed[0]
    head = source.head()
    for record in (
        claimed[:-1] or TABLE.values()
    ):  # the last that claims an ending takes what the others do not
        if record.sniff is not None and record.sniff(head):
            return record
    if claimed:
        return claimed[-1]
    problem = f"its {f'ending {source.suffix!r}' if source.suffix else 'content'} is not of a known format"
    raise InputError(problem, f"name it with {{from_format}}; {_known()}", source=source.name)


def format_for_output(path_text: str, fmt: str | None = None, kind: Kind = "grids") -> Format:
    """Return the format `fmt`, or the format for the extension of `path_text`; for ``-`` it is HDF5.

    Raises InputError if the extension is unknown, or if the format cannot store this `kind` of content.
    """
    if not path_text:
        remedy = "name a file, or - for standard output"
        raise InputError("the output has no name", remedy, parameter="output")
    suffix = Path(path_text).suffix.lower()
    if fmt or path_text == "-":
        claimed = [format_named(fmt or "hdf5")]
    else:
        claimed = BY_SUFFIX.get(suffix, [])
        if not claimed:
            what = f"ending {suffix!r} is not known" if suffix else "name has no ending to tell the format by"
            near = meant(suffix, BY_SUFFIX)
            remedy = f"{near}choose the format with {{to_format}}; {_known()}"
            raise InputError(f"its {what}", remedy, source=printable(path_text))
    for record in claimed:
        if getattr(record, f"write_{kind}") is not None:
            options = "" if ":" in record.name else record.suffix_options.get(suffix, "")
            return record.with_options(options) if options else record
    able = ", ".join(record.name for record in TABLE.values() if getattr(record, f"write_{kind}") is not None)
    problem = f"{claimed[0].name} cannot hold {kind}"
    raise InputError(problem, f"write one of {able}", source=printable(path_text))


def picture_format(output: str, to_format: str | None = None) -> Format:
    """Return the format of a picture file `output`; ``-`` is ``png``. Raises InputError: no picture."""
    named = to_format or BY_SUFFIX.get(Path(output).suffix.lower()) or not Path(output).suffix
    if not (named or output == "-"):
        raise InputError("is no picture", "use .png, .svg, .pdf or .html", source=printable(output))
    record = format_for_output(output, to_format or ("png" if output == "-" else None))
    if record.name not in ("png", "svg", "pdf", "html"):
        raise InputError(f"{record.name} is no picture", "use .png, .svg, .pdf or .html", source=output)
    return record


def read_shapes(text: str, fmt: str | None = None, *, surfaces: bool = False) -> Iterator[Shape]:
    """Return an iterator over the shapes of a file, of standard input (``-``) or of ``naca:2412``.

    Grids give their outer edges. With `surfaces`, flat patches in 3-D are surfaces, not planar grids. After a
    shape that raises InputError, the iterator continues if it can. Raises InputError, with the place, if the
    file cannot be opened, is invalid or has an unknown format.
    """
    if is_designation(text):
        if fmt:
            format_named(fmt)
        word, _, rest = text.partition(":")
        return iter([later(_DESIGNATIONS[f"{word.lower()}:"], rest)])
    source, record = _recognised(text, fmt)
    if record.read_shapes is not None:
        return _Records(source, partial(record.read_shapes, source))
    if record.read_grids is not None:
        from meshonet.formats.mesh.recover_topology import boundary_of

        read = partial(_surfaces, record.read_grids) if surfaces else record.read_grids
        return _Records(source, lambda: map(boundary_of, read(source)))
    raise _unreadable(record, source.name)


def _surfaces(read: Callable[[Source], Iterator[Grid]], source: Source) -> Iterator[Grid]:
    """Return grids of a source, flat patches as surfaces."""
    from meshonet.formats.mesh.slices import surfaces_wanted

    with surfaces_wanted():
        return iter(list(read(source)))


def is_cad(text: str, fmt: str | None = None) -> bool:
    """Return whether a file is a CAD file, whose faces become patches; for ``-``, `fmt` alone decides."""
    if is_designation(text) or (text == "-" and fmt is None):  # a stream is read once
        return False
    return (format_named(fmt) if fmt else format_of(source_of(text))).name in ("step", "brep")


def read_grids(text: str, fmt: str | None = None) -> Iterator[Grid]:
    """Return an iterator over the grids in a file or in standard input (``-``), similar to `read_shapes`.

    Raises InputError as `read_shapes`, and if the file contains only boundaries.
    """
    if is_designation(text):
        remedy = f"make a grid of it first: meshonet infer {text} -o grid.vts"
        raise InputError("is a shape, not a grid", remedy, source=text)
    source, record = _recognised(text, fmt)
    if record.read_grids is not None:
        return _Records(source, partial(record.read_grids, source))
    if record.read_shapes is not None and record.write_grids is not None:
        problem = f"{record.name} files are read as boundaries, without the grid"
        remedy = "write the grid as .cgns or .vtm too, by the command that made it, and read that"
        raise InputError(problem, remedy, source=source.name)
    if record.read_shapes is not None:
        remedy = f"make a grid of it first: meshonet infer {source.name} -o grid.vts"
        raise InputError("holds a boundary, not a grid", remedy, source=source.name)
    raise _unreadable(record, source.name)


def read_sections(text: str, fmt: str | None = None) -> Iterator[Grid | Shape]:
    """Yield the grids in a file or, if its format has no grids, the shapes in it.

    A name (``naca:2412``) and a layout of blocks also give shapes. Raises InputError as `read_shapes`.
    """
    if not is_designation(text):
        record = format_of(open_source(text), fmt)
        if record.read_grids is not None and record.name != "layout":
            return iter(read_grids(text, fmt))
    return iter(read_shapes(text, fmt))


def is_designation(text: str) -> bool:
    """Return whether `text` is a designation such as ``naca:2412`` or ``circle:0.5``, and not a file."""
    return text.lower().startswith(tuple(_DESIGNATIONS)) and not Path(text).exists()


def names_many(text: str) -> bool:
    """Return whether `text` stands for several inputs: a list ``@FILE``, a zip archive or a folder."""
    if text.startswith("@") or (text.lower().endswith(".zip") and Path(text).is_file()):
        return True
    return not is_designation(text) and Path(text).is_dir()


@dataclass
class _Records(Iterator[T]):
    """Iterator over the records of a source; errors get the name of the source."""

    source: Source
    read: Callable[[], Iterator[T]]
    records: Iterator[T] | None = None

    def __next__(self) -> T:
        try:
            with in_source(self.source.name):
                if self.records is None:
                    self.records = iter(())  # a reader that fails at once is not asked again
                    self.records = self.read()
                record = next(self.records)
        except MeshonetError:
            raise
        except (OSError, MemoryError) as error:
            reason = getattr(error, "strerror", None) or str(error) or type(error).__name__
            problem = f"cannot be read ({reason})"
            raise InputError(problem, "check the file", source=self.source.name) from error
        crossing = getattr(record, "crossing", None)  # an error for those who need the curve of an airfoil
        if isinstance(crossing, InputError):
            crossing.source = crossing.source or self.source.name
        return record


def _recognised(text: str, fmt: str | None) -> tuple[Source, Format]:
    """Return a source and its format. Raises InputError: samples of a file that is not a dataset."""
    source = source_of(text)
    record = format_of(source, fmt)
    if record.name != "hdf5" and source.split:
        problem = f"{record.name} files do not say which samples are to {source.split}"
        raise InputError(problem, f"leave #{source.split} out", source=source.name)
    if record.name != "hdf5" and source.rows:
        problem = f"samples of {record.name} files have no numbers"
        raise InputError(problem, "leave out what is behind #", source=source.name)
    return source, record


def _known() -> str:
    return "known endings: " + " ".join(sorted(BY_SUFFIX))


def source_of(text: str) -> Source:
    """Return the source (file or standard input) with the given name.

    Raises InputError if it cannot be opened, or if meshonet can only write files of its format.
    """
    try:
        return open_source(text)
    except InputError:
        path = Path(text)
        match = None if path.exists() or nearest(path) else _LIKE_DESIGNATION.fullmatch(text)
        if match and f"{match[1].lower()}:" in _DESIGNATIONS:
            remedy = f"did you mean {match[1].lower()}:{match[2]}?"
            raise InputError("no such file", remedy, source=printable(text)) from None
        claimed = BY_SUFFIX.get(path.suffix.lower(), [])
        if path.is_file() and claimed and not any(each.read_shapes or each.read_grids for each in claimed):
            raise _unreadable(claimed[0], printable(text)) from None
        raise


def _unreadable(record: Format, name: str) -> InputError:
    problem = f"{record.name} files can only be written"
    remedy = "give a grid or a boundary in another format; .cgns and .vtm hold every grid"
    return InputError(problem, remedy, source=name)
