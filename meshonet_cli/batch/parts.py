"""A dataset in parts: a task makes one part of the members of some inputs, and the parts are shown as one."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from itertools import count, islice
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from meshonet.formats.hdf5.parts import Failed, Input, OtherPartsError, PartFiles, State
from meshonet_cli.batch.inputs import digests_of
from meshonet_cli.batch.item import Item, Name, Named, Unreadable
from meshonet_cli.batch.sources import records
from meshonet_cli.batch.timed import Timed
from meshonet_cli.errors import explained

if TYPE_CHECKING:
    from meshonet.formats.hdf5.write import Kind
    from meshonet.geometry.blocks.boundary import Boundary
    from meshonet.geometry.blocks.grid import Grid
    from meshonet_cli.session import Session

T = TypeVar("T", bound=Named)
R = TypeVar("R", bound=Timed)


@dataclass(frozen=True)
class Part:
    """A task: the number of a part, from 0, and the inputs whose members it holds."""

    number: int
    inputs: tuple[str, ...]


def parts_of(inputs: Iterable[str], size: int, shard: tuple[int, int] = (1, 1)) -> Iterator[Part]:
    """Yield the tasks that make parts of `size` inputs each, as they come: all, or those of `shard` k of n."""
    waiting = iter(inputs)
    for number in count():
        texts = tuple(islice(waiting, size))
        if not texts:
            return
        if number % shard[1] == shard[0] - 1:
            yield Part(number, texts)


@dataclass
class PartDone(Generic[R]):
    """What became of a part: its file, whether it was there already, and a report or an error of each member."""

    number: int
    path: str
    state: State
    members: list[tuple[Item[Name], R | Exception]] = field(default_factory=list)


@dataclass(frozen=True)
class PartMaker(Generic[T, R]):
    """Makes parts, in this process or another, and returns no more than reports.

    Parameters
    ----------
    files : where the parts lie.
    kind : what they hold.
    read : yields what an input holds.
    make : yields for each member, in order, what to write and a report, or the error that it ended in.
    skip_existing : whether a part that is there, of the same inputs and settings, stays.
    """

    files: PartFiles
    kind: Kind
    read: Callable[[str], Iterator[T]]
    make: Callable[[Iterable[Item[T]]], Iterator[tuple[Grid | Boundary, R] | Exception]]
    skip_existing: bool = False

    def __call__(self, part: Part) -> PartDone[R]:
        """Make a part, whole or not at all.

        Raises OtherPartsError: the part that is there was made of other inputs or with other settings;
        InputError: it cannot be written.
        """
        inputs = [Input(text, digest) for text in part.inputs for digest in digests_of(text)]
        state = self.files.state(part.number, inputs)
        done: PartDone[R] = PartDone(part.number, str(self.files.path(part.number)), state)
        if state == "complete" and self.skip_existing:
            return done
        done.state = "missing"
        failed: list[Failed] = []
        self.files.write(part.number, self.kind, self._samples(part, done, failed), inputs, failed)
        return done

    def _samples(self, part: Part, done: PartDone[R], failed: list[Failed]) -> Iterator[Grid | Boundary]:
        """Yield what goes into the part, and note a report or an error of each member on the way."""
        waiting: list[Item[T]] = []

        def fail(item: Item[Any], error: Exception) -> None:
            done.members.append((item.without_content(), error))
            failed.append((item.source, item.label, explained(error)))

        def members() -> Iterator[Item[T]]:
            for item in records(part.inputs, self.read):
                if isinstance(item.what, Unreadable):
                    fail(item, item.what.error)
                else:
                    waiting.append(item)
                    yield item

        for outcome in self.make(members()):
            item = waiting.pop(0)
            if isinstance(outcome, Exception):
                fail(item, outcome)
                continue
            what, report = outcome
            report.item = item.without_content()
            with report.timed("write"):
                yield what
            done.members.append((report.item, report))
        done.members.sort(key=lambda member: member[0].index)


Run = Callable[[Callable[[Part], PartDone[R]], Iterable[Part]], Iterator[PartDone[R] | Exception]]
"""Yields in the order of tasks what a function makes of each, or the error that it ended in."""


def one_after_the_other(
    make: Callable[[Part], PartDone[R]], parts: Iterable[Part]
) -> Iterator[PartDone[R] | Exception]:
    """A `Run` in this process."""
    for part in parts:
        try:
            yield make(part)
        except Exception as error:
            yield error


def deliver_parts(
    parts: Iterable[Part], maker: PartMaker[T, R], session: Session, written: Callable[[R, str], None],
    run: Run[R] = one_after_the_other,
) -> None:  # fmt: skip
    """Make `parts`, report every member, and show the parts as one file.

    A part that fails is reported, and missing in the file until the same command makes it; `written` is
    called with the report of each member that was made, and the path of the file.

    Raises InputError: the parts that are there were made of other inputs or with other settings.
    """
    files = maker.files
    files.check()
    session.batch = True
    under_way: deque[Part] = deque()

    def noted() -> Iterator[Part]:
        for part in parts:
            under_way.append(part)
            yield part

    for done in run(maker, noted()):
        part = under_way.popleft()
        if isinstance(done, OtherPartsError):
            raise done
        if isinstance(done, Exception):
            session.fail(str(files.path(part.number)), str(files.path(part.number)), done)
        else:
            _report(done, files, session, written)
    files.build()


def _report(done: PartDone[R], files: PartFiles, session: Session, written: Callable[[R, str], None]) -> None:
    if done.state == "complete":
        session.skip(done.path, str(files.index))
    for item, outcome in done.members:
        session.begin(item.label)
        if isinstance(outcome, Exception):
            session.fail(item.label, item.source, outcome)
        else:
            written(outcome, str(files.index))
