"""Key sections of a row, with the same blocks and counts; each starts from its neighbour's nodes.

All are optima of one functional, which limits the growth of cells along lines. The middle one is first.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, norms, wrapped
from meshonet.geometry.errors import NoValidGridError
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.geometry.threads import run_in_threads
from meshonet.solvers.cascade.templates import around_blade
from meshonet.solvers.energy.quad_problem import Problem
from meshonet.solvers.energy.quads import minimise, problem_of
from meshonet.solvers.layers.layer_settings import layer_lines
from meshonet.solvers.rows.columns import layer_columns, straight_near
from meshonet.solvers.rows.harmonic import HarmonicMoves
from meshonet.solvers.rows.middle_section import TOLERANCE, folded_section, middle_section
from meshonet.solvers.rows.section_plane import SectionPlane
from meshonet.solvers.rows.span_places import SpanPlaces

FINE, FROM_NEIGHBOUR = 40, 25
FLAT, SMOOTH = 0.95, 1e-3  # weights w and β of the functional
BEND = 0.3  # fraction of the way to the outlet over which lines turn into the direction of the wake
STEEP, MARGIN = 3.0, 0.93  # weight of growth; fraction of the logarithm of its limit from where it counts


@dataclass(frozen=True, eq=False)
class SectionPlan:
    """Data that all key sections of a blade row share; the grid is interpolated between these sections."""

    growth: float  # largest ratio of neighbouring cells
    columns: Indices  # (k, rows + 1) nodes of the layers, clockwise, each column from the blade outwards
    outward: Indices  # (k,) next node beyond each column
    ends: tuple[Indices, Indices]  # nodes at inlet and outlet
    held: Bools  # (n,) mask of nodes in layers or at inlet and outlet
    moves: HarmonicMoves  # displacements of all other nodes from those of the held ones
    places: SpanPlaces  # places u (see `SectionPlane`) of the first nodes of columns
    # theta at the outlet minus theta at the trailing edge along a straight wake, at half the height; and its
    # derivative by the height
    wake: tuple[float, float]

    def bent(self, plane: SectionPlane, nodes: Floats) -> Floats:
        """Return `nodes` (n, 2) in m' (along the flow) and theta, with theta shifted to follow the wake."""
        most = self.wake[0] + self.wake[1] * (plane.height - 0.5)
        start = float(plane.edges[1, 0])
        t = np.maximum(nodes[:, 0] - start, 0.0) / (plane.map.length - start)
        aside = np.where(t < BEND, t * t / (2.0 * BEND), t - 0.5 * BEND)
        return np.stack([nodes[:, 0], nodes[:, 1] + most * aside], axis=1)


@dataclass(frozen=True, eq=False)
class LayerColumns:
    """Grid lines from a blade through its layers, before nodes are distributed along them."""

    walls: Floats  # (k,) arc lengths on the blade at which they begin
    lines: Floats  # (k, m, 2) nodes along them
    ends: Floats  # (k, 2) points on the outer edge of the layers at which they end

    @classmethod
    def of(cls, plane: SectionPlane, places: Floats) -> "LayerColumns":
        """Return the lines of nodes that begin on the blade at `places` (k,), from 0 to 1 around it."""
        front = plane.front_arcs(places)
        lines, walls = plane.cascade.ring.columns(front)
        lines = straight_near(lines, plane.from_corners(walls))
        return cls(walls, lines, plane.cascade.ring.front.at(front))


@dataclass(frozen=True, eq=False)
class KeySection:
    """A section of a blade row whose nodes are computed; nodes between key sections are interpolated."""

    plane: SectionPlane  # the section as a plane cascade
    layout: Layout  # its blocks in (m', theta), with the domain of the middle section
    places: Floats  # (k,) places u of the first nodes of columns


@dataclass(frozen=True, eq=False)
class Beginning:
    """The middle section of a blade row, and the data from which the grids of all other sections are made."""

    columns: Sequence[LayerColumns | None]  # columns of the layers of each section; None for the middle one
    middle: KeySection  # the middle section
    following: "tuple[NextSections, NextSections]"  # makers of the sections towards hub and casing


