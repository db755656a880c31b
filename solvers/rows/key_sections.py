"""Key sections of a row: the same blocks and counts in all, each from the nodes of its neighbour.

::

    the middle section: template, counts, optimum -> places of the nodes around the blade, for all sections
    its neighbours, and theirs: the nodes of the last one carried along, then the optimum

Sections change little from one to the next, so that few iterations lead to the next optimum.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from meshonet.geometry.arrays import Floats, pairs_of
from meshonet.geometry.errors import NoValidGridError
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking.cascade.cascade_layout import FIRST, WEIGHTS, counts_of, passage_optimum
from meshonet.solvers.blocking.cascade.passage import BLADE, INLET, OUTLET
from meshonet.solvers.blocking.cascade.passage_template import template
from meshonet.solvers.blocking.layers.layer_law import layer_arcs
from meshonet.solvers.blocking.layers.layer_rows import JOIN
from meshonet.solvers.blocking.sizes.chords import Chords
from meshonet.solvers.blocking.sizes.refine import refine
from meshonet.solvers.blocking.sizes.size_metric import SizeMetric
from meshonet.solvers.energy.quads import optimise
from meshonet.solvers.rows.harmonic import harmonic
from meshonet.solvers.rows.opposite import at_corners, opposite_places
from meshonet.solvers.rows.section_plane import SectionPlane

UPPER, TRAILING, LOWER, LEADING = 8, 9, 10, 11
"""Numbers of the template's blocks around the blade."""
ITERATIONS, FROM_NEIGHBOUR = 300, 60
TOLERANCE = 1e-5
_STEPS = 3  # in which nodes around the blade are moved to new places


@dataclass(frozen=True, eq=False)
class SectionLayout:
    """The blocks outside the layers of a section, in the plane of its map."""

    plane: SectionPlane
    layout: Layout


@dataclass(frozen=True, eq=False)
class SectionPlan:
    """What all sections have in common.

    Parameters
    ----------
    scale : of the sizes of cells along the blade.
    times : how many times finer than the optimised ones blocks are to be.
    rows : of layers.
    wall : (k,) nodes around the blade, in the order of `places`.
    places : (k,) where they are, u.
    """

    scale: float
    times: int
    rows: int
    wall: Indices
    places: Floats

    def metric(self, plane: SectionPlane) -> SizeMetric:
        """Return the sizes of cells of a section: those beyond a number of layers that is the same in all."""
        cascade = plane.cascade
        thickness = cascade.ring.thickness
        none = np.full(len(thickness), np.inf)
        arcs = layer_arcs(thickness, cascade.layers.first, none, self.rows)
        return replace(cascade.scaled(self.scale), across=JOIN * (arcs[:, -1] - arcs[:, -2]))


