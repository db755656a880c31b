"""Threads that help each other: a thread without work takes jobs of other threads.

Whoever calls `run` takes one job after the other, as do helpers; what a job runs in turn is open in the same
way.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from threading import Condition, Thread
from typing import Any, Self


class _Jobs:
    """Jobs that are begun in their order; after an error no others are."""

    def __init__(self, jobs: Sequence[Callable[[], Any]]) -> None:
        self.jobs, self.begun, self.left = jobs, 0, len(jobs)
        self.made: list[Any] = [None] * len(jobs)
        self.errors: dict[int, BaseException] = {}

    def end(self, number: int, error: BaseException | None) -> None:
        self.left -= 1
        if error is not None:
            self.errors[number] = error
            self.left -= len(self.jobs) - self.begun
            self.begun = len(self.jobs)


class Helpers:
    """At most `most` threads that help the calling thread; they start when there are jobs."""

    def __init__(self, most: int) -> None:
        self._most, self._idle = most, 0
        self._threads: list[Thread] = []
        self._change = Condition()
        self._open: list[_Jobs] = []
        self._over = False

    @classmethod
    @contextmanager
    def at_hand(cls, most: int) -> Iterator[Self]:
        """Provide helper threads within the ``with`` block; they are stopped at its end."""
        helpers = cls(most)
        try:
            yield helpers
        finally:
            with helpers._change:
                helpers._over = True
                helpers._change.notify_all()
            for thread in helpers._threads:
                thread.join()

    def run(self, jobs: Sequence[Callable[[], Any]]) -> list[Any]:
        """Return the results of all `jobs`, in the given order; raise the error of the first failed job."""
        own = _Jobs(jobs)
        with self._change:
            self._open.append(own)
            self._change.notify_all()
            wanted = min(len(jobs) - 1 - self._idle, self._most - len(self._threads))
            more = [Thread(target=self._take_part, args=(None,), daemon=True) for _ in range(wanted)]
            self._threads += more
        for thread in more:
            thread.start()
        try:
            self._take_part(own)
        finally:
            with self._change:
                self._open.remove(own)
        if own.errors:
            raise own.errors[min(own.errors)]
        return own.made

    def _take_part(self, own: _Jobs | None) -> None:
        """Do open jobs until `own` are done; None: until all is over."""
        while taken := self._next(own):
            jobs, number = taken
            error = None
            try:
                jobs.made[number] = jobs.jobs[number]()
            except BaseException as raised:
                error = raised
            with self._change:
                jobs.end(number, error)
                if jobs.left == 0:
                    self._change.notify_all()

    def _next(self, own: _Jobs | None) -> tuple[_Jobs, int] | None:
        """Return the next job, of `own` or opened later, None at the end; earlier ones would take longer."""
        with self._change:
            while not (self._over if own is None else own.left == 0):
                first = 0 if own is None else self._open.index(own)
                for jobs in self._open[first:]:
                    if jobs.begun < len(jobs.jobs):
                        jobs.begun += 1
                        return jobs, jobs.begun - 1
                self._idle += 1
                self._change.wait()
                self._idle -= 1
            return None
