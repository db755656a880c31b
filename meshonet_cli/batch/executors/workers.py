"""Workers behind an executor: tasks done in order, a few under way; what a dead worker had is done again."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future
from typing import TypeVar

from meshonet.geometry.errors import InputError, MeshonetError

T = TypeVar("T")
R = TypeVar("R")
Warn = Callable[[str], None]
_PATIENCE = 0.5  # seconds between looks at the engine while a result is waited for


class WorkerDiedError(MeshonetError):
    """The worker died, and the one that did the same task after it too."""

    exit_code = 3

    def __init__(self) -> None:
        super().__init__(
            "the process at work on it died twice, for want of memory perhaps; use a smaller {res} or fewer "
            "{jobs}"
        )


class EngineLostError(InputError):
    """The executor is gone for good, and with it what was under way."""


class Workers:
    """An executor and what is known of its workers; the base of engines that need to know more.

    Parameters
    ----------
    executor : does the tasks.
    count : tasks that it works on at a time.
    """

    def __init__(self, executor: Executor, count: int) -> None:
        self.executor, self.count = executor, count

    def submit(self, function: Callable[[T], R], task: T) -> Future[R]:
        """Have a worker do a task."""
        return self.executor.submit(function, task)

    def check(self) -> None:
        """Say what became of workers; raises EngineLostError when there is nobody left to wait for."""

    def renew(self) -> None:
        """Replace an executor that broke. Raises EngineLostError: it cannot be replaced."""
        raise self.lost()

    def lost(self) -> EngineLostError:
        """Return the error of an executor that is gone for good."""
        return EngineLostError("the workers are gone", "run it again, with {skip_existing}")

    def result(self, future: Future[R]) -> R:
        """Return the result of a task, or raise what it ended in."""
        while True:
            self.check()
            try:
                return future.result(_PATIENCE)
            except TimeoutError:
                if future.done():
                    raise
            except CancelledError as error:
                self.check()
                raise self.lost() from error

    def in_order(
        self, function: Callable[[T], R], tasks: Iterable[T], ahead: int
    ) -> Iterator[tuple[T, R | Exception]]:
        """Yield each of the `tasks` and the result of `function`, or the error that it ended in.

        Tasks are taken as results are, and `ahead` more than there are workers.
        """
        under_way: deque[tuple[T, Future[R]]] = deque()
        for task in tasks:
            self._put(function, task, under_way)
            if len(under_way) >= self.count + ahead:
                done = self._next(function, under_way)
                yield done
        while under_way:
            left = self._next(function, under_way)
            yield left

    def alone(self, function: Callable[[T], R], task: T) -> R:
        """Return the result of a task done while nothing else is. Raises WorkerDiedError: its worker died."""
        try:
            return self.result(self.submit(function, task))
        except BrokenExecutor as error:
            self.renew()
            raise WorkerDiedError from error

    def _put(self, function: Callable[[T], R], task: T, under_way: deque[tuple[T, Future[R]]]) -> None:
        try:
            future = self.submit(function, task)
        except BrokenExecutor:
            self._do_again(function, under_way)
            future = self.submit(function, task)
        under_way.append((task, future))

    def _next(
        self, function: Callable[[T], R], under_way: deque[tuple[T, Future[R]]]
    ) -> tuple[T, R | Exception]:
        task, future = under_way[0]
        try:
            outcome: R | Exception = self.result(future)
        except EngineLostError:
            raise
        except BrokenExecutor:
            self._do_again(function, under_way)
            return self._next(function, under_way)
        except Exception as error:
            outcome = error
        under_way.popleft()
        return task, outcome

    def _do_again(self, function: Callable[[T], R], under_way: deque[tuple[T, Future[R]]]) -> None:
        """Do once more what was under way when a worker died: one by one, to know which of them it is."""
        self.renew()
        for k, (task, future) in enumerate(under_way):
            if isinstance(future.exception(), BrokenExecutor):
                again: Future[R] = Future()
                try:
                    again.set_result(self.alone(function, task))
                except EngineLostError:
                    raise
                except Exception as error:
                    again.set_exception(error)
                under_way[k] = task, again
