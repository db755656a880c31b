"""Reliable interrupts: Python drops an exception that a signal handler raises inside a clean-up callback.

Handlers therefore also record the signal, and `check`, called between members of a batch, raises it again.
"""

import signal
import sys
import warnings
from types import FrameType
from typing import Any, NoReturn

LINES: list[Any] = []  # status lines drawn by threads, which are stopped at the end of the program

_asked: list[BaseException] = []


def install() -> None:
    """Install signal handlers, so that unfinished files are removed when a signal ends the program.

    SIGINT raises KeyboardInterrupt, SIGTERM and SIGHUP raise SystemExit. Ignored signals stay ignored.
    """
    handlers = {"SIGINT": _interrupt, "SIGTERM": _terminate, "SIGHUP": _terminate}
    for name, handler in handlers.items():
        number = getattr(signal, name, None)  # not every system has SIGHUP
        if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, handler)


def hide_warnings() -> None:
    """Hide Python's warnings, which concern the source code, unless ``--debug`` is given."""
    if not sys.warnoptions and "--debug" not in sys.argv:
        warnings.simplefilter("ignore")


def check() -> None:
    """Raise an exception if a signal such as Ctrl-C has arrived: Python can lose the handler's exception."""
    if _asked:
        raise _asked[-1]


def _interrupt(number: int, frame: FrameType | None) -> NoReturn:  # noqa: ARG001
    _asked.append(KeyboardInterrupt())
    raise _asked[-1]


def _terminate(number: int, frame: FrameType | None) -> NoReturn:  # noqa: ARG001  (the signature is Python's)
    _asked.append(SystemExit(128 + number))
    raise _asked[-1]
