"""Distributes the members of a batch over workers; fast members are grouped into one task."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING, Any

from meshonet.geometry.errors import MeshonetError
from meshonet_cli.batch.executors.workers import Warn, Workers
from meshonet_cli.batch.item import Item, Pair

if TYPE_CHECKING:
    from meshonet_cli.batch.settings import Engine

_TASK_SECONDS, _MOST_AT_ONCE = 0.1, 64  # how long tasks of several members are, and how large
Group = list[Item[Any]]


@dataclass(frozen=True)
class _Timed:
    """Works on a group of members, and measures the time."""

    work: Callable[[Iterable[Item[Any]]], Iterator[Pair]]

    def __call__(self, todo: Group) -> tuple[list[Pair], float]:
        begun = time.perf_counter()
        return list(self.work(todo)), time.perf_counter() - begun


def shared(
    work: Callable[[Iterable[Item[Any]]], Iterator[Pair]], todo: Iterator[Item[Any]], size: int,
    engine: Engine, warn: Warn,
) -> Iterator[Pair]:  # fmt: skip
    """Yield each member of the batch `todo` with its result; `work` runs on the workers of `engine`.

    Members keep the order of `todo`. A worker gets `size` members at a time, with one exception: if `size`
    is 1, it gets as many as take about 0.1 s.
    """
    timed, grows, most = _Timed(work), size == 1, size

    def groups() -> Iterator[Group]:
        while group := list(islice(todo, most)):
            yield group

    with engine.workers(warn) as workers:
        # where many are made together, their grids are what takes memory
        for group, outcome in workers.in_order(timed, groups(), workers.count if grows else 1):
            if isinstance(outcome, Exception):
                yield from _apart(timed, group, outcome, workers)
                continue
            done, seconds = outcome
            if grows:
                each = max(seconds / len(group), 1e-6)
                most = max(1, min(_MOST_AT_ONCE, int(_TASK_SECONDS / each)))
            yield from done


def _apart(timed: _Timed, group: Group, error: Exception, workers: Workers) -> Iterator[Pair]:
    """Yield the members of a group one by one, after the group ended its worker twice."""
    for item in group:
        pairs: list[Pair] = [(item.without_content(), error)]
        if len(group) > 1:
            try:
                pairs, _ = workers.alone(timed, [item])
            except MeshonetError as own:
                pairs = [(item.without_content(), own)]
        yield from pairs
