"""Tasks for workers in other processes, some of which end them."""

import os
import signal
from pathlib import Path


def double(number: int) -> int:
    """Return twice the number; 3 is refused."""
    if number == 3:
        raise ValueError("three")
    return 2 * number


def deadly_once(task: tuple[int, str]) -> int:
    """Return the number; the first worker that gets 2 is killed, and leaves the file behind."""
    number, mark = task
    if number == 2 and not Path(mark).exists():
        Path(mark).touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def deadly(number: int) -> int:
    """Return the number; every worker that gets 2 is killed."""
    if number == 2:
        os.kill(os.getpid(), signal.SIGKILL)
    return number
