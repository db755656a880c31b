"""Seconds and memory on a device, and the time that is left of a run with a limit."""

import time
from collections.abc import Callable
from typing import Any

import torch

from meshonet.solvers.neural.devices import Device

LEFT_OUT = "left out: no time was left"


class Time:
    """The time that is left."""

    def __init__(self, limit: float) -> None:
        self._end = time.perf_counter() + limit

    def suffices(self, seconds: float) -> bool:
        """Return whether `seconds` are left."""
        return time.perf_counter() + seconds < self._end


def most_memory(device: Device, act: Callable[[], Any]) -> tuple[str, Any]:
    """Run; return the most memory that was in use on the device, in MB (a dash on a CPU), and the result."""
    if device == "cpu":
        return "-", act()
    torch.cuda.reset_peak_memory_stats()
    result = act()
    return f"{torch.cuda.max_memory_allocated() / 1e6:.0f}", result


def timed(device: Device, act: Callable[[], Any]) -> tuple[Any, float]:
    """Run after the device is idle and until it is idle again; return the result and the seconds."""
    if device == "cuda":
        torch.cuda.synchronize()
    begun = time.perf_counter()
    result = act()
    if device == "cuda":
        torch.cuda.synchronize()
    return result, time.perf_counter() - begun
