"""A dataset in parts: a task makes one part of the members of some inputs, and the parts are shown as one."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from meshonet.formats.hdf5.parts import Failed, OtherPartsError, PartFiles, State
from meshonet.geometry.errors import InputError, MeshonetError
from meshonet.solvers.stages import stage
from meshonet_cli.batch.destination import same_size
from meshonet_cli.batch.input_digests import digests_of
from meshonet_cli.batch.item import Item, Make, made
from meshonet_cli.batch.sources import records
from meshonet_cli.terminal.errors import explained

if TYPE_CHECKING:
    from meshonet.formats.registry import Kind
    from meshonet.geometry.blocks.boundary import Boundary
    from meshonet.geometry.blocks.grid import Grid
    from meshonet.geometry.families.draw import Draw
    from meshonet_cli.report.timed import Timed
    from meshonet_cli.terminal.session import Session


@dataclass(frozen=True)
class PartTask:
    """A task: the number of a part, from 0, and the inputs whose members it holds."""

    number: int
    inputs: tuple[str | InputError | Draw, ...]


@dataclass
class PartDone:
    """What became of a part: its file, whether it was there, and a report or an error of each member.

    Of one that was there `lacks` is how many members failed when it was made.
    """

    number: int
    path: str
    state: State
    lacks: int = 0
    members: list[tuple[Item[Any], Timed | Exception]] = field(default_factory=list)


@dataclass(frozen=True)
class PartMaker:
    """Makes parts, in this process or another, and returns no more than reports.

    Parameters
    ----------
    files : where the parts lie.
    kind : what they hold, grids or boundaries.
    read : yields what an input holds.
    work : makes the members.
    skip_existing : whether a part that is there, of the same inputs and settings, stays.
    """

    files: PartFiles
    kind: Kind
    read: Callable[[Any], Iterator[Any]]
    work: Make
    skip_existing: bool = False

    def __call__(self, part: PartTask) -> PartDone:
        """Make a part, whole or not at all.

        Raises OtherPartsError: the part that is there was made of other inputs or with other settings, or is
        not to be skipped; InputError: it cannot be written.
        """
        inputs = [each for entry in part.inputs for each in digests_of(entry)]
        state = self.files.state(part.number, inputs)
        done: PartDone = PartDone(part.number, str(self.files.path(part.number)), state)
        if state != "missing" and not self.skip_existing:
            self.files.refuse(part.number)
        if state == "complete":
            done.lacks = len(self.files.facts(part.number).failed)
            return done
        failed: list[Failed] = []
        self.files.write(part.number, self.kind, self._samples(part, done, failed), inputs, failed)
        return done

    def _samples(self, part: PartTask, done: PartDone, failed: list[Failed]) -> Iterator[Grid | Boundary]:
        """Yield what goes into the part, and note a report or an error of each member on the way."""
        size = ""

        def fail(item: Item[Any], error: Exception) -> None:
            done.members.append((item.without_content(), error))
            again = not isinstance(error, MeshonetError)
            failed.append(Failed(item.source, item.label, explained(error), again))

        def readable() -> Iterator[Item[Any]]:
            for item in records(part.inputs, self.read):
                if isinstance(item.what, Exception):
                    fail(item, item.what)
                else:
                    yield item

        for item, outcome in self.work(readable()):
            try:
                what, report = made(outcome)
                size = same_size(what, size)
            except Exception as error:
                fail(item, error)
                continue
            with stage("write", report.seconds):
                yield what
            done.members.append((item, report))
        done.members.sort(key=lambda member: member[0].index)


Outcomes = Iterator[tuple[PartTask, PartDone | Exception]]


def deliver_parts(
    outcomes: Outcomes, files: PartFiles, session: Session, written: Callable[[Any, str], None], *,
    skip_existing: bool, whole: bool,
) -> None:  # fmt: skip
    """Report every member of parts as they are made, and show the parts as one file.

    A part that fails is reported, and missing in the file until the same command makes it; `written` is
    called with the report of each member that was made, and the path of the file; `whole` says that these
    are all parts, and no shard.

    Raises OtherPartsError: the parts that are there were made of other inputs or with other settings, or are
    not to be skipped.
    """
    files.check(skip_existing=skip_existing)
    session.batch, session.dataset = True, str(files.index)
    last = -1
    for part, done in outcomes:
        last = part.number
        if isinstance(done, OtherPartsError):
            raise done
        if isinstance(done, Exception):
            path = str(files.path(part.number))
            session.fail(path, path, done)
        else:
            _report(done, str(files.index), session, written)
    files.build()
    more = [number for number in files.numbers() if number > last]
    if more and whole:
        session.warn(f"{files.index} also shows parts of an earlier run with more inputs: {len(more)}")


def _report(done: PartDone, index: str, session: Session, written: Callable[[Any, str], None]) -> None:
    if done.state == "complete":
        failed = f"; {done.lacks} of its inputs failed" if done.lacks else ""
        session.skip(done.path, index, failed)
    for item, outcome in done.members:
        session.begin(item.label)
        if isinstance(outcome, Exception):
            session.fail(item.label, item.source, outcome)
        else:
            written(outcome, index)
