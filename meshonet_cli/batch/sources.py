"""Inputs of a batch: files one after the other, and the records of each."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from meshonet.formats.registry import read_shapes
from meshonet.geometry.errors import InputError
from meshonet_cli.batch.item import Item, T, Unreadable
from meshonet_cli.session import Session

if TYPE_CHECKING:
    from meshonet.geometry.shapes.shape import Shape
    from meshonet.geometry.spacing.sampling import Sampling


def items(sources: Sequence[str], read: Callable[[str], Iterator[T]], session: Session) -> Iterator[Item[T]]:
    """Yield every member of every source; one that cannot be read is reported and passed over.

    Raises InputError: standard input is named twice, or is a terminal.
    """
    if sources.count("-") > 1:
        raise InputError("standard input is named twice", "name - once", source="-")
    if "-" in sources and sys.stdin.isatty():
        raise InputError("standard input is the terminal", "pipe a boundary or a grid into it", source="-")
    count = len(sources) if len(sources) > 1 else None
    for item in records(sources, read):
        session.batch = session.batch or count is not None or not item.only
        if isinstance(item.what, Unreadable):
            session.fail(item.source, item.source, item.what.error)
        else:
            session.begin(item.source, count)
            yield item


def records(sources: Iterable[str], read: Callable[[str], Iterator[T]]) -> Iterator[Item[Any]]:
    """Yield every member of every source, or `Unreadable` in its place."""
    index = 0
    for source in sources:
        entries = _entries(source, read)
        (what, seconds), following = next(entries), next(entries, None)
        only = following is None
        while True:
            yield Item(index, source, what, seconds, only)
            index += not (
                only and isinstance(what, Unreadable)
            )  # a file that is bad as a whole has no number
            if following is None:
                break
            (what, seconds), following = following, next(entries, None)


def _entries(source: str, read: Callable[[str], Iterator[T]]) -> Iterator[tuple[T | Unreadable, float]]:
    """Yield what a source holds, at least one entry, each with the seconds that it took to read."""
    left: Iterator[T] | None = None
    empty = True
    while True:
        begun = time.perf_counter()
        try:
            left = read(source) if left is None else left
            entry: T | Unreadable = next(left)
        except StopIteration:
            break
        except BrokenPipeError:
            raise
        except Exception as error:
            entry, left = Unreadable(error), iter(()) if left is None else left
        empty = False
        yield entry, time.perf_counter() - begun
    if empty:
        remedy = "give a file with a boundary or a grid in it"
        yield Unreadable(InputError("holds nothing", remedy, source=source)), 0.0


def shape_items(
    sources: Sequence[str], fmt: str | None, session: Session, assembled: Sampling | None = None
) -> Iterator[Item[Shape]]:
    """Yield every shape of every source, or the one domain of them all, as `assembled` says."""

    def read(source: str) -> Iterator[Shape]:
        return read_shapes(source, fmt)

    return (
        items(sources, read, session) if assembled is None else _assembly(sources, read, assembled, session)
    )


def _assembly(
    sources: Sequence[str], read: Callable[[str], Iterator[Shape]], sampling: Sampling, session: Session
) -> Iterator[Item[Shape]]:
    """Yield the one domain that the shapes of all sources make; an error is reported, and nothing is left."""
    from meshonet.geometry.shapes.assembly import assembled

    label = " + ".join(sources)
    with session.member(label):
        begun = time.perf_counter()
        shapes: list[Shape] = []
        names: list[str] = []
        for source in sources:
            own = list(read(source))
            stem = "stdin" if source == "-" else Path(source).stem.replace(":", "")
            shapes += own
            names += [stem if len(own) == 1 else f"{stem}{k}" for k in range(1, len(own) + 1)]
        domain = assembled(shapes, names, sampling, "+".join(dict.fromkeys(names)))
        session.begin(label)
        yield Item(0, label, domain, time.perf_counter() - begun, called=names[0])
