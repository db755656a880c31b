"""From members to files: one file each, or all in one, each reported when it is written."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from itertools import chain, islice
from pathlib import Path
from typing import TYPE_CHECKING, Generic, TypeVar

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError, MeshonetError
from meshonet.solvers.stages import reached
from meshonet_cli.batch.destination import Destination, same_size
from meshonet_cli.batch.executors.engine import HERE, Engine
from meshonet_cli.batch.item import Item, Name, Named
from meshonet_cli.batch.sources import Members, Origin
from meshonet_cli.batch.timed import Timed
from meshonet_cli.session import Session

if TYPE_CHECKING:
    from meshonet.geometry.layout.layout import Layout
    from meshonet_cli.batch.executors.workers import Workers

T = TypeVar("T", bound=Named)
S = TypeVar("S", bound="Grid | Boundary | Layout")
R = TypeVar("R", bound=Timed)
Make = Callable[[Iterable[Item[T]]], Iterator[tuple[S, R] | Exception]]
"""Yields for each member, in order, what to write and a report, or the error that it ended in."""
Todo = Iterable[tuple[Item[T], str]]  # members and the paths of their files
_TASK_SECONDS, _MOST_AT_ONCE = 0.1, 64  # how long tasks of several members are, and how large
Done = tuple[Item[Name], str, tuple[S | None, R] | Exception]


def prepare(members: Members[T], destination: Destination, session: Session) -> None:
    """Raise InputError when `destination` cannot take what `members` and `session` will give it."""
    destination.check_room(several=members.several)
    session.check_output(destination.text)


def process(
    members: Members[T], make: Callable[[Item[T]], tuple[S, R]], destination: Destination,
    session: Session, *, written: Callable[[R, str], None] | None = None, skip_existing: bool = False,
    engine: Engine = HERE,
) -> int:  # fmt: skip
    """Make something of each of the `members`, deliver it, and return the exit code.

    `written` is called with the report and the path of each; the session's own says that it is done.
    """
    prepare(members, destination, session)
    deliver(
        members, one_by_one(make), destination, session, written or session.written,
        skip_existing=skip_existing, engine=engine,
    )  # fmt: skip
    return session.finish()


@dataclass(frozen=True)
class one_by_one(Generic[T, S, R]):  # noqa: N801 - used as a function, and a class so that processes can have it
    """Returns a `Make` of a function of one member."""

    make: Callable[[Item[T]], tuple[S, R]]

    def __call__(self, members: Iterable[Item[T]]) -> Iterator[tuple[S, R] | Exception]:
        """Yield what the function makes of each member."""
        for member in members:
            try:
                yield self.make(member)
            except Exception as error:
                yield error


def deliver(
    members: Members[T], make: Make[T, S, R], destination: Destination, session: Session,
    written: Callable[[R, str], None], *, skip_existing: bool = False, together: int = 1,
    engine: Engine = HERE,
) -> None:  # fmt: skip
    """Make something of every member of `members`, write it to `destination`, and report it.

    A member that fails is reported and left out. `make` yields what to write, and reports whose stage
    ``write`` is timed here; for the workers of an `engine`, which get so many members `together`, it must be
    something that can be pickled. `written` is called with the report and the path of each; with
    `skip_existing` members whose own file is there are passed over.
    """
    size = destination.part_size_for(members, skip_existing=skip_existing, elsewhere=engine.elsewhere)
    if size and members.origin:
        _deliver_parts(members.origin, make, destination, size, session, written, skip_existing, engine)
        return
    leading = next(members, None)
    if leading is None:
        return
    destination.check_only(leading)
    items = chain([leading], members)
    each = destination.each or not session.batch
    todo = _paths(items, destination, session, skip_existing) if each else ((item, "") for item in items)
    work = _Work(make, destination if each else None)
    done = (
        work(todo) if engine.here or not session.batch else _by_workers(work, todo, engine, together, session)
    )
    if each:
        for item, path, outcome in done:
            with session.member(item.label, item.source):
                written(_made(outcome)[1], path)
        return
    stream = _streamed(done, destination, session, written)
    first = next(stream, None)
    if first is not None:
        destination.write(destination.text, chain([first], stream))


def _deliver_parts(
    origin: Origin[T], make: Make[T, S, R], destination: Destination, size: int, session: Session,
    written: Callable[[R, str], None], skip_existing: bool, engine: Engine,
) -> None:  # fmt: skip
    """Deliver a dataset in parts of so many inputs, each made by a worker."""
    from meshonet_cli.batch.parts import PartMaker, deliver_parts, one_after_the_other, parts_of

    files = destination.part_files(make, size)
    work: _Work[T, S, R] = _Work(make, None)
    maker = PartMaker(files, destination.kind, origin.read, work, skip_existing)
    parts = parts_of(origin.inputs, size)
    whole = origin.inputs.shard == (1, 1)
    report = partial(
        deliver_parts, files=files, session=session, written=written, skip_existing=skip_existing, whole=whole
    )
    if engine.here:
        report(one_after_the_other(maker, parts))
        return
    with engine.workers(session.warn) as workers:
        report(workers.in_order(maker, parts, workers.count))


class _Work(Generic[T, S, R]):
    """What is done to members, here or in another process: make, and write each to its own file."""

    def __init__(self, make: Make[T, S, R], destination: Destination | None) -> None:
        self.make, self.destination = make, destination

    def __call__(self, todo: Todo[T]) -> Iterator[Done[S, R]]:
        waiting: deque[tuple[Item[T], str]] = deque()

        def members() -> Iterator[Item[T]]:
            for item, path in todo:
                waiting.append((item, path))
                yield item

        for outcome in self.make(members()):
            item, path = waiting.popleft()
            if isinstance(outcome, InputError) and outcome.source == item.what.name:
                outcome.source = ""  # all that the library knows; the member's label says more
            yield item.without_content(), path, self._written(outcome, item, path)

    def timed(self, todo: Todo[T]) -> tuple[list[Done[S, R]], float]:
        """Return all at once, and the seconds that it took."""
        begun = time.perf_counter()
        return list(self(todo)), time.perf_counter() - begun

    def _written(
        self, outcome: tuple[S, R] | Exception, item: Item[T], path: str
    ) -> tuple[S | None, R] | Exception:
        if isinstance(outcome, Exception):
            return outcome
        what, report = outcome
        report.item = item.without_content()
        if self.destination is None:
            return what, report
        try:
            reached("write")
            with report.timed("write"):
                self.destination.write(path, [what])
        except Exception as error:
            return error
        return None, report


def _made(outcome: tuple[S | None, R] | Exception) -> tuple[S | None, R]:
    if isinstance(outcome, Exception):
        raise outcome
    return outcome


def _paths(
    members: Iterator[Item[T]], destination: Destination, session: Session, skip_existing: bool
) -> Iterator[tuple[Item[T], str]]:
    for item in members:
        with session.member(item.label, item.source):
            path = destination.path(item)
            if skip_existing and path != "-" and Path(path).exists():
                session.skip(item.label, path)
            else:
                yield item, path


def _by_workers(
    work: _Work[T, S, R], todo: Todo[T], engine: Engine, together: int, session: Session
) -> Iterator[Done[S, R]]:
    """Yield in order what workers make of groups of members; a few groups are under way."""
    groups = _Groups(iter(todo), together)
    with engine.workers(session.warn) as workers:
        # where many are made together, their grids are what takes memory
        ahead = workers.count if together == 1 else 1
        for group, outcome in workers.in_order(work.timed, groups, ahead):
            if isinstance(outcome, Exception):
                yield from _apart(work, group, outcome, workers)
            else:
                done, seconds = outcome
                groups.learn(seconds / len(group))
                yield from done


class _Groups(Generic[T]):
    """Members in groups, each a task: of one size, or, if that is 1, of as many as are done in no time."""

    def __init__(self, todo: Iterator[tuple[Item[T], str]], size: int) -> None:
        self._todo, self._size, self._grows = todo, size, size == 1

    def __iter__(self) -> Iterator[list[tuple[Item[T], str]]]:
        while group := list(islice(self._todo, self._size)):
            yield group

    def learn(self, seconds: float) -> None:
        """Take note of how long a member took."""
        if self._grows:
            self._size = max(1, min(_MOST_AT_ONCE, int(_TASK_SECONDS / max(seconds, 1e-6))))


def _apart(
    work: _Work[T, S, R], group: list[tuple[Item[T], str]], error: Exception, workers: Workers
) -> Iterator[Done[S, R]]:
    """Yield what workers make of a group, one by one, of which one ended its worker twice."""
    for item, path in group:
        outcome: tuple[list[Done[S, R]], float] | Exception = error
        if len(group) > 1:
            try:
                outcome = workers.alone(work.timed, [(item, path)])
            except MeshonetError as own:
                outcome = own
        yield from [(item.without_content(), path, outcome)] if isinstance(outcome, Exception) else outcome[0]


def _streamed(
    done: Iterator[Done[S, R]], destination: Destination, session: Session, written: Callable[[R, str], None]
) -> Iterator[S]:
    """Yield what goes into one file; each is reported when the writer comes back for the next one."""
    size = ""
    for item, _, outcome in done:
        what: S | None = None
        with session.member(item.label, item.source):
            made, report = _made(outcome)
            if destination.format.one_size and made is not None:
                size = same_size(made, size)
            what = made
        if what is None:
            continue
        reached("write")
        with report.timed("write"):
            yield what
        written(report, destination.text)
