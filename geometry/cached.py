"""Properties that are computed once and kept, without a lock between threads."""

import functools
from collections.abc import Callable
from contextlib import nullcontext
from typing import Any, TypeVar

Made = TypeVar("Made")


class cached_property(functools.cached_property[Made]):  # noqa: N801  # as the one that it is
    """`functools.cached_property` without its lock, which all objects of a class share in Python 3.11."""

    def __init__(self, work: Callable[[Any], Made]) -> None:
        super().__init__(work)
        self.lock = nullcontext()
