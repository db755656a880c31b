"""Layers of cells at walls: first cells and growth, and their nodes along columns."""

import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np

from meshonet.geometry.arrays import Floats, arc_lengths, arc_parts
from meshonet.geometry.curves.cubic import sampled
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.growth import cells_for_growth
from meshonet.solvers.layers.layer_law import STEEPER, layer_arcs
from meshonet.solvers.refinement.size_metric import GRADING

JOIN = 1.1  # ratio of the first cell outside a ring to the last one inside
NOMINAL, STEEPEST = 0.9, 0.97
"""Mean and largest growth of layers as fractions of the limit, in logarithms: later steps use the rest."""
ELSEWHERE, MOST_GROWTH = 1.21, 1.25
"""Largest growth along walls over the limit, in logarithms; the ratio that is always allowed there."""
SPREAD = 0.65  # largest growth of edge lengths per distance, divided by the growth from one cell to the next


@dataclass(frozen=True)
class LayerSettings:
    """Layers of cells at walls.

    Parameters
    ----------
    first : first-cell height, in the domain's unit, of all walls that are not in `heights`.
    growth : upper limit of the mean growth ratio of layers along a line from the wall.
    constant : number of cells, from the wall, that have the height of the first cell.
    multiple : divisor of the number of layers, so that coarser grids are nested.
    heights : first-cell heights of walls, by the name of the wall.
    limit : upper limit of every growth ratio along a line from the wall; 0: about `growth` to the power 1.2.
    """

    first: float
    growth: float = 1.2
    constant: int = 1
    multiple: int = 1
    heights: Mapping[str, float] = field(default_factory=dict)
    limit: float = 0.0

    @classmethod
    def limited(cls, first: float, limit: float, **others: Any) -> Self:
        """Return settings with growth ratios up to `limit`, in layers and elsewhere; `others` are fields."""
        return cls(first, math.exp(NOMINAL * math.log(limit)), limit=limit, **others)

    def at(self, names: Collection[str]) -> Self:
        """Return the settings for a single wall, which consists of parts with the given `names`.

        Raises InputError if these parts have different first-cell heights.
        """
        if not self.heights:
            return self
        first = {self.heights[name]: name for name in reversed(list(names)) if name in self.heights}
        if len(first) > 1:
            one, other = list(first.values())[:2]
            raise InputError(
                f"first cells of {self.heights[other]:g} at {other!r} and {self.heights[one]:g} at {one!r}, "
                "which are parts of one wall with layers",
                "give both the same: heights change at corners of about 90 degrees only",
                parameter="first_cell",
            )
        return replace(self, first=next(iter(first)), heights={})

    @property
    def steepest(self) -> float:
        """Logarithm of the largest allowed growth ratio of cells along lines that start at walls."""
        return math.log(self.limit) if self.limit else self.elsewhere

    @property
    def elsewhere(self) -> float:
        """Logarithm of the largest allowed growth ratio of cells along lines that do not start at walls."""
        return max(ELSEWHERE * math.log(self.limit or self.growth), math.log(MOST_GROWTH))

    @property
    def join(self) -> float:
        """Height of the first cell beyond the layers, divided by the height of the last layer."""
        return min(JOIN, math.sqrt(self.limit)) if self.limit else JOIN

    @property
    def grading(self) -> float:
        """Increase of cell lengths outside of layers, divided by the increase of the distance from walls."""
        return min(GRADING, SPREAD * (self.limit - 1.0)) if self.limit else GRADING

    def below(self, growth: float) -> float:
        """Return the ratio `growth` for cells outside layers, reduced if it is near or above `self.limit`."""
        return min(growth, 1.0 + NOMINAL * (self.limit - 1.0)) if self.limit else growth

    def arcs(self, length: Floats, first: float | Floats, last: Floats, cells: int) -> Floats:
        """Return the distances (k, cells + 1) of nodes from the wall, on k lines of `length` (k,).

        `first` is the height of the first cell, `last` (k,) the approximate height of the last cell.
        """
        most, steeper = self.growth, STEEPER
        if self.limit:
            most, steeper = math.exp(STEEPEST * math.log(self.limit)), STEEPEST / NOMINAL - 1.0
        return layer_arcs(length, first, last, cells, self.constant, most, steeper)

    def rows(self, thickness: float) -> int:
        """Return the number of layers that fill the length `thickness`."""
        rest = max(thickness - (self.constant - 1) * self.first, self.first)
        rows = self.constant - 1 + max(2, cells_for_growth(self.first, rest, self.growth))
        return -(-rows // self.multiple) * self.multiple


def layer_lines(
    columns: Floats, ends: Floats, beyond: Floats, rows: int, settings: LayerSettings, first: Floats
) -> Floats:
    """Return the nodes (k, rows + 1, 2) of layers along columns (k, m, 2), from the wall to `ends` (k, 2).

    `beyond` (k,) are the heights of the first cells beyond the layers, `first` (k,) of those at the wall.
    """
    columns = columns + arc_parts(columns)[..., None] * (ends - columns[:, -1])[:, None]
    lines = spaced(columns, lambda length: settings.arcs(length, first, beyond / settings.join, rows))
    exact(lines, first)
    return lines


def exact(lines: Floats, first: float | Floats) -> None:
    """Move the node next to the wall on each line (k, m, 2) to the exact distance `first`, in place."""
    step = lines[:, 1] - lines[:, 0]
    lines[:, 1] = lines[:, 0] + step * (first / np.hypot(*step.T))[:, None]


def spaced(lines: Floats, law: Callable[[Floats], Floats]) -> Floats:
    """Return new nodes (k, n, 2) on `lines` (k, m, 2); `law` computes their arc lengths from line lengths."""
    arc = arc_lengths(lines)
    return sampled(lines, arc, law(arc[:, -1]))
