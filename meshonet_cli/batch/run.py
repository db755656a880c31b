"""From inputs to files: every member is read, made, written and reported; one file each, or all in one."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain, islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

from meshonet.formats.registry import Kind
from meshonet.geometry.errors import InputError, MeshonetError
from meshonet.solvers.stages import reached
from meshonet_cli.batch.destination import Destination, same_size
from meshonet_cli.batch.executors.engine import HERE, Engine
from meshonet_cli.batch.files import Files
from meshonet_cli.batch.item import Item, Make, Outcome, Pair, made
from meshonet_cli.batch.sources import assembly, members_of
from meshonet_cli.terminal.session import Session

if TYPE_CHECKING:
    from meshonet.geometry.spacing.sampling import Sampling
    from meshonet_cli.batch.executors.workers import Workers
    from meshonet_cli.report.timed import Timed

_TASK_SECONDS, _MOST_AT_ONCE = 0.1, 64  # how long tasks of several members are, and how large
Written = Callable[[Any, str], None]
"""Takes the report and the path of each member that is written."""


def each(make: Callable[..., tuple[Any, Timed]], **settings: Any) -> Make:
    """Return what makes members one by one by a function of a member and `settings`."""
    return partial(_one_by_one, make=partial(make, **settings))


def _one_by_one(members: Iterable[Item[Any]], make: Callable[..., tuple[Any, Timed]]) -> Iterator[Pair]:
    for member in members:
        try:
            yield member, make(member)
        except Exception as error:
            yield member, error


@dataclass(frozen=True)
class BatchTask:
    """What a command does to each of its inputs; `read` and `make` go to other processes too.

    Parameters
    ----------
    read : yields what an input holds.
    make : makes members.
    kind : what is written.
    put : writes to a path, in place of the format's own function.
    nodes : of what is made, about; None where that is not known.
    together : members that one of several processes gets at a time.
    assembled : how the far field is sampled where all inputs together make one domain.
    """

    read: Callable[[Any], Iterator[Any]]
    make: Make
    kind: Kind = "grids"
    put: Callable[[Path, Any], None] | None = None
    nodes: int | None = None
    together: int = 1
    assembled: Sampling | None = None


@dataclass(frozen=True)
class Batch:
    """A run of a command: its inputs, where results go, what is printed, and who works on it."""

    inputs: Any  # `Inputs`, or `DrawnInputs`
    files: Files
    session: Session
    engine: Engine = HERE

    def run(self, task: BatchTask) -> int:
        """Do a task to every member and return the exit code."""
        self.deliver(task, self.session.written)
        return self.session.finish()

    def deliver(self, task: BatchTask, written: Written) -> None:
        """Do a task to every member, write what comes of it, and report it by `written`.

        A member that fails is reported and left out. With ``skip_existing`` members whose own file is there
        are passed over.

        Raises InputError: results cannot go there.
        """
        files, session = self.files, self.session
        destination = Destination(
            files.output, files.to_format, task.kind, task.put, part_size=files.part_size, nodes=task.nodes
        )
        several = task.assembled is None and self.inputs.more_than(1)
        destination.check_room(several=several)
        session.check_output(files.output)
        if task.assembled is not None:
            members = assembly(self.inputs, task.read, task.assembled, session)
        elif size := destination.part_size_for(
            self.inputs, skip_existing=files.skip_existing, elsewhere=self.engine.elsewhere
        ):
            self._deliver_parts(task, destination, size, written)
            return
        else:
            members = members_of(self.inputs, task.read, session)
        leading = next(members, None)
        if leading is None:
            return
        destination.check_only(leading)
        items = chain([leading], members)
        if destination.each or not session.batch:
            for item, outcome in self._pairs(task, self._with_paths(items, destination), destination):
                with session.member(item.label, item.source):
                    written(made(outcome)[1], item.path)
            return
        stream = self._streamed(self._pairs(task, items, None), destination, written)
        first = next(stream, None)
        if first is not None:
            destination.write(destination.text, chain([first], stream))

    def _deliver_parts(self, task: BatchTask, destination: Destination, size: int, written: Written) -> None:
        """Deliver a dataset in parts of so many inputs, each made by a worker."""
        from meshonet_cli.batch.parts import PartMaker, deliver_parts, one_after_the_other, parts_of

        files = destination.part_files(task.make, size)
        skip = self.files.skip_existing
        maker = PartMaker(files, task.kind, task.read, _MemberWork(task.make, None), skip)
        parts, whole = parts_of(self.inputs, size), self.inputs.shard == (1, 1)
        report = partial(
            deliver_parts, files=files, session=self.session, written=written, skip_existing=skip, whole=whole
        )
        if self.engine.here:
            report(one_after_the_other(maker, parts))
            return
        with self.engine.workers(self.session.warn) as workers:
            report(workers.in_order(maker, parts, workers.count))

    def _with_paths(self, members: Iterator[Item[Any]], destination: Destination) -> Iterator[Item[Any]]:
        """Yield members with the paths of their own files; those that are there are passed over."""
        for item in members:
            with self.session.member(item.label, item.source):
                path = destination.path(item)
                if self.files.skip_existing and path != "-" and Path(path).exists():
                    self.session.skip(item.label, path)
                else:
                    yield replace(item, path=path)

    def _pairs(
        self, task: BatchTask, todo: Iterator[Item[Any]], destination: Destination | None
    ) -> Iterator[Pair]:
        """Yield members in order and what comes of each, by workers where there are several."""
        work = _MemberWork(task.make, destination)
        if self.engine.here or not self.session.batch:
            yield from work(todo)
            return
        groups = _Groups(todo, task.together)
        with self.engine.workers(self.session.warn) as workers:
            # where many are made together, their grids are what takes memory
            ahead = workers.count if task.together == 1 else 1
            for group, outcome in workers.in_order(work.timed, groups, ahead):
                if isinstance(outcome, Exception):
                    yield from _apart(work, group, outcome, workers)
                else:
                    done, seconds = outcome
                    groups.learn(seconds / len(group))
                    yield from done

    def _streamed(self, pairs: Iterator[Pair], destination: Destination, written: Written) -> Iterator[Any]:
        """Yield what goes into one file; each is reported when the writer comes back for the next one."""
        size = ""
        for item, outcome in pairs:
            fits = False
            with self.session.member(item.label, item.source):
                what, report = made(outcome)
                if destination.format.one_size:
                    size = same_size(what, size)
                fits = True
            if not fits:
                continue
            reached("write")
            with report.timed("write"):
                yield what
            written(report, destination.text)


@dataclass(frozen=True)
class _MemberWork:
    """What is done to members, here or in another process: make, and write each to its own file."""

    make: Make
    destination: Destination | None

    def __call__(self, todo: Iterable[Item[Any]]) -> Iterator[Pair]:
        for item, outcome in self.make(todo):
            if isinstance(outcome, InputError) and outcome.source == item.what.name:
                outcome.source = ""  # all that the library knows; the member's label says more
            yield item.without_content(), self._written(outcome, item)

    def timed(self, todo: Iterable[Item[Any]]) -> tuple[list[Pair], float]:
        """Return all at once, and the seconds that it took."""
        begun = time.perf_counter()
        return list(self(todo)), time.perf_counter() - begun

    def _written(self, outcome: Outcome, item: Item[Any]) -> Outcome:
        if isinstance(outcome, Exception):
            return outcome
        what, report = outcome
        report.item = item.without_content()
        if self.destination is None:
            return what, report
        try:
            reached("write")
            with report.timed("write"):
                self.destination.write(item.path, [what])
        except Exception as error:
            return error
        return None, report


class _Groups:
    """Members in groups, each a task: of one size, or, if that is 1, of as many as are done in no time."""

    def __init__(self, todo: Iterator[Item[Any]], size: int) -> None:
        self._todo, self._size, self._grows = todo, size, size == 1

    def __iter__(self) -> Iterator[list[Item[Any]]]:
        while group := list(islice(self._todo, self._size)):
            yield group

    def learn(self, seconds: float) -> None:
        """Take note of how long a member took."""
        if self._grows:
            self._size = max(1, min(_MOST_AT_ONCE, int(_TASK_SECONDS / max(seconds, 1e-6))))


def _apart(work: _MemberWork, group: list[Item[Any]], error: Exception, workers: Workers) -> Iterator[Pair]:
    """Yield what workers make of a group, one by one, of which one ended its worker twice."""
    for item in group:
        pairs: list[Pair] = [(item.without_content(), error)]
        if len(group) > 1:
            try:
                pairs, _ = workers.alone(work.timed, [item])
            except MeshonetError as own:
                pairs = [(item.without_content(), own)]
        yield from pairs
