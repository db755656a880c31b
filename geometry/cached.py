"""Properties that are computed once and kept, without a lock between threads."""

import functools
from collections.abc import Callable
from contextlib import nullcontext
from typing import Any, TypeVar

Made = TypeVar("Made")


class cached_property(functools.cached_property[Made]):  # noqa: N801  # as the one that it is
    """`functools.cached_property` without the lock that in Python 3.11 all objects of a class share."""

    def __init__(self, work: Callable[[Any], Made]) -> None:
        super().__init__(work)
        self.lock = nullcontext()
