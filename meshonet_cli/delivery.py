"""From members to files: one file each, or all in one, each told of when it is written."""

from __future__ import annotations

import contextlib
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import chain, islice
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet_cli.batch import Destination
from meshonet_cli.member import Item, Named
from meshonet_cli.report import Timed
from meshonet_cli.session import Session

T = TypeVar("T", bound=Named)
S = TypeVar("S", bound=Grid | Boundary)
R = TypeVar("R", bound=Timed)
Make = Callable[[Item[T]], tuple[S, R]]
Todo = Iterator[tuple[Item[T], str]]
"""Members and the paths of their files."""


def prepare(sources: Sequence[str], destination: Destination, session: Session) -> None:
    """Raise InputError when `destination` cannot take what `sources` and `session` will give it."""
    destination.check_room(sources)
    session.check_output(destination.text)


def deliver(
    found: Iterator[Item[T]],
    make: Make[T, S, R],
    destination: Destination,
    session: Session,
    tell: Callable[[R, str], None],
    *,
    skip_existing: bool = False,
    ahead: Callable[[Todo[T]], Todo[T]] | None = None,
    together: int = 1,
    jobs: int = 1,
) -> None:
    """Make something of every member of `found`, write it to `destination`, and tell of it.

    A member that fails is told of and left out. Memory holds one member, or a few (groups) for each job.

    Parameters
    ----------
    make : returns what to write and a report, whose stage ``write`` is timed here; with several jobs it
        must be something that can be pickled.
    tell : is given the report and the path when the member is written.
    skip_existing : pass over members whose own file is there.
    ahead : passes on what is to be made, and may look at several members before it does; with several jobs
        it must be something that can be pickled.
    together : members that go to one of several jobs at a time, for `ahead` to look at.
    jobs : processes that make, and write when every member has its own file.
    """
    leading = next(found, None)
    if leading is None:
        return
    destination.check_only(leading)
    found = chain([leading], found)
    each = destination.each or not session.batch
    work = _Work(make, destination if each else None)
    jobs = jobs if session.batch else 1
    with _executor(jobs) as pool:
        todo = _paths(found, destination, session, skip_existing) if each else ((item, "") for item in found)
        if ahead is not None and jobs > 1:
            done = _in_groups(todo, partial(_each, work, ahead), pool, jobs, together)
        else:
            done = _under_way(ahead(todo) if ahead is not None else todo, work, pool, jobs)
        if each:
            for item, path, future in done:
                with session.member(item.label, item.source):
                    tell(future.result()[1], path)
            return
        stream = _streamed(done, destination, session, tell)
        first = next(stream, None)
        if first is not None:
            destination.write(destination.text, chain([first], stream))


class _Work(Generic[T, S, R]):
    """What is done to one member, here or in another process: make it, and write it to its own file."""

    def __init__(self, make: Make[T, S, R], destination: Destination | None) -> None:
        self.make, self.destination = make, destination

    def __call__(self, item: Item[T], path: str) -> tuple[S | None, R]:
        try:
            what, report = self.make(item)
        except InputError as error:
            if error.source == item.what.name:  # all that the library knows; the member's label says more
                error.source = ""
            raise
        report.item = item.without_content()
        if self.destination is None:
            return what, report
        with report.timed("write"):
            self.destination.write(path, [what])
        return None, report


def _paths(
    found: Iterator[Item[T]], destination: Destination, session: Session, skip_existing: bool
) -> Todo[T]:
    for item in found:
        with session.member(item.label, item.source):
            path = destination.path(item)
            if skip_existing and path != "-" and Path(path).exists():
                session.skip(item.label, path)
            else:
                yield item, path


def _under_way(
    todo: Todo[T], work: _Work[T, S, R], pool: Pool, jobs: int
) -> Iterator[tuple[Item[Any], str, Promise]]:
    """Yield members in order with their work, of which up to two for each job are under way."""
    waiting: deque[tuple[Item[Any], str, Promise]] = deque()
    for item, path in todo:
        waiting.append((item.without_content(), path, pool.submit(work, item, path)))
        while len(waiting) >= (1 if jobs == 1 else 2 * jobs):
            yield waiting.popleft()
    while waiting:
        yield waiting.popleft()


