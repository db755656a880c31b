"""The passage of a cascade: the plane of its map, where blocks are found, and the way back.

::

    blade (or the front of its layers), pitch --map--> a domain with two holes --blocks--> layout
    layout --cut, laid out beside the blade--> layers of the blade, rows to inlet and outlet attached
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.domain import Domain, Periodic
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking.attach import Rows, attach, loop_nodes, quads_of
from meshonet.solvers.blocking.passage_map import PassageMap, inner_point
from meshonet.solvers.blocking.unwrap import BLADE, INLET, OUTLET, unwrap

NEAR = 0.3
"""Pitches in front of and behind a blade that blocks are found in; straight rows lead on from there."""
_ROUND = 96  # points of the circles that inlet and outlet are in the plane of the map
STRETCH_NAMES = ("periodic1", "outlet", "periodic2", "inlet")


@dataclass(frozen=True, eq=False)
class Passage:
    """A cascade around one blade.

    Parameters
    ----------
    front : the blade, or the front of its layers, the passage on its left.
    map : to the plane in which it is an ordinary domain.
    domain : that domain: front, inlet, outlet.
    inlet, outlet : distances from the centre of the map, along its axis, at which blocks end.
    """

    front: Loop
    map: PassageMap
    domain: Domain
    inlet: float
    outlet: float

    @classmethod
    def around(cls, front: Loop, pitch: tuple[float, float], name: str = "") -> Passage:
        """Return the passage around a closed front; `pitch` leads to the next blade, left of the flow."""
        points = front.curve.points
        passage = PassageMap(complex(*pitch), inner_point(points))
        axial = passage.axial(points)
        near = NEAR * abs(passage.pitch)
        inlet, outlet = float(axial.min()) - near, float(axial.max()) + near
        places = passage.forward(points)
        blade = Loop(_polygon(places), front.corners, front.names)
        ends = [
            Loop(_polygon(passage.line(distance, _ROUND)), (), (side,))
            for distance, side in ((inlet, "inlet"), (outlet, "outlet"))
        ]
        return cls(front, passage, Domain((blade, *ends), name), inlet, outlet)

    def front_arcs(self, arcs: Floats) -> Floats:
        """Return the arc lengths (n,) of the front at those of its image in the plane of the map."""
        loop = self.domain.loops[BLADE]
        count = len(loop.curve.points)
        index = np.interp(
            np.mod(arcs, loop.length), np.append(loop.curve.knots, loop.length), np.arange(count + 1.0)
        )
        knots = np.append(self.front.curve.knots, self.front.length)
        return np.interp(index, np.arange(count + 1.0), knots)


def _polygon(points: Floats) -> Curve:
    return Curve(points, closed=True, corners=(), straight=np.ones(len(points), dtype=bool))


def laid_out(layout: Layout, passage: Passage) -> tuple[Layout, Indices, Indices]:
    """Return the layout beside the blade, and the nodes (k,) of the lower and upper side of its cut.

    Its loops are still those of the map's plane: the front, and lines of nodes at inlet and outlet. Nodes of
    front, inlet and outlet lie on them, those of the upper side are exactly a pitch from their partners.
    """
    ordered = replace(layout, mesh=replace(layout.mesh, quads=quads_of(layout.blocks)))
    flat = unwrap(ordered, passage.map)
    nodes, places = flat.nodes, flat.places
    on = np.flatnonzero(places.loop == BLADE)
    arcs = passage.front_arcs(places.arc[on])
    nodes[on] = passage.front.at(arcs) + _turned(nodes[on], passage.front.at(arcs), passage.map)
    places.arc[on] = arcs
    for loop, distance in ((INLET, passage.inlet), (OUTLET, passage.outlet)):
        on = np.flatnonzero(places.loop == loop)
        away = distance - passage.map.axial(nodes[on])
        axis = passage.map.axis
        nodes[on] += away[:, None] * np.array([axis.real, axis.imag])
        side = (nodes[on] @ np.array([passage.map.pitch.real, passage.map.pitch.imag])) / abs(
            passage.map.pitch
        )
        places.arc[on] = side - side.min()
        if loop == INLET:  # the passage is on the left of each loop: down at the inlet, up at the outlet
            places.arc[on] = places.arc[on].max() - places.arc[on]
    pitch = np.array([passage.map.pitch.real, passage.map.pitch.imag])
    nodes[flat.upper] = nodes[flat.lower] + pitch
    mesh = QuadMesh(passage.domain, nodes, quads_of(flat.blocks), places)
    return Layout(mesh, flat.blocks, layout.layers), flat.lower, flat.upper


def _turned(nodes: Floats, exact: Floats, passage: PassageMap) -> Floats:
    """Return the shifts (n, 2) by whole pitches that bring `exact` next to `nodes`."""
    pitch = np.array([passage.pitch.real, passage.pitch.imag])
    return np.asarray(passage.shifts(exact, nodes)[:, None] * pitch)


def extended(layout: Layout, passage: Passage, rows: list[Rows], lower: Indices, upper: Indices) -> Layout:
    """Return the layout with `rows` attached to its loops, as a domain of its own with periodic sides."""
    count = len(layout.mesh.nodes)
    whole = attach(layout, layout.mesh.domain, rows)
    partner = whole.mesh.places.partner
    low, high = [lower], [upper]
    for each in rows:
        order, away = loop_nodes(layout.mesh, each.loop), each.nodes.shape[1] - 1
        if each.loop != BLADE:
            ends = [count + np.arange(away) + away * k for k in (0, len(order) - 1)]
            if order[0] in upper:
                ends.reverse()
            partner[ends[1]] = ends[0]
            first = each.loop == INLET
            low.insert(0 if first else len(low), ends[0][::-1] if first else ends[0])
            high.insert(0 if first else len(high), ends[1][::-1] if first else ends[1])
        count += len(order) * away
    return _closed(whole, passage, np.concatenate(low), np.concatenate(high))


def _closed(layout: Layout, passage: Passage, lower: Indices, upper: Indices) -> Layout:
    """Return the layout in a domain whose outer loop is cut, outlet, cut and inlet."""
    mesh, places = layout.mesh, layout.mesh.places
    pitch = np.array([passage.map.pitch.real, passage.map.pitch.imag])
    nodes = mesh.nodes.copy()
    nodes[upper] = nodes[lower] + pitch
    along = (nodes @ pitch) / np.hypot(*pitch)
    outlet, inlet = (np.flatnonzero(places.loop == loop) for loop in (OUTLET, INLET))
    ring = [
        lower,
        _between(outlet[np.argsort(along[outlet])], lower, upper),
        upper[::-1],
        _between(inlet[np.argsort(-along[inlet])], lower, upper),
    ]
    order = np.concatenate(ring)
    sizes = np.cumsum([0, *(len(part) for part in ring)])
    corners = (0, len(lower) - 1, int(sizes[2]), int(sizes[3]) - 1)
    outer = Loop(_polygon(nodes[order]), corners, STRETCH_NAMES)
    loop, arc, cells = places.loop.copy(), places.arc.copy(), np.zeros_like(places.cells)
    loop[loop != BLADE] = -1
    on_blade = loop == BLADE
    cells[on_blade] = places.cells[on_blade]
    loop[on_blade] = 1
    loop[order], arc[order] = 0, outer.curve.knots
    cells[order[list(corners)]] = outer.corner_cells
    knots = outer.curve.knots
    first, second = (float(knots[corners[0]]), float(knots[corners[1]])), (
        float(knots[corners[2]]), float(knots[corners[3]]),
    )  # fmt: skip
    periodic = Periodic(first, second, (float(pitch[0]), float(pitch[1])))
    blade = layout.mesh.domain.loops[BLADE] if len(layout.layers) else passage.front
    domain = Domain((outer, blade), passage.domain.name, periodic=periodic)
    moved = replace(places, loop=loop, arc=arc, cells=cells)
    return Layout(QuadMesh(domain, nodes, mesh.quads, moved), layout.blocks, layout.layers)


def _between(nodes: Indices, lower: Indices, upper: Indices) -> Indices:
    """Return nodes without those of the cut."""
    return nodes[~np.isin(nodes, np.concatenate([lower, upper]))]
