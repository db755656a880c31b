"""Inputs of a batch: files one after the other, and the records of each."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from meshonet.formats.inputs import Inputs, Numbered
from meshonet.formats.source import printable
from meshonet.geometry.errors import InputError
from meshonet_cli.batch.item import NO_NUMBER, Item, T, Unreadable, stem_of
from meshonet_cli.terminal.session import Session

if TYPE_CHECKING:
    from meshonet.geometry.families.draw import Draw
    from meshonet.geometry.shapes.shape import Shape
    from meshonet.geometry.spacing.sampling import Sampling


@dataclass(frozen=True)
class DrawnInputs:
    """Members of a family as inputs: all, or those of shard k of n."""

    draws: Sequence[Draw]
    shard: tuple[int, int] = (1, 1)

    def own(self) -> Iterator[Draw]:
        """Yield the members of the shard."""
        k, n = self.shard
        return map(self.draws.__getitem__, range(k - 1, len(self.draws), n))

    def count(self) -> int:
        """Return how many members the shard has."""
        return len(self.draws) // self.shard[1]

    def parts(self, size: int) -> Iterator[tuple[int, tuple[Draw, ...]]]:
        """Yield number and members of the parts of the shard, `size` each."""
        k, n = self.shard
        for number in range(k - 1, -(-len(self.draws) // size), n):
            yield number, tuple(self.draws[number * size : (number + 1) * size])

    def more_than(self, count: int) -> bool:
        """Return whether there are more than so many."""
        return len(self.draws) > count


def members_of(
    inputs: Inputs | DrawnInputs, read: Callable[[Any], Iterator[T]], session: Session
) -> Iterator[Item[T]]:
    """Yield the members of every input; one that cannot be read is reported and passed over."""
    session.batch = session.batch or inputs.more_than(1)
    session.watch()
    count = inputs.count() if session.live else None
    for item in records(inputs.own(), read, alone=not session.batch):
        session.batch = session.batch or not item.only
        if isinstance(item.what, Unreadable):
            session.fail(printable(item.source), item.source, item.what.error)
        else:
            session.begin(item.source, count)
            yield item


def records(
    inputs: Iterable[Numbered | str | InputError | Draw], read: Callable[[Any], Iterator[T]], *,
    alone: bool = False,
) -> Iterator[Item[Any]]:  # fmt: skip
    """Yield every member of every input, or `Unreadable` in its place; draws can be `alone`."""
    count = 0
    for each in inputs:
        entry, first, step = _numbered(each)
        drawn = not isinstance(entry, str | InputError)
        number = count if first is None else first
        for what, seconds, only in _told_apart(_entries(entry, read)):
            yield Item(number, _source(entry), what, seconds, only and (alone or not drawn))
            number = number + step if step else NO_NUMBER
            # a file that is bad as a whole has no number
            count += not (only and isinstance(what, Unreadable))


def _numbered(entry: Numbered | str | InputError | Draw) -> tuple[Any, int | None, int]:
    """Return an input, the number of its first member where it is known, and the step to the next one."""
    if isinstance(entry, Numbered):
        return entry
    return (entry, None, 1) if isinstance(entry, str | InputError) else (entry, entry.index, 0)


def _source(entry: str | InputError | Draw) -> str:
    return entry if isinstance(entry, str) else entry.source if isinstance(entry, InputError) else entry.kind


def _told_apart(entries: Iterator[tuple[Any, float]]) -> Iterator[tuple[Any, float, bool]]:
    """Yield entries, of which there is at least one, and whether each is the only one."""
    last, following = next(entries), next(entries, None)
    only = following is None
    while True:
        yield *last, only
        if following is None:
            return
        last, following = following, next(entries, None)


def _entries(
    source: str | InputError | Draw, read: Callable[[Any], Iterator[T]]
) -> Iterator[tuple[T | Unreadable, float]]:
    """Yield what an input holds, at least one entry, each with the seconds that it took to read."""
    if isinstance(source, InputError):
        yield Unreadable(source), 0.0
        return
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
        yield Unreadable(InputError("holds nothing", remedy, source=printable(str(source)))), 0.0


def assembly(
    inputs: Inputs, read: Callable[[str], Iterator[Shape]], sampling: Sampling, session: Session
) -> Iterator[Item[Shape]]:
    """Yield the one domain that the shapes of all inputs make; an error is reported, and nothing is left."""
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
        yield Item(0, label, domain, time.perf_counter() - begun, called=names[0])
