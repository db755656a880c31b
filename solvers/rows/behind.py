"""Nodes behind the blade whose positions change evenly along the span.

The functional hardly holds nodes along the flow; on short spans, lines along the span would lean strongly.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, smooth_step
from meshonet.geometry.layout.lattice import smallest_jacobians
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.solvers.rows.key_sections import KeySection
from meshonet.solvers.rows.span_lines import SpanLines, key_heights

_DEGREE = 2  # degree of the polynomials of the height
_FROM, _TO = 1.0, 1.15  # shares of the way along the blade where moves begin and where they are complete
_CELLS = 4  # number of cells beyond the layers from which on nodes are moved fully
_PARTS = 1.0, 0.5, 0.25  # fractions of the way to the polynomials, tried in turn
_KEPT = 0.4  # smallest accepted ratio of a cell's smallest Jacobian after the move to the one before it


def even_behind(sections: Sequence[KeySection], columns: Indices) -> tuple[KeySection, ...]:
    """Return the sections; nodes behind the blade are moved onto smooth lines along the span.

    Sections are at the heights `key_heights`. `columns` (k, m) are the nodes on k grid lines through the
    layers. They stay, and nodes near them move less. All nodes move less if cells would get too small.
    """
    mesh = sections[0].layout.mesh
    values = []
    for section in sections:
        nodes, edge = section.layout.mesh.nodes, section.plane.edges[1]
        values.append(np.stack([section.plane.shares(nodes), nodes[:, 1] - edge[1]], axis=1))
    shares = values[len(values) // 2][:, 0]
    part = _smooth((shares - _FROM) / (_TO - _FROM)) * _smooth(_cells_from(mesh, columns) / _CELLS)
    moved = np.flatnonzero(part > 0.0)
    lines = SpanLines.through(np.array(values)[:, moved], _DEGREE)
    even = lines.at(key_heights(len(sections))[:, None])
    quads = mesh.quads[(part > 0.0)[mesh.quads].any(axis=1)]
    for less in _PARTS:
        made = [
            _moved(section, moved, wanted, less * part[moved])
            for section, wanted in zip(sections, even, strict=True)
        ]
        pairs = (
            [smallest_jacobians(each.layout.mesh.nodes, quads) for each in two]
            for two in zip(sections, made, strict=True)
        )
        if all((after > _KEPT * before).all() for before, after in pairs):
            return tuple(made)
    return tuple(sections)


def _moved(section: KeySection, moved: Indices, wanted: Floats, part: Floats) -> KeySection:
    """Return a section with nodes `moved` (k,) by fractions (k,) of the way to shares and theta (k, 2)."""
    plane, mesh = section.plane, section.layout.mesh
    nodes = mesh.nodes.copy()
    to = np.stack([plane.stations(wanted[:, 0]), wanted[:, 1] + plane.edges[1, 1]], axis=1)
    nodes[moved] += part[:, None] * (to - nodes[moved])
    return replace(section, layout=replace(section.layout, mesh=mesh.with_nodes(nodes)))


def _smooth(t: Floats) -> Floats:
    return smooth_step(np.clip(t, 0.0, 1.0))


def _cells_from(mesh: QuadMesh, columns: Indices) -> Floats:
    """Return the number of edges (n,), at most 4, between nodes and layers."""
    away = np.full(len(mesh.nodes), float(_CELLS))
    away[columns] = 0.0
    partner = mesh.places.partner
    own = np.where(partner >= 0, partner, np.arange(len(partner)))
    ends = own[mesh.edges]
    for _ in range(_CELLS - 1):
        for one, other in (ends.T, ends.T[::-1]):
            np.minimum.at(away, one, away[other] + 1.0)
    return away[own]
