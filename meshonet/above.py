"""Functions of higher packages that methods in `geometry` call, registered by `meshonet/__init__.py`."""

from collections.abc import Callable
from typing import Any

ABOVE: dict[str, Callable[..., Any]] = {}
"""The functions ``write`` and ``measure``; each loads its module at the first call."""
