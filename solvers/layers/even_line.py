"""Moves nodes along a curve so that the ratio of neighbouring steps is limited, in several measures.

A measure increases along the curve, such as its arc length. Let ρ be the logarithms of the ratios of
neighbouring steps of each measure. The positions t of the nodes, initially t0 with the steps s, minimise::

    E = the term of `growth_limit` in ρ + σ Σ (t - t0)² / s² + Σ (links)²
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices
from meshonet.geometry.cached import cached_property
from meshonet.geometry.elementary import log
from meshonet.geometry.layout.layout import Layout
from meshonet.kernels._native import even_line
from meshonet.solvers.energy.quad_problem import smallest_jacobian
from meshonet.solvers.layers.growth_limit import CHANGE, EXCESS, HALVINGS, LINEAR, MOST_WEIGHT, NEARLY, RISE
from meshonet.solvers.least_squares import NormalEquations
from meshonet.solvers.sparse import SparsePattern

MOVE = 1e-2  # σ
EVEN = math.log(1.24)  # logarithm of the ratio by which neighbouring cells along fronts may differ
FEW_STEPS = 2.0
"""Steps by which nodes may move along fronts of passages, and of fine grids that no optimisation follows."""
FRONTS = 0.2  # μ along fronts: fewer nodes move, so that angles beside them are better
MARGIN = 0.006  # margin by which ratios, in logarithms, should be below the limit
STEPS = 24  # largest number of Gauss-Newton steps; the weight reaches its largest value in 15
MOST, RELAXED, TRIES = 6.0, 1.5, 6
"""Largest displacement of a place in steps; factor on the limit if it is exceeded; number of tries."""
FINER = 8  # number of points per column at which measures are tabulated
SLACK = np.array([2.0, 1.0, 0.9])
"""Logarithms of ratios along fronts, at walls, and in the level next to these, by that of the limit."""


@dataclass(frozen=True, eq=False)
class Measures:
    """Functions along a curve, such as arc length, whose steps from node to node should grow slowly.

    Parameters
    ----------
    arcs : (m,) positions along the curve, ascending.
    values : (k, m) increasing values of k functions at these positions; they are linear in between.
    slack : (k,) factor on the allowed log(growth ratio) of each function.
    """

    arcs: Floats
    values: Floats
    slack: Floats | float = 1.0

    def at(self, places: Floats, closed: bool) -> Floats:
        """Return the values (k, n) of k functions, which rise along a curve, at positions `places` (n,).

        On a `closed` curve, positions may be on any turn around it, and functions rise from turn to turn.
        """
        turns = np.zeros(len(places))
        if closed:
            turns, places = np.divmod(places, self.arcs[-1])
        k = np.clip(np.searchsorted(self.arcs, places, side="right") - 1, 0, len(self.arcs) - 2)
        inside = self.slopes.take(k, axis=1) * (places - self.arcs[k])
        return np.asarray(self.values.take(k, axis=1) + inside + turns * self.whole)

    @cached_property
    def slopes(self) -> Floats:
        """(k, m - 1) slopes of k functions along the curve, in the intervals between positions `arcs`."""
        return np.diff(self.values, axis=1) / np.diff(self.arcs)

    @property
    def whole(self) -> Floats:
        """Increase (k, 1) of each function in `values` from the start of the curve to its end."""
        return self.values[:, -1:] - self.values[:, :1]


@dataclass(frozen=True, eq=False)
class PlaceLinks:
    """Conditions f0 u0 + f1 u1 + rest = 0 between pairs of positions u.

    Parameters
    ----------
    pairs : (p, 2) indices of the two positions.
    factors : (p, 2) factors f0 and f1.
    rest : (p,) constant terms.
    """

    pairs: Indices
    factors: Floats
    rest: Floats

    def values(self, places: Floats) -> Floats:
        """Return the residuals (p,) of p linear conditions on positions `places` (n,) along a curve."""
        return np.asarray((self.factors * places[self.pairs]).sum(axis=1) + self.rest)


NO_LINKS = PlaceLinks(np.empty((0, 2), dtype=np.intp), np.empty((0, 2)), np.empty(0))


def evened_places(
    places: Floats, fixed: Bools, measures: Measures, limit: float, closed: bool,
    links: PlaceLinks = NO_LINKS, most: float = MOST, change: float = CHANGE,
) -> Floats:  # fmt: skip
    """Return ascending positions `places` (n,), moved until ratios of neighbouring steps are limited.

    The functions `measures` turn positions into lengths; steps are the differences of successive lengths.
    Positions in the mask `fixed` (n,) stay. `limit` is the logarithm of the largest ratio; it is relaxed if
    positions would move by more than `most` steps. On a `closed` curve, the last step leads to the first
    position. `links` are further conditions. `change` is the weight of a penalty on changes of the ratios.
    """
    line = _Line.of(places, fixed, measures, closed, links, change)
    new = places
    for _ in range(TRIES):
        if fixed.all() or not line.exceeded(places, limit):
            return places
        new = line.evened(places, limit)
        if (np.abs(new - places)[line.free] ** 2 * line.stiffness).max() < MOVE * most**2:
            break
        limit *= RELAXED
    return new


def evened_steps(steps: Floats, limit: float) -> Floats:
    """Return `steps` (n,) around a closed curve, changed until ratios of neighbouring steps are limited.

    The sum of the steps stays the same. `limit` is the logarithm of the largest ratio.
    """
    places = np.concatenate([[0.0], np.cumsum(steps)])
    ends = places[[0, -1]]
    fixed = np.arange(len(steps)) == 0
    places[:-1] = evened_places(places[:-1], fixed, Measures(ends, ends[None]), limit, closed=True)
    return np.diff(places)


def evened_loops(
    layout: Layout, measures: Mapping[int, Measures], limit: float, most: float = MOST
) -> Layout:
    """Return the layout with nodes moved along loops, so that steps between neighbours grow slowly.

    A step is the difference of a function along a loop, such as arc length, between neighbouring nodes.
    `measures` has the functions of each loop that is to change, by the index of the loop.
    `limit` and `most` are as in `evened_places`. Corners stay. If cells would fold, nothing is changed.
    """
    mesh = layout.mesh
    nodes, arcs = mesh.nodes.copy(), mesh.places.arc.copy()
    for number, measure in measures.items():
        order = mesh.places.along(number)
        fixed = mesh.places.cells[order] > 0
        if not fixed.any():
            fixed[0] = True  # otherwise all nodes could rotate around the loop
        new = evened_places(arcs[order], fixed, measure, limit, closed=True, most=most, change=FRONTS)
        arcs[order] = new = new % measure.arcs[-1]
        shift = np.zeros_like(nodes)
        shift[order] = mesh.domain.loops[number].at(new) - mesh.nodes[order]
        nodes += _spread(layout, number, shift)
        nodes[order] = mesh.nodes[order] + shift[order]
    fixed = mesh.places.cells > 0
    nodes[fixed] = mesh.nodes[fixed]
    if smallest_jacobian(nodes, mesh.quads) <= 0.0:
        return layout
    return replace(layout, mesh=mesh.with_nodes(nodes, arcs))


def _spread(layout: Layout, loop: int, shift: Floats) -> Floats:
    """Return displacements (n, 2) that decrease from those of nodes on a loop, `shift` (n, 2), inwards."""
    moved = np.zeros_like(shift)
    for lines in layout.beside(layout.mesh.places.loop == loop):
        left = np.linspace(1.0, 0.0, lines.shape[1]) ** 2
        moved[lines] = left[None, :, None] * shift[lines[:, 0]][:, None]
    return moved


@dataclass(frozen=True, eq=False)
class _Line:
    measures: Measures
    closed: bool
    free: Indices  # (f,) numbers of the places that move
    triples: Indices  # (r, 3) numbers of places, of the two steps of each ratio
    stiffness: Floats  # (f,) σ / s²
    links: PlaceLinks
    change: float

    @classmethod
    def of(
        cls, places: Floats, fixed: Bools, measures: Measures, closed: bool, links: PlaceLinks, change: float
    ) -> Self:
        n = len(places)
        first = np.arange(n if closed else n - 2)
        triples = (first[:, None] + np.arange(3)) % n
        free = np.flatnonzero(~fixed)
        around = np.concatenate([[places[-1] - measures.arcs[-1]], places, [places[0] + measures.arcs[-1]]])
        if not closed:
            around[[0, -1]] = 2.0 * places[0] - places[1], 2.0 * places[-1] - places[-2]
        step = np.diff(around)
        return cls(measures, closed, free, triples, (MOVE / (step[1:] * step[:-1]))[free], links, change)

    @cached_property
    def unknown(self) -> Indices:
        """(n,) index of each position among the positions that move; -1 for fixed positions."""
        unknown = np.full(self.triples.max() + 1, -1, dtype=np.intp)
        unknown[self.free] = np.arange(len(self.free))
        return unknown

    @cached_property
    def pattern(self) -> SparsePattern:
        """The positions of the entries in the normal equations of one measure."""
        kinds = [self.unknown[of] for of in (self.triples, self.links.pairs)]
        return NormalEquations(len(self.free), kinds).pattern

    def _growth(self, places: Floats) -> Floats:
        """Return the logarithms (k, r) of the ratios of neighbouring steps of each measure."""
        value = self.measures.at(places, self.closed)
        if not self.closed:
            return np.diff(log(np.diff(value, axis=1)), axis=1)
        logs = log(np.diff(value, axis=1, append=value[:, :1] + self.measures.whole))
        return np.diff(logs, axis=1, append=logs[:, :1])

    def _limits(self, limit: float) -> Floats:
        """Return the limits (k,) of the measures."""
        return limit * np.asarray(self.measures.slack) * np.ones(len(self.measures.values))

    def exceeded(self, places: Floats, limit: float) -> bool:
        """Return whether a ratio exceeds the limit of its measure."""
        return bool((np.abs(self._growth(places)) > self._limits(limit)[:, None]).any())

    def evened(self, places: Floats, limit: float) -> Floats:
        """Return positions after some Gauss-Newton iterations. Raises SolverError: singular equations."""
        places, limits, links = places.copy(), self._limits(limit), self.links
        measures = self.measures.arcs, self.measures.values, self.measures.slopes
        terms = links.pairs, links.factors, links.rest, self.change, LINEAR, NEARLY
        steps = limits, EXCESS, RISE, MOST_WEIGHT, STEPS, HALVINGS
        pattern = self.pattern
        failed = even_line(
            measures, self.closed, (limits - MARGIN, self.stiffness, *terms), steps, pattern.arrays,
            pattern.slot, self.unknown, places,
        )  # fmt: skip
        if failed >= 0:
            raise pattern.singular(failed)
        return places
