"""Spacings, functions that place nodes along a curve: from index / (n - 1) to relative arc length, 0 to 1.

A line in `LAWS` adds one everywhere. NumPy is not loaded here, since ``--help`` reads this.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from meshonet.geometry.arrays import Floats

Spacing: TypeAlias = str  # name of a spacing, a key of `LAWS`


@dataclass(frozen=True)
class Law:
    """A spacing: a law by which nodes are distributed along a curve."""

    place: Callable[[Floats], Floats] | None = None  # the function s(q), 0 to 1; None: set by the curve
    sets_ends: bool = False  # whether le_spacing and te_spacing apply; then tanh replaces `place`


def _cosine(q: Floats) -> Floats:
    from meshonet.geometry.elementary import sin

    return sin(0.5 * math.pi * q) ** 2


LAWS: dict[str, Law] = {
    "auto": Law(sets_ends=True),  # conformal if there is such a map, else tanh or uniform
    "conformal": Law(),  # equal angles on the circle that the body is mapped to
    "uniform": Law(lambda q: q),
    "cosine": Law(_cosine, sets_ends=True),
    "tanh": Law(sets_ends=True),
    "curvature": Law(sets_ends=True),  # `meshonet.geometry.spacing.size_field`
}
SPACINGS: tuple[Spacing, ...] = tuple(LAWS)
