"""Functions of higher packages that methods in `geometry` call; `meshonet/__init__.py` registers them here.

Thus ``Grid.write`` is available for every grid, although `geometry` imports nothing from higher packages.
"""

from collections.abc import Callable
from typing import Any

ABOVE: dict[str, Callable[..., Any]] = {}
"""The functions ``write`` and ``measure``; each loads its module at the first call."""
