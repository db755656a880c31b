"""Processor seconds of a call: those of other programs on the machine do not count."""

import time
from collections.abc import Callable
from typing import TypeVar

T = TypeVar("T")


def clocked(call: Callable[[], T], runs: int = 1) -> tuple[float, T]:
    """Return the least processor seconds of some runs of `call`, and its last result."""
    spent = []
    for _ in range(runs):
        begun = time.process_time()
        result = call()
        spent.append(time.process_time() - begun)
    return min(spent), result
