"""From members to files: one file each, or all in one, each told of when it is written."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import chain
from pathlib import Path
from typing import Protocol, TypeVar

from geometry.boundary import Boundary
from geometry.errors import InputError
from geometry.grid import Grid
from meshonet_cli.batch import Destination
from meshonet_cli.member import Item, Named
from meshonet_cli.report import Timed
from meshonet_cli.session import Session


class Sized(Protocol):
    """What is written: grids and boundaries."""

    @property
    def ni(self) -> int:
        """Nodes along xi."""
        ...

    @property
    def nj(self) -> int:
        """Nodes along eta."""
        ...

    @property
    def topology(self) -> str:
        """Kind of grid."""
        ...


T = TypeVar("T", bound=Named)
S = TypeVar("S", bound=Grid | Boundary)
R = TypeVar("R", bound=Timed)


def deliver(
    found: Iterator[Item[T]],
    make: Callable[[Item[T]], tuple[S, R]],
    destination: Destination,
    session: Session,
    tell: Callable[[R, str], None],
    *,
    skip_existing: bool = False,
) -> None:
    """Make something of every member of `found`, write it to `destination`, and tell of it.

    A member that fails is told of and left out. Memory holds one member at a time.

    Parameters
    ----------
    make : returns what to write and a report, whose stage ``write`` is timed here.
    tell : is given the report and the path when the member is written.
    skip_existing : pass over members whose own file is there.
    """
    leading = next(found, None)
    if leading is None:
        return
    destination.check_only(leading)
    found = chain([leading], found)
    if destination.each or not session.batch:
        _one_file_each(found, make, destination, session, tell, skip_existing)
        return
    stream = _streamed(found, make, destination, session, tell)
    first = next(stream, None)
    if first is not None:
        destination.write(destination.text, chain([first], stream))


def _one_file_each(
    found: Iterator[Item[T]],
    make: Callable[[Item[T]], tuple[S, R]],
    destination: Destination,
    session: Session,
    tell: Callable[[R, str], None],
    skip_existing: bool,
) -> None:
    for item in found:
        with session.member(item.label, item.source):
            path = destination.path(item)
            if skip_existing and path != "-" and Path(path).exists():
                session.skip(item.label, path)
                continue
            what, report = make(item)
            with report.timed("write"):
                destination.write(path, [what])
            tell(report, path)


def _streamed(
    found: Iterator[Item[T]],
    make: Callable[[Item[T]], tuple[S, R]],
    destination: Destination,
    session: Session,
    tell: Callable[[R, str], None],
) -> Iterator[S]:
    """Yield what goes into one file; each is told of when the writer comes back for the next one."""
    size: tuple[int, int, str] | None = None
    for item in found:
        made = None
        with session.member(item.label, item.source):
            result = make(item)
            size = _same_size(result[0], size)
            made = result
        if made is None:
            continue
        what, report = made
        with report.timed("write"):
            yield what
        tell(report, destination.text)


def _same_size(what: Sized, size: tuple[int, int, str] | None) -> tuple[int, int, str]:
    own = (what.ni, what.nj, what.topology)
    if size is not None and own != size:
        raise InputError(
            "{}x{} {} does not fit a dataset of {}x{} {}".format(*own, *size),
            "set --res and --topology, or write one file each",
        )
    return own


def prepare(sources: Sequence[str], destination: Destination, session: Session) -> None:
    """Raise InputError when `destination` cannot take what `sources` and `session` will give it."""
    destination.check_room(sources)
    session.check_output(destination.text)
