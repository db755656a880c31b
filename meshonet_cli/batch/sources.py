"""Inputs of a batch: files in order, and the records of each."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, Any

from meshonet.formats.inputs import Inputs, Numbered
from meshonet.formats.source import printable
from meshonet.geometry.errors import InputError
from meshonet_cli.batch.item import NO_NUMBER, Item, T, stem_of
from meshonet_cli.terminal.session import Session

if TYPE_CHECKING:
    from meshonet.geometry.families.draw import Draw
    from meshonet.geometry.shapes.shape import Shape
    from meshonet.geometry.spacing.sampling import Sampling
    from meshonet_cli.batch.drawn import DrawnInputs

_OFTEN = 700, 10, 10
"""New objects after which cycles, which may hold grids and figures, are searched among many members."""


def members_of(
    inputs: Inputs | DrawnInputs, read: Callable[[Any], Iterator[T]], session: Session
) -> Iterator[Item[T]]:
    """Yield the members of all inputs; an unreadable member is reported and left out."""
    session.batch = session.batch or inputs.more_than(1)
    if session.live:
        session.watch()
    count = inputs.count() if session.live else None
    for item in records(inputs.own(), read, alone=not session.batch):
        session.batch = session.batch or not item.only
        if isinstance(item.what, Exception):
            session.fail(printable(item.source), item.source, item.what)
        else:
            session.begin(item.source, count)
            yield item


def records(
    inputs: Iterable[Numbered | str | InputError | Draw], read: Callable[[Any], Iterator[Any]], *,
    alone: bool = False,
) -> Iterator[Item[Any]]:  # fmt: skip
    """Yield the members of all inputs; for an unreadable member, the item contains the error.

    `alone`: there is only one input. A shape of a parametric family is then named without a number.
    """
    count = 0
    for each in inputs:
        entry: Any = each
        first, step = None, 1  # the number of the first member where it is known, and the step to the next
        drawn = False
        if isinstance(each, Numbered):
            entry, first, step = each
        elif not isinstance(each, str | InputError):
            first, step, drawn = each.index, 0, True
        source = entry if isinstance(entry, str) else entry.kind if drawn else entry.source
        number = count if first is None else first
        entries = _entries(entry, read)
        last: Any = next(entries)
        following = next(entries, None)
        only = following is None
        if not (alone and only):
            gc.set_threshold(*_OFTEN)
        while last:
            what, seconds = last
            name = str(getattr(what, "name", ""))
            yield Item(number, source, what, seconds, name, only and (alone or not drawn))
            number = number + step if step else NO_NUMBER
            # a file that is bad as a whole has no number
            count += not (only and isinstance(what, Exception))
            last, following = following, next(entries, None)


def _entries(
    source: str | InputError | Draw, read: Callable[[Any], Iterator[T]]
) -> Iterator[tuple[T | Exception, float]]:
    """Yield the entries of an input, at least one, each with the seconds that reading took."""
    left: Iterator[T] | None = None
    empty = True
    while True:
        begun = time.perf_counter()
        try:
            if isinstance(source, InputError):
                raise source
            left = read(source) if left is None else left
            entry: T | Exception = next(left)
        except StopIteration:
            break
        except BrokenPipeError:
            raise
        except Exception as error:
            entry, left = error, iter(()) if left is None else left
        empty = False
        yield entry, time.perf_counter() - begun
        if isinstance(source, InputError):
            return
    if empty:
        remedy = "give a file with a boundary or a grid in it"
        yield InputError("holds nothing", remedy, source=printable(str(source))), 0.0


def assembly(
    inputs: Inputs, read: Callable[[str], Iterator[Shape]], sampling: Sampling, session: Session
) -> Iterator[Item[Shape]]:
    """Yield the single domain that the shapes of all inputs form; nothing if an error was reported."""
    from meshonet.geometry.shapes.assembly import assembled

    label = " + ".join(inputs.words)
    session.watch()
    with session.member(label):
        begun = time.perf_counter()
        shapes: list[Shape] = []
        names: list[str] = []
        for source in inputs:
            if isinstance(source, InputError):
                raise source
            own = list(read(source))
            stem = stem_of(source)
            shapes += own
            names += [stem if len(own) == 1 else f"{stem}{k}" for k in range(1, len(own) + 1)]
        domain = assembled(shapes, names, sampling, "+".join(dict.fromkeys(names)))
        session.begin(label)
        yield Item(0, label, domain, time.perf_counter() - begun, domain.name, called=names[0])
