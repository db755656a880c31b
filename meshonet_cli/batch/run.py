"""Runs a batch: every member is read, computed, written and reported."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain, starmap
from pathlib import Path
from typing import TYPE_CHECKING, Any

from meshonet.formats.format import Space
from meshonet.formats.registry import Kind
from meshonet.geometry.errors import InputError
from meshonet.solvers.stages import stage
from meshonet_cli.batch.destination import Destination, same_size
from meshonet_cli.batch.item import Item, Make, Pair, attempted, made
from meshonet_cli.batch.settings import HERE, Engine, Files
from meshonet_cli.batch.sources import assembly, members_of
from meshonet_cli.terminal.session import Session

if TYPE_CHECKING:
    from meshonet.geometry.spacing.sampling import Sampling
    from meshonet_cli.report.timed import Timed

Written = Callable[[Any, str], None]
"""Function that is called with the report and the path of each written member."""


def each(make: Callable[..., tuple[Any, Timed]], **settings: Any) -> Make:
    """Return a function that calls `make`, with these `settings`, for one shape or grid after another."""
    return partial(attempted, partial(make, **settings))


@dataclass(frozen=True)
class BatchTask:
    """What a command does with each input; `read` and `make` may run in other processes."""

    read: Callable[[Any], Iterator[Any]]  # yields the content of an input
    make: Make  # computes the results of members
    kind: Kind = "grids"  # kind of the results
    put: Callable[[Path, Any], None] | None = None  # writes to a path, in place of the format's own function
    nodes: int | None = None  # approximate number of nodes of a result; None if unknown
    space: Space | None = None  # kind of blocks in space of all results; other formats are refused at once
    together: int = 1  # number of members that a process is given at a time
    assembled: Sampling | None = None  # sampling of the far field if all inputs form one domain
    joined: str = ""  # remedy if there are several inputs for an output of one result


@dataclass(frozen=True)
class Batch:
    """A run of a command: its inputs, output, messages and engine."""

    inputs: Any  # `Inputs`, or `DrawnInputs`
    files: Files
    session: Session
    engine: Engine = HERE

    def run(self, task: BatchTask) -> int:
        """Process every member and return the exit code."""
        self.deliver(task, self.session.written)
        return self.session.finish()

    def deliver(self, task: BatchTask, written: Written) -> None:
        """Process each member, write its result, and call `written` with its report.

        A member that fails is reported and left out. With ``skip_existing``, a member whose output exists is
        skipped. Raises InputError if the output cannot be written.
        """
        files, session = self.files, self.session
        destination = Destination(
            files.output, files.to_format, task.kind, task.put,
            part_size=files.part_size, nodes=task.nodes, space=task.space,
        )  # fmt: skip
        several = task.assembled is None and self.inputs.more_than(1)
        if several:
            destination.check_room(task.joined)
        session.check_output(files.output)
        if task.assembled is not None:
            members = assembly(self.inputs, task.read, task.assembled, session)
        elif destination.can_have_parts and (
            size := destination.part_size_for(self.inputs, files, elsewhere=self.engine.elsewhere)
        ):
            self._deliver_parts(task, destination, size, written)
            return
        else:
            session.failures = None if destination.each else destination.failed
            members = members_of(self.inputs, task.read, session)
        leading = next(members, None)
        if leading is None:
            return
        if not leading.only:
            destination.check_several(leading)
        items: Iterator[Item[Any]] = chain([leading], members)
        single = destination.each or not session.batch
        if single:
            items = self._with_paths(items, destination)
        work = MemberWork(task.make, destination if single else None)
        if self.engine.here or not session.batch:
            pairs = work(items)
        else:
            from meshonet_cli.batch.executors.sharing import shared

            pairs = shared(work, items, task.together, self.engine, session.warn)
        if single:
            for item, outcome in pairs:
                with session.member(item.label, item.source):
                    written(made(outcome)[1], item.path)
            return
        session.dataset = destination.text
        stream = self._streamed(pairs, destination, written)
        first = next(stream, None)
        if first is not None:
            destination.write(destination.text, chain([first], stream))

    def _deliver_parts(self, task: BatchTask, destination: Destination, size: int, written: Written) -> None:
        from meshonet_cli.batch.parts import PartMaker, PartTask, deliver_parts

        files = destination.part_files(task.make, size)
        skip = self.files.skip_existing
        maker = PartMaker(files, task.kind, task.read, MemberWork(task.make, None), skip)
        parts, whole = starmap(PartTask, self.inputs.parts(size)), self.inputs.shard == (1, 1)
        report = partial(
            deliver_parts, files=files, session=self.session, written=written, skip_existing=skip, whole=whole
        )
        if self.engine.here:
            report(attempted(maker, parts))
            return
        with self.engine.workers(self.session.warn) as workers:
            report(workers.in_order(maker, parts, workers.count))

    def _with_paths(self, members: Iterator[Item[Any]], destination: Destination) -> Iterator[Item[Any]]:
        """Yield members with the paths of their outputs; members with existing files are skipped."""
        for item in members:
            with self.session.member(item.label, item.source):
                path = destination.path(item)
                if self.files.skip_existing and path != "-" and Path(path).exists():
                    self.session.skip(item.label, path)
                else:
                    yield replace(item, path=path)

    def _streamed(self, pairs: Iterator[Pair], destination: Destination, written: Written) -> Iterator[Any]:
        """Yield the results for a single file; each is reported when the next one is requested."""
        from meshonet_cli.batch.keys import Keys

        size, keys = "", Keys()
        for item, outcome in pairs:
            fits = False
            with self.session.member(item.label, item.source):
                what, report = made(outcome)
                if report.left_out:
                    written(report, destination.text)
                    continue
                if destination.is_dataset:
                    what = keys.named(item, what)
                    report.item = replace(report.item, name=what.name)
                if destination.format.one_size:
                    size = same_size(what, size)
                fits = True
            if not fits:
                continue
            with stage("write", report.seconds):
                yield what
            written(report, destination.text)


@dataclass(frozen=True)
class MemberWork:
    """Function that computes results for members of a batch, in any process, and writes a file for each."""

    make: Make
    destination: Destination | None

    def __call__(self, todo: Iterable[Item[Any]]) -> Iterator[Pair]:
        """Yield members, without their content, and their results."""
        for item, made_of in self.make(todo):
            outcome, bare = made_of, item.without_content()
            if isinstance(outcome, InputError) and outcome.source == item.name:
                outcome.source = ""  # all that the library knows; the member's label says more
            elif not isinstance(outcome, Exception):
                what, report = outcome
                report.item = bare
                if report.left_out and self.destination is not None:
                    outcome = None, report
                elif self.destination is not None:
                    try:
                        if self.destination.format.name == "openfoam":
                            from meshonet.geometry.quality.report import with_checkmesh_notes

                            report.notes = with_checkmesh_notes(report.notes, what)
                        if self.destination.is_dataset:
                            from meshonet_cli.batch.keys import Keys

                            what = Keys().named(item, what)
                            report.item = replace(bare, name=what.name)
                        with stage("write", report.seconds):
                            self.destination.write(item.path, [what])
                        outcome = None, report
                    except Exception as error:
                        outcome = error
            yield bare, outcome