def planned(
    planes: Sequence[SectionPlane], cells: int, *, opposite: bool
) -> tuple[SectionPlan, SectionLayout]:
    """Return the plan for sections of about so many `cells` each, and the middle one of `planes`.

    With `opposite` nodes on both sides of the blade are opposite each other.
    """
    plane = planes[len(planes) // 2]
    for early in (True, False):
        try:
            return _planned(plane, planes, cells, opposite, early)
        except NoValidGridError:
            if not early:
                raise
    raise AssertionError


def _planned(
    plane: SectionPlane, planes: Sequence[SectionPlane], cells: int, opposite: bool, early: bool
) -> tuple[SectionPlan, SectionLayout]:
    """Return the plan and the middle section, `early` with nodes at corners of the blade from the start."""
    cascade = plane.cascade
    coarse = passage_optimum(template(cascade.passage, at_corners=early), FIRST, None)
    chords = Chords.of(coarse)
    counts, times, metric = counts_of(cascade, chords, cells, None)
    ends = [chords.chord[chords.sides[block, 0]] for block in (TRAILING, LEADING)]
    counts[ends] = counts[ends].max()
    rows = max(each.cascade.rows_of_layers for each in planes)
    scale = float((metric.along / cascade.metric.along).mean())
    layout = refine(coarse, counts, chords)
    wall = around_blade(layout)
    plan = SectionPlan(scale, times, rows, wall, np.empty(0))
    layout = _optimum(layout, plan.metric(plane), ITERATIONS, None)
    places = plane.places_under(layout.mesh.places.arc[wall])
    places = at_corners(opposite_places(places) if opposite else places, plane.corners)
    plan = replace(plan, places=places)
    for k in range(1, _STEPS + 1):  # the others follow, before cells fold
        layout = _with_places(layout, plan, plane, 1.0 / (_STEPS + 1 - k))
        layout = _optimum(layout, plan.metric(plane), ITERATIONS // _STEPS, wall)
    return plan, SectionLayout(plane, layout)


def next_section(plan: SectionPlan, before: SectionLayout, plane: SectionPlane) -> SectionLayout:
    """Return a section from its neighbour's.

    Raises NoValidGridError: its cells stay folded.
    """
    layout = carried(before, plane, plan)
    held = np.flatnonzero(layout.mesh.places.loop >= 0)  # at inlet and outlet too, where nodes would gather
    return SectionLayout(plane, _optimum(layout, plan.metric(plane), FROM_NEIGHBOUR, held))


def around_blade(layout: Layout) -> Indices:
    """Return the nodes (k,) around the blade, from the first of the upper side on, clockwise."""
    sides = [layout.blocks[number][:-1, 0] for number in (UPPER, TRAILING, LOWER, LEADING)]
    return np.concatenate(sides)


def _with_places(layout: Layout, plan: SectionPlan, plane: SectionPlane, part: float) -> Layout:
    """Return the layout with the nodes around the blade moved a `part` of the way to their places."""
    mesh, wall = layout.mesh, plan.wall
    loop = mesh.domain.loops[BLADE]
    arc, nodes = mesh.places.arc.copy(), mesh.nodes.copy()
    step = plane.image_arcs(plan.places) - arc[wall]
    step = np.mod(step + 0.5 * loop.length, loop.length) - 0.5 * loop.length
    arc[wall] = np.mod(arc[wall] + part * step, loop.length)
    nodes[wall] = loop.at(arc[wall])
    return replace(layout, mesh=mesh.with_nodes(nodes, arc))


def carried(before: SectionLayout, plane: SectionPlane, plan: SectionPlan) -> Layout:
    """Return the layout of a section's neighbour with its boundary that of the section.

    Displacements are those in (m', theta), from the centres of the maps, and harmonic between the boundaries:
    in the planes of the maps inlet and outlet are circles whose sizes differ by large factors. Inlet and
    outlet follow the edges of the blade in theta.
    """
    mesh, domain = before.layout.mesh, plane.cascade.passage.domain
    old, new = before.plane.cascade.passage, plane.cascade.passage
    arc = mesh.places.arc.copy()
    start = old.map.back(mesh.nodes) - pairs_of(np.array(old.map.centre))
    end = start.copy()
    arc[plan.wall] = plane.image_arcs(plan.places)
    for passage, arcs, out in ((old, mesh.places.arc, start), (new, arc, end)):
        centre = pairs_of(np.array(passage.map.centre))
        out[plan.wall] = passage.front.at(passage.front_arcs(arcs[plan.wall])) - centre
    aside = plane.edges_aside - before.plane.edges_aside
    ends = ((INLET, new.inlet - old.inlet, aside[0]), (OUTLET, new.outlet - old.outlet, aside[1]))
    for number, along, across in ends:
        own = np.flatnonzero(mesh.places.loop == number)
        end[own] = start[own] + [along, across]
        arc[own] = new.line_arcs(number, new.map.forward(end[own] + pairs_of(np.array(new.map.centre))))
    moves = harmonic(mesh, end - start, mesh.places.loop >= 0)
    nodes = new.map.forward(start + moves + pairs_of(np.array(new.map.centre)))
    for number, loop in enumerate(domain.loops):
        own = np.flatnonzero(mesh.places.loop == number)
        nodes[own] = loop.at(arc[own])
    return replace(before.layout, mesh=QuadMesh(domain, nodes, mesh.quads, replace(mesh.places, arc=arc)))


def _optimum(layout: Layout, metric: SizeMetric, iterations: int, wall: Indices | None) -> Layout:
    """Return the layout with nodes where the functional is least, nodes `wall` (k,) held."""
    held = None if wall is None else np.isin(np.arange(len(layout.mesh.nodes)), wall)
    optimum = optimise(
        layout.mesh, iterations=iterations, targets=metric.gradual(layout.mesh), held=held,
        tolerance=TOLERANCE, weights=WEIGHTS,
    )  # fmt: skip
    if not optimum.valid:
        raise NoValidGridError("cells of a section stay folded")
    return replace(layout, mesh=optimum.mesh)
