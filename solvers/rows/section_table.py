"""The nodes of a section with layers and rows to inlet and outlet, numbered alike in all sections."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import log
from meshonet.geometry.errors import SolverError
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking.cascade.cascade_layout import row_steps, straight_rows
from meshonet.solvers.blocking.cascade.passage import BLADE, extended, laid_out
from meshonet.solvers.blocking.cascade.passage_template import cut_of
from meshonet.solvers.blocking.layers.attach import Rows, loop_nodes
from meshonet.solvers.blocking.layers.finished import evened
from meshonet.solvers.blocking.layers.layer_rows import heights_inside, ring_rows
from meshonet.solvers.blocking.sizes.refine import multiplied
from meshonet.solvers.rows.key_sections import SectionLayout, SectionPlan

_BISECTIONS = 60
_RATIO = 2.0


@dataclass(frozen=True, eq=False)
class SectionTable:
    """A whole section.

    Parameters
    ----------
    layout : in the plane of the section.
    wall : (k,) nodes of the blade, ascending.
    places : (k,) where they are, u.
    steps : cells of the rows to inlet and outlet, by the number of their loop.
    """

    layout: Layout
    wall: Indices
    places: Floats
    steps: dict[int, int]


def section_table(
    plan: SectionPlan, section: SectionLayout, like: SectionTable | None = None,
    longest: Mapping[int, float] | None = None,
) -> SectionTable:  # fmt: skip
    """Return a section with layers and rows to inlet and outlet, its nodes numbered as those `like` has.

    The first one has as many cells in these rows as their greatest lengths ask for, `longest` by loop.
    """
    cascade = section.plane.cascade
    passage = cascade.passage
    fine = multiplied(section.layout, plan.times)
    flat, cut = laid_out(fine, passage, cut_of(fine))
    mesh = flat.mesh
    inner = heights_inside(flat, BLADE)
    rows = [ring_rows(mesh, BLADE, cascade.ring, plan.rows, cascade.layers, inner)]
    axis = np.array([passage.map.axis.real, passage.map.axis.imag])
    counts: dict[int, int] = {}
    for number, length, way in straight_rows(cascade):
        start = mesh.nodes[loop_nodes(mesh, number)]
        first = math.exp(log(heights_inside(flat, number)).mean())
        if like is None:
            most = max(length, (longest or {}).get(number, length))
            counts[number] = len(row_steps(first, most, plan.metric(section.plane).largest)) - 1
        else:
            counts[number] = like.steps[number]
        steps = _grown(first, length, counts[number])
        rows.append(Rows(number, start[:, None] + steps[:, None] * (way * axis), np.zeros(len(start)), False))
    whole = extended(flat, cut, passage, cascade.blade, rows)
    whole = evened(whole, cascade.layers)
    if like is not None:
        whole = _as_numbered(whole, like.layout)
    wall = np.flatnonzero(whole.mesh.places.loop == 1)
    places = section.plane.places_of(whole.mesh.places.arc[wall])
    return SectionTable(whole, wall, places, counts)


def _as_numbered(layout: Layout, like: Layout) -> Layout:
    """Return the layout with its nodes numbered as those at the same places in the blocks of another."""
    ours, theirs = (np.concatenate([block.ravel() for block in each.blocks]) for each in (layout, like))
    same = np.full(len(like.mesh.nodes), -1, dtype=np.intp)
    if len(ours) == len(theirs) and len(layout.mesh.nodes) == len(same):
        same[theirs] = ours
    if (same < 0).any() or not np.array_equal(same[theirs], ours):
        raise SolverError("the blocks of sections differ")
    mesh = layout.mesh
    places = replace(like.mesh.places, arc=mesh.places.arc[same])
    return replace(like, mesh=replace(like.mesh, domain=mesh.domain, nodes=mesh.nodes[same], places=places))


def _grown(first: float, length: float, cells: int) -> Floats:
    """Return distances (cells + 1,) from 0 to a length of cells that follow one of size `first` evenly."""
    low, high = 1.0 / _RATIO, _RATIO
    for _ in range(_BISECTIONS):
        ratio = 0.5 * (low + high)
        total = first * sum(math.pow(ratio, k + 1) for k in range(cells))
        low, high = (low, ratio) if total > length else (ratio, high)
    steps = np.concatenate([[0.0], np.cumsum([math.pow(ratio, k + 1) for k in range(cells)])])
    return np.asarray(steps * (length / steps[-1]))
