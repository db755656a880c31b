"""Functions of upper rooms that methods in `geometry` call: `meshonet/__init__.py` puts them here.

So ``Grid.write`` is at hand wherever there is a grid, and `geometry` imports nothing from above.
"""

from collections.abc import Callable
from typing import Any

ABOVE: dict[str, Callable[..., Any]] = {}
"""``write`` and ``measure``, each loaded when it is first called."""
