"""Interrupts that are not lost: Python drops an exception that a signal raises inside a clean-up callback.

The handlers raise at once, as Python's own does, and also remember; `check`, called between the members of a
batch, raises what was dropped.
"""

import signal
import sys
import warnings
from types import FrameType
from typing import Any, NoReturn

LINES: list[Any] = []
"""Lines on the terminal that are drawn by threads, to be stopped when the program ends, however it does."""

_asked: list[BaseException] = []


def install() -> None:
    """Let SIGINT raise KeyboardInterrupt, SIGTERM and SIGHUP SystemExit, so that unfinished files go.

    A signal that whoever started the program had it ignore (nohup, a shell's ``&``) stays ignored.
    """
    handlers = {"SIGINT": _interrupt, "SIGTERM": _terminate, "SIGHUP": _terminate}
    for name, handler in handlers.items():
        number = getattr(signal, name, None)  # not every system has SIGHUP
        if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, handler)


def hide_warnings() -> None:
    """Keep Python's warnings, which are about the source, to ``--debug``: users are told by notes."""
    if not sys.warnoptions and "--debug" not in sys.argv:
        warnings.simplefilter("ignore")


def check() -> None:
    """Raise what a signal asked for, if it was dropped where it came."""
    if _asked:
        raise _asked[-1]


def _interrupt(number: int, frame: FrameType | None) -> NoReturn:  # noqa: ARG001
    _asked.append(KeyboardInterrupt())
    raise _asked[-1]


def _terminate(number: int, frame: FrameType | None) -> NoReturn:  # noqa: ARG001  (the signature is Python's)
    _asked.append(SystemExit(128 + number))
    raise _asked[-1]