def _in_groups(
    todo: Todo[T], work: Callable[[list[tuple[Item[T], str]]], list[Any]], pool: Pool, jobs: int, most: int
) -> Iterator[tuple[Item[Any], str, Promise]]:
    """Do as `_under_way`, `most` members at a time in one job; one group more than jobs is under way."""
    waiting: deque[list[tuple[Item[Any], str, Promise]]] = deque()
    while group := list(islice(todo, most)):
        promise = pool.submit(work, group)
        waiting.append(
            [(item.without_content(), path, _Share(promise, k)) for k, (item, path) in enumerate(group)]
        )
        if len(waiting) > jobs:
            yield from waiting.popleft()
    yield from chain.from_iterable(waiting)


def _each(
    work: _Work[T, S, R], ahead: Callable[[Todo[T]], Todo[T]], group: list[tuple[Item[T], str]]
) -> list[tuple[S | None, R] | Exception]:
    """Return what `work` makes of each member of a group, or what went wrong with it."""
    made: list[tuple[S | None, R] | Exception] = []
    for item, path in ahead(iter(group)):
        try:
            made.append(work(item, path))
        except Exception as error:  # raised where the member is told of
            made.append(error)
    return made


def _streamed(
    done: Iterator[tuple[Item[Any], str, Promise]],
    destination: Destination,
    session: Session,
    tell: Callable[[R, str], None],
) -> Iterator[Grid | Boundary]:
    """Yield what goes into one file; each is told of when the writer comes back for the next one."""
    size: tuple[int, int, str] | None = None
    for item, _, future in done:
        made = None
        with session.member(item.label, item.source):
            result = future.result()
            if destination.format.one_size:
                size = _same_size(result[0], size)
            made = result
        if made is None:
            continue
        what, report = made
        with report.timed("write"):
            yield what
        tell(report, destination.text)


def _same_size(what: Grid | Boundary, size: tuple[int, int, str] | None) -> tuple[int, int, str]:
    own = (what.ni, what.nj, what.topology)
    if size is not None and own != size:
        raise InputError(
            "{}x{} {} does not fit a dataset of {}x{} {}".format(*own, *size),
            "set --res and --topology, or write one file each",
        )
    return own


class Promise(Protocol):
    """Work that is done, or will be when it is asked for."""

    def result(self) -> Any:
        """Return what came of it; raise what went wrong."""
        ...


class _Share:
    """One of the things that a promise holds."""

    def __init__(self, promise: Promise, k: int) -> None:
        self._promise, self._k = promise, k

    def result(self) -> Any:
        found = self._promise.result()[self._k]
        if isinstance(found, Exception):
            raise found
        return found


class Pool(Protocol):
    """Something that does work, like the executors of `concurrent.futures`."""

    def __enter__(self) -> Any: ...

    def __exit__(self, *error: Any) -> Any: ...

    def submit(self, fn: Callable[..., Any], /, *args: Any) -> Promise:
        """Return the promise of ``fn(*args)``."""
        ...


class _Later:
    def __init__(self, fn: Callable[..., Any], args: tuple[Any, ...]) -> None:
        self._fn, self._args = fn, args

    def result(self) -> Any:
        return self._fn(*self._args)


class _Here(contextlib.AbstractContextManager["_Here"]):
    """Does the work in this process, when its result is asked for."""

    def __exit__(self, *error: Any) -> None:
        return None

    def submit(self, fn: Callable[..., Any], /, *args: Any) -> Promise:
        return _Later(fn, args)


def _executor(jobs: int) -> Pool:
    if jobs == 1:
        return _Here()
    from meshonet_cli.processes import Processes  # and with it concurrent.futures: 10 ms

    return Processes(jobs)
