"""Functions of higher rooms that methods in `geometry` call; `meshonet/__init__.py` registers them here.

Thus ``Grid.write`` is available for every grid, although `geometry` imports nothing from higher rooms.
"""

from collections.abc import Callable
from typing import Any

ABOVE: dict[str, Callable[..., Any]] = {}
"""``write`` and ``measure``; each loads its module at the first call."""
