"""Options of methods, and their values."""

from __future__ import annotations

import re
from typing import Literal


def polish_steps(text: str) -> Literal["auto", "off"] | int:
    """Return the steps of ``auto``, ``off`` or a number.

    Raises InputError: `text` is none of them.

    >>> polish_steps("off"), polish_steps("3")
    ('off', 3)
    """
    if text == "auto":
        return "auto"
    if text == "off":
        return "off"
    if not re.fullmatch(r"\d{1,3}", text, re.ASCII):
        from meshonet.geometry.errors import InputError

        raise InputError(f"{text!r} is not a number of steps", "use auto, off or e.g. 2", parameter="polish")
    return int(text)


def coarse_nodes(text: str) -> Literal["auto"] | int | None:
    """Return the nodes of ``auto``, ``off`` (None; 0 is the same) or a number from 9 on.

    Raises InputError: `text` is none of them.

    >>> coarse_nodes("auto"), coarse_nodes("off"), coarse_nodes("65")
    ('auto', None, 65)
    """
    if text == "auto":
        return "auto"
    if text in ("off", "0"):
        return None
    if not re.fullmatch(r"[0-9]{1,6}", text) or int(text) < 9:
        from meshonet.geometry.errors import InputError

        problem = f"{text!r} is not a number of nodes from 9 on"
        raise InputError(problem, "use auto, off or e.g. 65", parameter="coarse")
    return int(text)
