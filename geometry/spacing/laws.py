"""Spacing laws: where the nodes of a stretch of curve go, from 0 to 1.

A new law is a line in `LAWS`: its name is then accepted wherever spacings are, also by ``--spacing``. The
help of the command line reads this module, which therefore loads no NumPy: a law's function does.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from meshonet.geometry.arrays import Floats

Spacing: TypeAlias = str
"""Name of a law, a key of `LAWS`."""


@dataclass(frozen=True)
class Law:
    """A spacing law."""

    place: Callable[[Floats], Floats] | None = None
    """s(q), both 0 to 1; None for a law that depends on the curve or on the cells at its ends."""
    sets_ends: bool = False
    """The cells at the two ends of a stretch can be chosen."""


def _cosine(q: Floats) -> Floats:
    from meshonet.geometry.elementary import sin

    return sin(0.5 * math.pi * q) ** 2


LAWS: dict[str, Law] = {
    "auto": Law(sets_ends=True),  # conformal where there is such a map, else tanh or uniform
    "conformal": Law(),  # equal angles of the circle that the body is an image of
    "uniform": Law(lambda q: q),
    "cosine": Law(_cosine, sets_ends=True),
    "tanh": Law(sets_ends=True),
    "curvature": Law(sets_ends=True),  # `meshonet.geometry.spacing.size_field`
}
SPACINGS: tuple[Spacing, ...] = tuple(LAWS)
