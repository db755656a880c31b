"""From members to files: one file each, or all in one, each reported when it is written."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, islice
from pathlib import Path
from typing import TYPE_CHECKING, Generic, TypeVar

from meshonet.formats.format import size_of
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet_cli.batch.destination import Destination
from meshonet_cli.batch.item import Item, Name, Named
from meshonet_cli.batch.timed import Timed
from meshonet_cli.session import Session

if TYPE_CHECKING:
    from concurrent.futures import Future

    from meshonet.geometry.layout.layout import Layout

T = TypeVar("T", bound=Named)
S = TypeVar("S", bound="Grid | Boundary | Layout")
R = TypeVar("R", bound=Timed)
Make = Callable[[Iterable[Item[T]]], Iterator[tuple[S, R] | Exception]]
"""Yields for each member, in order, what to write and a report, or the error that it ended in."""
Todo = Iterable[tuple[Item[T], str]]  # members and the paths of their files
Done = tuple[Item[Name], str, tuple[S | None, R] | Exception]


def prepare(sources: Sequence[str], destination: Destination, session: Session) -> None:
    """Raise InputError when `destination` cannot take what `sources` and `session` will give it."""
    destination.check_room(sources)
    session.check_output(destination.text)


def process(
    sources: Sequence[str], members: Iterator[Item[T]], make: Callable[[Item[T]], tuple[S, R]],
    destination: Destination, session: Session, *, skip_existing: bool = False, jobs: int = 1,
) -> int:  # fmt: skip
    """Make something of each of the `members` of `sources`, deliver it, and return the exit code."""
    prepare(sources, destination, session)
    deliver(
        members, one_by_one(make), destination, session, session.written,
        skip_existing=skip_existing, jobs=jobs,
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
    members: Iterator[Item[T]], make: Make[T, S, R], destination: Destination, session: Session,
    written: Callable[[R, str], None], *, skip_existing: bool = False, together: int = 1, jobs: int = 1,
) -> None:  # fmt: skip
    """Make something of every member of `members`, write it to `destination`, and report it.

    A member that fails is reported and left out. `make` yields what to write, and reports whose stage
    ``write`` is timed here; with several `jobs` (processes), which get so many members `together`, it must be
    something that can be pickled. `written` is called with the report and the path of each; with
    `skip_existing` members whose own file is there are passed over.
    """
    leading = next(members, None)
    if leading is None:
        return
    destination.check_only(leading)
    members = chain([leading], members)
    each = destination.each or not session.batch
    todo = _paths(members, destination, session, skip_existing) if each else ((item, "") for item in members)
    work = _Work(make, destination if each else None)
    done = _in_processes(work, todo, jobs, together) if jobs > 1 and session.batch else work(todo)
    if each:
        for item, path, outcome in done:
            with session.member(item.label, item.source):
                written(_made(outcome)[1], path)
        return
    stream = _streamed(done, destination, session, written)
    first = next(stream, None)
    if first is not None:
        destination.write(destination.text, chain([first], stream))


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

    def listed(self, todo: Todo[T]) -> list[Done[S, R]]:
        """Return all at once."""
        return list(self(todo))

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


def _in_processes(work: _Work[T, S, R], todo: Todo[T], jobs: int, together: int) -> Iterator[Done[S, R]]:
    """Yield in order what processes make of groups of members; a few groups are under way."""
    from meshonet_cli.batch.processes import processes  # and with it concurrent.futures: 10 ms

    todo = iter(todo)
    most = 2 * jobs if together == 1 else jobs + 1
    waiting: deque[tuple[list[tuple[Item[T], str]], Future[list[Done[S, R]]]]] = deque()
    with processes(jobs) as pool:
        while group := list(islice(todo, together)):
            waiting.append((group, pool.submit(work.listed, group)))
            if len(waiting) >= most:
                yield from _of_group(*waiting.popleft())
        while waiting:
            yield from _of_group(*waiting.popleft())


def _of_group(group: Sequence[tuple[Item[T], str]], future: Future[list[Done[S, R]]]) -> Sequence[Done[S, R]]:
    try:
        return future.result()
    except Exception as error:  # the process itself is gone
        return [(item.without_content(), path, error) for item, path in group]


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
                size = _same_size(made, size)
            what = made
        if what is None:
            continue
        with report.timed("write"):
            yield what
        written(report, destination.text)


def _same_size(what: Grid | Boundary | Layout, size: str) -> str:
    if not isinstance(what, Grid | Boundary):  # files of layouts hold one
        return ""
    own = size_of(what)
    if size and own != size:
        problem = f"{own} does not fit a dataset of {size}"
        raise InputError(problem, "set {res} and {topology}, or write one file each")
    return own
