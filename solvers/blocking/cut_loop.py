"""A loop that follows fronts of layers in place of its own stretches: what layers leave of the boundary."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Generic, Protocol, TypeVar

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking.column_weights import whole_columns


class Layers(Protocol):
    """Layers whose front takes the place of a stretch of a loop."""

    @property
    def front(self) -> Floats:
        """(n, 2) nodes of the front, in the direction of the loop."""

    @property
    def front_corners(self) -> tuple[int, ...]:
        """Numbers of the columns at which the new loop has corners; its ends are among them."""

    @property
    def front_names(self) -> tuple[str, ...]:
        """Names from each of these corners, but for the last, to the next."""

    @property
    def ends(self) -> tuple[float, float]:
        """Arc lengths of the loop at which the front begins and ends, the second the larger."""

    @property
    def margins(self) -> tuple[float, float]:
        """Lengths near these places in which the loop has no other point."""

    @property
    def joined(self) -> tuple[bool, bool]:
        """Whether the front begins, and ends, where that of other layers does."""


L = TypeVar("L", bound=Layers)


@dataclass(frozen=True, eq=False)
class CutLoop(Generic[L]):
    """A loop along fronts and what is left of another loop.

    Parameters
    ----------
    outer : the loop that was cut.
    layers : in the order in which the loop meets them.
    loop : the new one; its corners are those of `outer` that are left, and those of fronts.
    first : numbers of the points of `loop` at which each front begins.
    arcs : (n,) arc lengths of `outer` at the points of `loop`, rising behind each front; along fronts, none.
    """

    outer: Loop
    layers: tuple[L, ...]
    loop: Loop
    first: tuple[int, ...]
    arcs: Floats

    @classmethod
    def of(cls, outer: Loop, layers: Sequence[L]) -> CutLoop[L]:
        """Return a loop with fronts in place of its stretches."""
        layers = sorted(layers, key=lambda each: each.ends[0] % outer.length)
        pieces, count = _Pieces(outer), 0
        first = []
        for k, each in enumerate(layers):
            first.append(count)
            pieces.add_front(each)
            if not each.joined[1]:
                pieces.add_rest(each, layers[(k + 1) % len(layers)])
            count = sum(len(part) for part in pieces.points)
        return cls(outer, tuple(layers), pieces.loop(), tuple(first), np.concatenate(pieces.arcs))

    @cached_property
    def _knots(self) -> Floats:
        return np.append(self.loop.curve.knots, self.loop.length)

    def _front_knots(self, k: int) -> Floats:
        """Return the arc lengths (n,) of the new loop at the columns of a front."""
        return self._knots[self.first[k] : self.first[k] + len(self.layers[k].front)]

    def span(self, k: int) -> tuple[float, float]:
        """Return the arc lengths of the new loop at which a front begins and ends."""
        knots = self._front_knots(k)
        return float(knots[0]), float(knots[-1])

    def front_at(self, arc: float) -> int | None:
        """Return the number of the front that an arc length of the new loop lies within, None for none."""
        spans = (self.span(k) for k in range(len(self.layers)))
        return next((k for k, (start, stop) in enumerate(spans) if start < arc < stop), None)

    def index(self, k: int, arcs: Floats) -> Floats:
        """Return the column numbers (m,) of layers at arc lengths (m,) of the new loop on their front."""
        knots = self._front_knots(k)
        return np.interp(arcs, knots, np.arange(float(len(knots))))

    def front_arcs(self, k: int, index: Floats) -> Floats:
        """Return arc lengths (m,) of the new loop at column numbers (m,) of layers."""
        knots = self._front_knots(k)
        return np.interp(index, np.arange(float(len(knots))), knots)

    def front_nodes(self, mesh: QuadMesh, number: int, k: int) -> tuple[Indices, Floats]:
        """Return the nodes (m,) of a mesh on a front, in order, and their column numbers (m,).

        `number` is that of the new loop in the domain of the mesh.
        """
        start, stop = self.span(k)
        arcs = np.where(mesh.places.loop == number, mesh.places.arc, -1.0)
        order = np.flatnonzero((arcs >= start) & (arcs <= stop))
        order = order[np.argsort(arcs[order], kind="stable")]
        index = whole_columns(self.index(k, arcs[order]))
        if stop == self.loop.length:  # its last node is where the loop begins
            order = np.append(order, np.flatnonzero(arcs == 0.0)[0])
            index = np.append(index, len(self.layers[k].front) - 1.0)
        return order, index

    def outer_arcs(self, arcs: Floats) -> Floats:
        """Return the arc lengths (m,) of the outer loop at those (m,) of the new loop that are on it."""
        result = np.empty(len(arcs))
        bounds = [*self.first[1:], len(self.arcs)]
        for k, stop in enumerate(bounds):
            if self.layers[k].joined[1]:
                continue
            begin = self.first[k] + len(self.layers[k].front) - 1
            own = self.layers[(k + 1) % len(self.layers)].ends[0]
            start = float(self.arcs[begin])
            known = np.append(self.arcs[begin:stop], start + (own - start) % self.outer.length)
            at = self._knots[begin : stop + 1]
            on = (arcs >= at[0]) & (arcs <= at[-1])
            result[on] = np.interp(arcs[on], at, known)
        return np.asarray(np.mod(result, self.outer.length))


class _Pieces:
    """Points of a new loop, put together piece by piece, with what they are."""

    def __init__(self, outer: Loop) -> None:
        self.outer = outer
        lines = outer.curve.straight
        self.lines = lines if lines is not None else np.zeros(len(outer.curve.knots), dtype=bool)
        self.points: list[Floats] = []
        self.arcs: list[Floats] = []
        self.straight: list[bool] = []
        self.kinks: list[int] = []
        self.corners: list[int] = []
        self.names: list[str] = []

    @property
    def count(self) -> int:
        return sum(len(part) for part in self.points)

    def add_front(self, layers: Layers) -> None:
        """Add the points of a front but for the last, which is the first of what follows."""
        n, count = len(layers.front), self.count
        self.points.append(layers.front[:-1])
        self.arcs.append(np.full(n - 1, np.nan))
        self.straight += [False] * (n - 1)
        self.kinks.append(count)
        self.corners += [count + column for column in layers.front_corners[:-1]]
        self.names += layers.front_names

    def add_rest(self, before: Layers, after: Layers) -> None:
        """Add what is left of the loop between the end of one front and the begin of another."""
        outer, count, knots = self.outer, self.count, self.outer.curve.knots
        begin = before.ends[1] % outer.length
        end = begin + (after.ends[0] - begin) % outer.length
        turns = np.concatenate([knots, knots + outer.length])
        inner = np.flatnonzero((turns > begin + before.margins[1]) & (turns < end - after.margins[0]))
        own = inner % len(knots)
        at = np.searchsorted(turns, begin, side="right") - 1
        self.straight += [bool(self.lines[at % len(knots)]), *self.lines[own].tolist()]
        self.arcs += [np.array([begin]), turns[inner]]
        self.points += [before.front[-1:], outer.curve.points[own]]
        self.kinks += [count, *(count + 1 + np.flatnonzero(np.isin(own, outer.curve.corner_index))).tolist()]
        corners = np.flatnonzero(np.isin(own, outer.corners))
        self.corners += [count, *(count + 1 + corners).tolist()]
        self.names += [outer.name_at(begin), *(outer.name_at(float(turns[k])) for k in inner[corners])]

    def loop(self) -> Loop:
        """Return the loop along all points."""
        mask = np.array(self.straight) if any(self.straight) else None
        curve = Curve(np.concatenate(self.points), closed=True, corners=sorted(self.kinks), straight=mask)
        return Loop(curve, tuple(self.corners), tuple(self.names))
