"""`meshonet.inputs`, `meshonet.read`, `meshonet.read_all` and `meshonet.write`."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import chain, islice
from pathlib import Path
from typing import Any, TypeAlias, TypeVar

from meshonet.formats.format import Format
from meshonet.formats.inputs import Inputs
from meshonet.formats.output import whole_file
from meshonet.formats.registry import (
    Kind,
    format_for_output,
    format_of,
    is_designation,
    read_grids,
    read_shapes,
    source_of,
)
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.shapes.shape import Shape

T = TypeVar("T")
Writable: TypeAlias = Grid | Boundary | Layout
_KINDS: dict[type[Writable], Kind] = {Grid: "grids", Boundary: "boundaries", Layout: "layouts"}


def inputs(
    names: str | Path | Sequence[str | Path],
    *,
    pick: str | Sequence[str] = (),
    shard: tuple[int, int] = (1, 1),
) -> Iterator[str]:
    """Return an iterator over the inputs in folders, archives and lists; pass each input to `read` or `grid`.

    Parameters
    ----------
    names : str, Path or list of these
        Files, folders, zip archives and designations such as ``naca:2412``. ``@FILE`` stands for the inputs
        that a text file lists, one per line.
    pick : str or list of str, optional
        Patterns (``naca*``) that the names of files in folders, archives and lists must match.
    shard : tuple of 2 int, optional
        Two numbers k and n: return only every n-th input, starting with the k-th.

    Yields
    ------
    str
        The name of an input.

    Raises
    ------
    InputError
        A folder, archive or list that cannot be read, or is empty.

    Examples
    --------
    >>> list(inputs(["naca:0012", "naca:2412", "naca:4412"], shard=(2, 2)))
    ['naca:2412']
    """
    words = (names,) if isinstance(names, str | Path) else names
    patterns = (pick,) if isinstance(pick, str) else tuple(pick)
    every = Inputs(tuple(map(str, words)), pick=patterns, shard=shard)
    return (_readable(each.text) for each in every.own())


def _readable(text: str | InputError) -> str:
    if isinstance(text, InputError):
        raise text
    return text


def read(path: str | Path, *, from_format: str | None = None) -> Grid | Shape:
    """Return the grid of a file, or the shape of a designation or of a file without grids.

    Parameters
    ----------
    path : str or Path
        File, or a designation such as ``naca:2412``.
    from_format : str, optional
        Format; needed if neither extension nor content determines it.

    Returns
    -------
    Grid or shape
        The only grid of the file, or its only shape.

    Raises
    ------
    InputError
        A file that cannot be read, or has several grids or shapes; use `read_all` for these.

    Examples
    --------
    >>> read("naca:2412").name
    'NACA 2412'
    """
    return only(read_all(path, from_format=from_format), path, "a boundary or a grid", "use read_all")


def only(records: Iterator[T], source: str | Path, what: str, remedy: str = "give a file with one") -> T:
    """Return the only one of the records of a source; `what` describes its content.

    Raises InputError, with the `remedy`: no record, or more than one.
    """
    record = next(records, None)
    if record is None:
        raise InputError("holds nothing", f"give a file with {what} in it", source=str(source))
    if next(records, None) is not None:
        raise InputError(f"holds several, where {what} is asked for", remedy, source=str(source))
    return record


def read_all(path: str | Path, *, from_format: str | None = None) -> Iterator[Grid | Shape]:
    """Return an iterator over the grids of a file, or over the shapes of a file without grids.

    Parameters
    ----------
    path : str or Path
        File, or a designation such as ``naca:2412``.
    from_format : str, optional
        Format; needed if neither extension nor content determines it.

    Returns
    -------
    iterator of Grid or shape
        The grids of a file, or its shapes if it has no grids.

    Raises
    ------
    InputError
        A file that cannot be read.

    Examples
    --------
    >>> import meshonet
    >>> meshonet.tfi("naca:2412", res=(41, 17)).write("grid.h5")
    >>> [grid.nodes.shape for grid in read_all("grid.h5")]
    [(41, 17, 2)]
    """
    text = str(path)
    if is_designation(text):
        return read_shapes(text, from_format)
    fmt = format_of(source_of(text), from_format)
    if fmt.read_grids is None:
        return read_shapes(text, from_format)
    grids = read_grids(text, from_format)
    if fmt.read_shapes is None:
        return grids
    try:  # a dataset holds the one or the other
        return chain([next(grids)], grids)
    except (InputError, StopIteration):
        return read_shapes(text, from_format)


def write(what: Writable | Iterable[Writable], path: str | Path, *, to_format: str | None = None) -> None:
    """Write a grid, a boundary or a layout, or several of the same kind, into one file.

    Parameters
    ----------
    what : Grid, Boundary or Layout, or iterable of these
        Objects of the same kind; an iterable is read one object at a time. Grids of a dataset must have the
        same numbers of nodes and the same topology.
    path : str or Path
        File to write; its extension determines the format. An OpenFOAM mesh is written into the folder of
        ``case.foam``, or into a folder given as the path.
    to_format : str, optional
        Format; needed if the extension does not determine it.

    Raises
    ------
    InputError
        An unknown format; a format that cannot store the object, or not several objects; a path that cannot
        be written.

    Examples
    --------
    >>> import meshonet
    >>> write(meshonet.sample_boundary("naca:2412", res=(41, 17)), "edges.h5")
    >>> read("edges.h5").topology
    'o'
    >>> write((meshonet.tfi(f"naca:24{t}", res=(41, 17)) for t in (12, 15)), "both.h5")
    >>> [grid.name for grid in read_all("both.h5")]
    ['NACA 2412', 'NACA 2415']
    """
    several = iter(what) if isinstance(what, Iterable) else iter([what])
    first = next(several, None)
    if first is None:
        raise InputError("there is nothing to write", "give a grid, a boundary or a layout", source=str(path))
    kind = _kind_of(first)
    fmt = format_for_output(str(path), to_format, kind)
    put_whole(fmt, path, getattr(fmt, f"write_{kind}"), _alike(kind, chain([first], several)))


def put_whole(
    fmt: Format, path: str | Path, put: Callable[[Path, Iterator[Any]], None], members: Iterator[Any]
) -> None:
    """Write members with `put` into a file of the format `fmt`; after an error no file is written.

    Raises InputError: several members for a format that can store only one; a path that cannot be written.
    """
    if not fmt.many:
        two = list(islice(members, 2))
        if len(two) > 1:
            remedy = "write one file each" + (", or one .h5" if fmt.write_grids else "")
            raise InputError(f"{fmt.name} files hold one, and there are several", remedy, source=str(path))
        members = iter(two)
    folder = fmt.fills_folder
    with whole_file(fmt.file_at(str(path)), make_folder=folder, beside=folder or fmt.beside) as part:
        put(part, members)


def _kind_of(what: Any) -> Kind:
    for cls, kind in _KINDS.items():
        if isinstance(what, cls):
            return kind
    problem = f"{type(what).__name__} is neither a grid nor a boundary nor a layout"
    raise InputError(problem, "make one of it first, e.g. by infer or sample_boundary", parameter="what")


def _alike(kind: Kind, members: Iterator[Writable]) -> Iterator[Writable]:
    for member in members:
        if _kind_of(member) != kind:
            problem = f"{_kind_of(member)} among {kind}"
            raise InputError(problem, "write them into files of their own", parameter="what")
        yield member
