"""Which format a file is in: by ``--from``/``--to``, by its ending, by its content.

The table below is all that is known without loading a format's module, so that starting the program
costs nothing for formats that are not used.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from pathlib import Path
from typing import Literal, NamedTuple

from meshonet.formats.format import Format
from meshonet.formats.mesh.recover_topology import boundary_of
from meshonet.formats.source import Source, open_source, printable
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError, MeshonetError
from meshonet.geometry.shapes.shape import Shape

Kind = Literal["grids", "boundaries"]


class Row(NamedTuple):
    """A format's module and file endings; the endings repeat its record's, and a test holds them equal."""

    module: str
    suffixes: tuple[str, ...]


TABLE: dict[str, Row] = {
    "hdf5": Row("meshonet.formats.hdf5.dataset", (".h5", ".hdf5")),
    "vts": Row("meshonet.formats.vtk.vts", (".vts",)),
    "vtm": Row("meshonet.formats.vtk.vtm", (".vtm",)),
    "vtk": Row("meshonet.formats.vtk.legacy", (".vtk",)),
    "vtk-ascii": Row("meshonet.formats.vtk.legacy", (".vtk",)),
    "vtu": Row("meshonet.formats.vtk.vtu", (".vtu",)),
    "gmsh": Row("meshonet.formats.gmsh.msh", (".msh",)),
    "gmsh-ascii": Row("meshonet.formats.gmsh.msh", (".msh",)),
    "gmsh41": Row("meshonet.formats.gmsh.msh", (".msh",)),
    "gmsh41-ascii": Row("meshonet.formats.gmsh.msh", (".msh",)),
    "cgns": Row("meshonet.formats.cgns.write", (".cgns",)),
    "openfoam": Row("meshonet.formats.openfoam", (".foam",)),
    "geo": Row("meshonet.formats.gmsh.geo", (".geo",)),
    "nmf": Row("meshonet.formats.plot3d.nmf", (".nmf",)),
    "su2": Row("meshonet.formats.su2.write", (".su2",)),
    "stl": Row("meshonet.formats.meshio_export", (".stl",)),
    "ply": Row("meshonet.formats.meshio_export", (".ply",)),
    "obj": Row("meshonet.formats.meshio_export", (".obj",)),
    "off": Row("meshonet.formats.meshio_export", (".off",)),
    "abaqus": Row("meshonet.formats.meshio_export", (".inp",)),
    "medit": Row("meshonet.formats.meshio_export", (".mesh",)),
    "plot3d-ascii": Row("meshonet.formats.plot3d", (".p3d", ".xyz", ".fmt", ".x", ".dat")),
    "plot3d-binary": Row("meshonet.formats.plot3d", (".bin", ".xyz", ".p3d")),
    "plot3d-fortran": Row("meshonet.formats.plot3d", (".ufmt", ".unf")),
    "dxf": Row("meshonet.formats.outlines.dxf", (".dxf",)),
    "wkt": Row("meshonet.formats.outlines.vector", (".wkt",)),
    "geojson": Row("meshonet.formats.outlines.vector", (".geojson", ".json")),
    "airfoil": Row("meshonet.formats.text.airfoil_dat", (".dat",)),
    "points": Row("meshonet.formats.text.points", (".csv", ".txt", ".xy")),
    "png": Row("meshonet.formats.figure.figure", (".png",)),
    "svg": Row("meshonet.formats.figure.figure", (".svg",)),
    "pdf": Row("meshonet.formats.figure.figure", (".pdf",)),
}
"""Formats by name. Where several share an ending, writing takes the first that can, and reading asks each
whether the content is its own, so the strict ones stand first; the last one answers for what none knows."""

_DESIGNATION = "naca:"


def format_named(name: str) -> Format:
    """Return the format that ``--from`` or ``--to`` names: by its name, its ending, or the start of its name.

    Behind a colon may follow what only Plot3D files need: ``plot3d:big,float32`` (`meshonet.formats.plot3d.variant`).

    Raises
    ------
    InputError
        no such format; the message lists those there are.
    """
    word, _, variant = name.lower().lstrip(".").partition(":")
    for known, row in TABLE.items():
        if word and (known == word or f".{word}" in row.suffixes[:1] or known.startswith(f"{word}-")):
            return in_variant(_record(known, row), variant) if variant else _record(known, row)
    raise InputError(f"format {name!r} is not known", "use one of " + ", ".join(TABLE))


def in_variant(found: Format, words: str) -> Format:
    """Return a Plot3D format in the variant that comma-separated words describe.

    Raises
    ------
    InputError
        another format, or words that are not known.
    """
    if not found.name.startswith("plot3d"):
        raise InputError(f"{found.name} files have no variants", "leave the words out", source=words)
    from meshonet.formats.plot3d import variant_of

    return variant_of(found, words)


def formats() -> tuple[Format, ...]:
    """Return every format; loads their modules, though not the libraries these call."""
    return tuple(_record(name, row) for name, row in TABLE.items())


def format_of(source: Source, fmt: str | None = None) -> Format:
    """Return the format of a source to be read.

    Raises
    ------
    InputError
        neither the ending nor the content tells.
    """
    if fmt:
        return format_named(fmt)
    claimed = _by_suffix(source.suffix)
    if len(claimed) == 1:
        return claimed[0]
    head = source.head()
    for found in claimed or formats():
        if found.sniff is not None and found.sniff(head):
            return found
    if claimed:
        return claimed[-1]
    what = f"ending {source.suffix!r} is" if source.suffix else "content is"
    raise InputError(
        f"its {what} not of a known format", f"name it with {{from_format}}; {_known()}", source=source.name
    )


def format_for_output(path_text: str, fmt: str | None = None, kind: Kind = "grids") -> Format:
    """Return the format to write `path_text` in; standard output is HDF5 unless `fmt` says otherwise.

    Raises
    ------
    InputError
        the ending is not known, or the format cannot be written with what `kind` says.
    """
    if not path_text:
        raise InputError(
            "the output has no name", "name a file, or - for standard output", parameter="output"
        )
    suffix = Path(path_text).suffix.lower()
    if fmt or path_text == "-":
        claimed: tuple[Format, ...] = (format_named(fmt or "hdf5"),)
    else:
        claimed = _by_suffix(suffix)
        if not claimed:
            what = f"ending {suffix!r} is not known" if suffix else "name has no ending to tell the format by"
            raise InputError(
                f"its {what}",
                f"choose the format with {{to_format}}; {_known()}",
                source=printable(path_text),
            )
    for found in claimed:
        if getattr(found, f"write_{kind}") is not None:
            return found
    able = ", ".join(found.name for found in formats() if getattr(found, f"write_{kind}") is not None)
    raise InputError(
        f"{claimed[0].name} cannot hold {kind}", f"write one of {able}", source=printable(path_text)
    )


def read_shapes(text: str, fmt: str | None = None) -> Iterator[Shape]:
    """Yield what can be sampled into boundaries: from a path, from ``-``, or a designation ``naca:2412``.

    The outer edges of a grid are boundaries, so a grid file serves too.

    Raises
    ------
    InputError
        a source that cannot be opened, is of no known format, or is not right; named with its place.
    """
    if _is_designation(text):
        if fmt:
            format_named(fmt)
        from meshonet.geometry.shapes.airfoil.naca import naca

        yield naca(text[len(_DESIGNATION) :])
        return
    source = open_source(text)
    found = _selectable(source, format_of(source, fmt))
    with _blamed(source):
        if found.read_shapes is not None:
            yield from found.read_shapes(source)
        elif found.read_grids is not None:
            for grid in found.read_grids(source):
                yield boundary_of(grid)
        else:
            raise _unreadable(found)


def read_grids(text: str, fmt: str | None = None) -> Iterator[Grid]:
    """Yield the grids of a path or of ``-``.

    Raises
    ------
    InputError
        as `read_shapes`; also a file that holds boundaries only.
    """
    if _is_designation(text):
        raise InputError(
            "is an airfoil, not a grid",
            f"make a grid of it first: meshonet infer {text} -o grid.vts",
            source=text,
        )
    source = open_source(text)
    found = _selectable(source, format_of(source, fmt))
    with _blamed(source):
        if found.read_grids is not None:
            yield from found.read_grids(source)
        elif found.read_shapes is not None:
            raise InputError(
                "holds a boundary, not a grid",
                f"make a grid of it first: meshonet infer {source.name} -o grid.vts",
            )
        else:
            raise _unreadable(found)


def _is_designation(text: str) -> bool:
    return text.lower().startswith(_DESIGNATION) and not Path(text).exists()


class _blamed:  # noqa: N801  (a context manager; contextlib's form would swallow the generator's own close)
    """Names the source in errors that do not, and turns the system's errors into ours."""

    def __init__(self, source: Source) -> None:
        self.source = source

    def __enter__(self) -> None:
        return None

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: object) -> None:
        if isinstance(error, InputError):
            error.source = error.source or self.source.name
        elif isinstance(error, (OSError, MemoryError)) and not isinstance(error, MeshonetError):
            told = getattr(error, "strerror", None) or str(error) or type(error).__name__
            raise InputError(f"cannot be read ({told})", "check the file", source=self.source.name) from error


def _selectable(source: Source, found: Format) -> Format:
    if source.split and found.name != "hdf5":
        raise InputError(
            f"{found.name} files do not say which samples are to {source.split}",
            f"leave #{source.split} out",
            source=source.name,
        )
    return found


def _record(name: str, row: Row) -> Format:
    module = importlib.import_module(row.module)
    records: tuple[Format, ...] = getattr(module, "FORMATS", None) or (module.FORMAT,)
    return next(record for record in records if record.name == name)


def _by_suffix(suffix: str) -> tuple[Format, ...]:
    return tuple(_record(name, row) for name, row in TABLE.items() if suffix and suffix in row.suffixes)


def _known() -> str:
    return "known endings: " + " ".join(sorted({suffix for row in TABLE.values() for suffix in row.suffixes}))


def _unreadable(found: Format) -> InputError:
    return InputError(
        f"{found.name} files can only be written", "give a grid or a boundary in another format"
    )