def planned(
    planes: Sequence[SectionPlane], coarse: Layout | None, cells: int, longest: Mapping[int, float],
    wake: tuple[float, float], gaps: tuple[bool, bool],
) -> tuple[KeySection, tuple[SectionPlan, SectionPlan]]:  # fmt: skip
    """Return a first grid of the middle section, with about `cells` cells, and two plans for all sections.

    In the first plan, cells around the blade grow more slowly; with the second, cells fold less often.

    Parameters
    ----------
    coarse : result of `coarse_section` for the middle section; None: it is computed.
    longest : for `INLET` and `OUTLET`, largest length of the straight grid lines there, over all sections.
    wake : as in `SectionPlan`.
    gaps : whether the blade ends in a gap at the hub, and at the casing.
    """
    plane = planes[len(planes) // 2]
    across = [partial(getattr, each, "across") for each in planes]  # cached
    whole, *_ = run_in_threads([partial(middle_section, planes, cells, longest, coarse), *across])
    columns, growth = layer_columns(whole), plane.cascade.layers.growth
    at = plane.places_of(whole.mesh.places.arc[columns[:, 0]])
    pairs = _pairs(whole, columns)
    places = SpanPlaces.of(planes, at, pairs, gaps)
    m = whole.mesh.nodes[:, 0]
    near = 1e-9 * (m.max() - m.min())
    ends = np.flatnonzero(m <= m.min() + near), np.flatnonzero(m >= m.max() - near)
    held = np.zeros(len(m), dtype=bool)
    for own in (columns, *ends):
        held[own] = True
    even, moves = run_in_threads(
        [partial(places.evened, planes, growth, pairs), partial(HarmonicMoves, whole.mesh, held)]
    )
    plan = SectionPlan(growth, columns, _beyond(whole, columns), ends, held, moves, places, wake)
    return KeySection(plane, whole, at), (replace(plan, places=even), plan)


def beginning(plan: SectionPlan, planes: Sequence[SectionPlane], section: KeySection) -> Beginning:
    """Return the grid of the middle section, and the data from which all other sections are made.

    `section` is a first grid of the middle section, see `planned`. Its nodes around the blade are moved to
    the places of `plan`. Raises NoValidGridError if cells are folded.
    """
    others = [plane for plane in planes if plane is not section.plane]
    columns = [partial(LayerColumns.of, plane, plan.places.at(plane.height)) for plane in others]
    following = [partial(NextSections, plan, section)] * 2
    placed, below, above, *made = run_in_threads([partial(_placed, plan, section), *following, *columns])
    half = len(made) // 2
    return Beginning((*made[:half], None, *made[half:]), placed, (below, above))


class NextSections:
    """Makes the grids of a blade row in sections at successive heights, each from the grid before it."""

    def __init__(self, plan: SectionPlan, section: KeySection) -> None:
        self.plan = plan
        self._problem = _problem(plan, section.plane, section.layout.mesh)

    def of(self, before: KeySection, plane: SectionPlane, columns: LayerColumns | None = None) -> KeySection:
        """Return the section in `plane`, made from the neighbouring section `before`.

        `columns` are the lines of nodes through the layers; None: they are computed. Raises NoValidGridError
        if cells stay folded.
        """
        plan = self.plan
        columns = columns or LayerColumns.of(plane, plan.places.at(plane.height))
        layout, places = _carried(plan, before, plane, columns)
        self._problem.take(layout.mesh)
        return KeySection(plane, _optimum(plan, plane, layout, self._problem, FROM_NEIGHBOUR), places)


def _beyond(layout: Layout, columns: Indices) -> Indices:
    """Return the nodes (k,) that follow the last ones of columns (k, m)."""
    front = columns[:, -1]
    inside = np.zeros(len(layout.mesh.nodes), dtype=bool)
    inside[columns] = True
    number = np.full(len(inside), -1)
    number[front] = np.arange(len(front))
    out = np.empty(len(front), dtype=np.intp)
    for ends in (layout.mesh.edges, layout.mesh.edges[:, ::-1]):
        leaving = (number[ends[:, 0]] >= 0) & ~inside[ends[:, 1]]
        out[number[ends[leaving, 0]]] = ends[leaving, 1]
    return out


def _pairs(layout: Layout, columns: Indices) -> Indices:
    """Return columns (p, 2) on the upper side, and those opposite across the channel."""
    number = np.full(len(layout.mesh.nodes), -1)
    number[columns[:, -1]] = np.arange(len(columns))
    upper, _, lower, _ = around_blade(layout, number >= 0)
    return np.stack([number[layout.blocks[upper][:, 0]], number[layout.blocks[lower][::-1, 0]]], axis=1)


def _placed(plan: SectionPlan, section: KeySection) -> KeySection:
    """Return the middle section with the nodes around the blade at the plan's places, in steps if need be.

    Nodes at inlet and outlet slide along these.
    """
    plane, wanted = section.plane, plan.places.at(section.plane.height)
    move = wrapped(wanted - section.places)
    for steps in (1, 2, 4):
        try:
            made = section
            for k in range(1, steps + 1):
                places = wanted if k == steps else np.mod(section.places + k / steps * move, 1.0)
                layout, own = _carried(plan, made, plane, LayerColumns.of(plane, places))
                problem = _problem(plan, plane, layout.mesh, ends_slide=True)
                made = KeySection(plane, _optimum(plan, plane, layout, problem, FINE), own)
            return made
        except NoValidGridError:
            if steps == 4:
                raise
    raise AssertionError


def _carried(
    plan: SectionPlan, before: KeySection, plane: SectionPlane, columns: LayerColumns
) -> tuple[Layout, Floats]:
    """Return a neighbour's layout with the layers and ends of a section, and u of nodes at the blade.

    Nodes keep their share of the way along the passage, and follow the blade's middle line in theta. The rest
    of the moves is harmonic.
    """
    nodes = before.layout.mesh.nodes
    shares = before.plane.shares(nodes)
    aside = plane.camber(shares) - before.plane.camber(shares)
    start = np.stack([plane.stations(shares), nodes[:, 1] + aside], axis=1)
    end = start.copy()
    inner = norms(start[plan.outward] - start[plan.columns[:, -1]])
    rows = plan.columns.shape[1] - 1
    layers = plane.cascade.layers
    first = layers.first * plane.cascade.factors_at(columns.walls)
    end[plan.columns] = layer_lines(columns.lines, columns.ends, inner, rows, layers, first)
    for own, at in zip(plan.ends, (0.0, plane.map.length), strict=True):
        end[own, 0] = at
    mesh = before.layout.mesh.with_nodes(start)
    nodes = start + plan.moves.of(mesh, end - start)
    nodes[plan.held] = end[plan.held]
    return replace(before.layout, mesh=mesh.with_nodes(nodes)), plane.places_of(columns.walls)


def _problem(plan: SectionPlan, plane: SectionPlane, mesh: QuadMesh, *, ends_slide: bool = False) -> Problem:
    held = plan.held.copy()
    if ends_slide:
        for own in plan.ends:
            held[own] = False
        held[plan.columns] = True
    problem = problem_of(mesh, held)
    if problem is None:
        raise folded_section(plane, mesh)
    return problem


def _optimum(
    plan: SectionPlan, plane: SectionPlane, layout: Layout, problem: Problem, iterations: int
) -> Layout:
    growth = STEEP, MARGIN * math.log(plan.growth)
    optimum = minimise(problem, iterations, TOLERANCE, ((FLAT, SMOOTH),), growth)
    if not optimum.valid:
        raise folded_section(plane, optimum.mesh)
    return replace(layout, mesh=optimum.mesh)
