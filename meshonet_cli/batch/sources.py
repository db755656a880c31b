"""Inputs of a batch: files one after the other, and the records of each."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from meshonet.formats.registry import read_shapes
from meshonet.geometry.errors import InputError
from meshonet_cli.batch.item import Item, T
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
    index = 0
    for source in sources:
        with session.member(source):
            begun = time.perf_counter()
            records = read(source)
            item, more = _following(records, source, session)
            if item is None and not more:
                raise InputError(
                    "holds nothing", "give a file with a boundary or a grid in it", source=source
                )
            only = True
            while item is not None or more:
                spent = time.perf_counter() - begun
                begun = time.perf_counter()
                following, more = _following(records, source, session) if more else (None, False)
                only = only and following is None and not more
                session.batch = session.batch or len(sources) > 1 or not only
                if item is not None:
                    session.begin(source, len(sources) if len(sources) > 1 else None)
                    yield Item(index, source, item, spent, only)
                index += item is not None or more  # a file that is bad as a whole has no number
                item = following


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


def _following(records: Iterator[T], source: str, session: Session) -> tuple[T | None, bool]:
    """Return the next record, None when it cannot be read, which is said, and whether there may be more."""
    with session.member(source):
        item = next(records, None)
        return item, item is not None
    return None, True
