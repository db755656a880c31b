"""The templates from which the blocks of cascades and blade rows are made."""

from collections.abc import Callable, Sequence
from itertools import product
from typing import Protocol, TypeVar

import numpy as np

from meshonet.geometry.arrays import Bools
from meshonet.geometry.errors import NoValidGridError
from meshonet.geometry.layout.layout import Layout
from meshonet.solvers.cascade.passage import Passage
from meshonet.solvers.cascade.passage_template import template

T = TypeVar("T")


class Template(Protocol):
    """A function that makes the initial blocks of a passage.

    Four blocks touch the blade, each with its side j = 0. In `Layout.blocks` they are in this order: upper
    side of the blade, trailing edge, lower side, leading edge.
    """

    def __call__(self, passage: Passage, *, at_corners: bool) -> Layout:
        """Return the blocks; if `at_corners`, the nearest nodes move to corners of the blade."""


TEMPLATES: tuple[Template, ...] = (template,)
"""The templates in the order in which they are tried."""


def first_valid(make: Callable[[Template, str], T], corners: Sequence[str]) -> T:
    """Return the first result of ``make(template, corner)`` without folded cells.

    Each of the `TEMPLATES` is tried with each of the `corners`. Raises the last NoValidGridError of `make`.
    """
    *attempts, last = product(TEMPLATES, corners)
    for attempt in attempts:
        try:
            return make(*attempt)
        except NoValidGridError:
            continue
    return make(*last)


def around_blade(layout: Layout, on_blade: Bools) -> tuple[int, ...]:
    """Return the indices of the blocks whose side j = 0 consists of nodes in the mask `on_blade` (n,)."""
    return tuple(k for k, block in enumerate(layout.blocks) if np.all(on_blade[block[:, 0]]))
