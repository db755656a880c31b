"""Properties that are worked out once and kept, without a lock between threads."""

import functools
from collections.abc import Callable
from contextlib import nullcontext
from typing import Any, TypeVar

Made = TypeVar("Made")


class cached_property(functools.cached_property[Made]):  # noqa: N801  # as the one that it is
    """As that of `functools`, without the lock that all objects of a class share in Python 3.11.

    With it, threads that work out the same property of different objects would wait for each other.
    """

    def __init__(self, work: Callable[[Any], Made]) -> None:
        super().__init__(work)
        self.lock = nullcontext()
