"""Datasets in parts: each task computes one part, and an index presents all as one dataset."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from meshonet.formats.hdf5.parts import Failed, OtherPartsError, PartFiles, State
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError, MeshonetError
from meshonet.solvers.stages import stage
from meshonet_cli.batch.destination import same_size
from meshonet_cli.batch.input_digests import digests_of
from meshonet_cli.batch.item import Item, Make, made
from meshonet_cli.batch.keys import Keys
from meshonet_cli.batch.sources import records
from meshonet_cli.terminal.errors import explained

if TYPE_CHECKING:
    from meshonet.formats.registry import Kind
    from meshonet.geometry.families.draw import Draw
    from meshonet_cli.report.timed import Timed
    from meshonet_cli.terminal.session import Session


@dataclass(frozen=True)
class PartTask:
    """Task of making one file (part) of a dataset: the number of the part, from 0, and the inputs for it."""

    number: int
    inputs: tuple[str | InputError | Draw, ...]


@dataclass
class PartDone:
    """Result of making one file (part) of a dataset, with a report or an error for each of its grids."""

    number: int  # of the part
    path: str  # of its file
    state: State  # whether the file existed before
    lacks: int = 0  # number of failed members of a part that existed before
    members: list[tuple[Item[Any], Timed | Exception]] = field(default_factory=list)  # reports or errors


@dataclass(frozen=True)
class PartMaker:
    """Makes parts of a dataset, in this process or another."""

    files: PartFiles  # paths of the parts
    kind: Kind  # grids or boundaries
    read: Callable[[Any], Iterator[Any]]  # yields the content of an input
    work: Make  # computes the results of members
    skip_existing: bool = False  # whether an existing part with the same inputs and settings is kept

    def __call__(self, part: PartTask) -> PartDone:
        """Make a part atomically.

        Raises OtherPartsError if it exists (with `skip_existing`, if different), InputError if writing fails.
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
        """Yield the samples of the part; record a report or an error for each member."""
        size, keys = "", Keys()

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
                if report.left_out:
                    failed.append(Failed(*report.failure))
                    done.members.append((item, report))
                    continue
                what = keys.named(item, what)
                report.item = replace(report.item, name=what.name)
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
    """Report the members of each part (file of a dataset) when it is complete; write the index of all parts.

    A part that fails is reported. It is missing from the index until the command is repeated.

    Parameters
    ----------
    written : called with the report of each successful member and the path of the file.
    whole : whether this command makes all parts, not only a share of them.

    Raises OtherPartsError if a part exists; with `skip_existing`, only if its inputs or settings differ.
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
