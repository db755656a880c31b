"""Workers behind an executor: ordered results, and repetition after a worker died."""

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
    """Error: two workers died while they worked on the same task."""

    exit_code = 3

    def __init__(self) -> None:
        super().__init__(
            "the process at work on it died twice, for want of memory perhaps; use a smaller {res} or fewer "
            "{jobs}"
        )


class EngineLostError(InputError):
    """Error: all workers and their tasks are lost."""


class Workers:
    """Processes that compute tasks; base class for processes here and on other machines.

    Parameters
    ----------
    executor : runs the tasks.
    count : number of tasks that run at the same time.
    """

    def __init__(self, executor: Executor, count: int) -> None:
        self.executor, self.count = executor, count

    def submit(self, function: Callable[[T], R], task: T) -> Future[R]:
        """Give a task to a worker and return its future."""
        return self.executor.submit(function, task)

    def check(self) -> None:
        """Report dead workers. Raises EngineLostError if no worker is left."""

    def renew(self) -> None:
        """Replace an executor whose worker died. Raises EngineLostError if this is impossible."""
        raise self.lost()

    def lost(self) -> EngineLostError:
        """Return the error for lost workers."""
        return EngineLostError("the workers are gone", "run the command again, with {skip_existing}")

    def result(self, future: Future[R]) -> R:
        """Wait for the result of a task and return it, or raise the error of the task."""
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
        """Yield each of the `tasks`, in order, with the result of `function` or its error.

        At most `count` + `ahead` tasks are in progress or wait to be yielded.
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
        """Return the result of a task while no other task runs. Raises WorkerDiedError: its worker died."""
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
        """Repeat the tasks in progress at the death of a worker, one by one, to find its cause."""
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
