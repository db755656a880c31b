"""The passage of a cascade: the plane of its conformal map, in which blocks are optimised, and the way back.

::

    blade (or the front of its layers), pitch --map--> a domain with two holes, and blocks in it
    layout --cut, moved next to the blade--> with layers of the blade, and rows to inlet and outlet
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.domain.periodic import Periodic
from meshonet.geometry.elementary import product
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking.cascade.passage_map import PassageMap, inner_point
from meshonet.solvers.blocking.cascade.unwrap import unwrap
from meshonet.solvers.blocking.layers.attach import Rows, attach, loop_nodes

BLADE, INLET, OUTLET = 0, 1, 2
"""Numbers of the loops of a passage in the plane of its map."""
NEAR = 0.3
"""Distance in pitches, upstream and downstream of a blade, at which blocks end and straight rows start."""
_ROUND = 96  # points of the circles that inlet and outlet are in the plane of the map
STRETCH_NAMES = ("periodic1", "outlet", "periodic2", "inlet")


@dataclass(frozen=True, eq=False)
class Passage:
    """The passage around one blade of a cascade.

    Parameters
    ----------
    front : the blade, or the front of its layers, with the passage on its left.
    map : conformal map to a plane in which the passage is an ordinary domain.
    domain : this domain, with the loops front, inlet, outlet.
    inlet, outlet : axial distances from the centre of the map at which blocks end.
    """

    front: Loop
    map: PassageMap
    domain: Domain
    inlet: float
    outlet: float

    @classmethod
    def around(
        cls, front: Loop, pitch: complex, inlet: float, outlet: float, name: str = "",
        near: tuple[float, float] = (NEAR, NEAR), centre: complex | None = None,
    ) -> Passage:  # fmt: skip
        """Return the passage around a closed front; `pitch` points to the next blade, left of the flow.

        `inlet` and `outlet` are the largest distances from the front at which blocks end, `near` their usual
        distances in pitches; `centre` is that of the map.
        """
        points = front.curve.points
        passage = PassageMap(pitch, inner_point(points) if centre is None else centre)
        axial = passage.axial(points)
        before, behind = min(near[0] * abs(pitch), inlet), min(near[1] * abs(pitch), outlet)
        first, last = float(axial.min()) - before, float(axial.max()) + behind
        blade = Loop.of_polygon(passage.forward(points), front.corners, front.names)
        ends = [
            Loop.of_polygon(passage.line(distance, _ROUND), (), (side,))
            for distance, side in ((first, "inlet"), (last, "outlet"))
        ]
        return cls(front, passage, Domain((blade, *ends), name), first, last)

    @property
    def pitch(self) -> Floats:
        """(2,) displacement from a blade to the next."""
        return np.array([self.map.pitch.real, self.map.pitch.imag])

    def line_arcs(self, number: int, places: Floats) -> Floats:
        """Return the arc lengths (n,), on the circle of inlet or outlet, of `places` (n, 2) near it."""
        circle = self.domain.loops[number].curve
        along = self.map.along(self.map.back(np.concatenate([circle.points[:1], places])))
        share = np.mod((along[1:] - along[0]) * (1.0 if number == OUTLET else -1.0), 1.0)
        count = len(circle.points)
        knots = np.append(circle.knots, circle.length)
        return np.asarray(np.interp(share * count, np.arange(count + 1.0), knots) % circle.length)

    def front_arcs(self, arcs: Floats) -> Floats:
        """Return the arc lengths (n,) on the front for those of its image in the plane of the map."""
        loop = self.domain.loops[BLADE]
        here = np.append(loop.curve.knots, loop.length)
        there = np.append(self.front.curve.knots, self.front.length)
        return np.asarray(np.interp(np.mod(arcs, loop.length), here, there))


def laid_out(layout: Layout, passage: Passage, cut: Indices) -> tuple[Layout, Indices]:
    """Return the layout in the plane of the blade, cut along its nodes `cut` (k,).

    Its loops are those of the map's plane: the front, and lines at inlet and outlet. Also returned are the
    nodes (k,) of the lower side of the cut; the image of each has the next number.
    """
    flat, lower = unwrap(layout, passage.map, cut)
    nodes, places, pitch = flat.mesh.nodes, flat.mesh.places, passage.pitch
    on = np.flatnonzero(places.loop == BLADE)
    arcs = passage.front_arcs(places.arc[on])
    exact = passage.front.at(arcs)
    nodes -= np.round(passage.map.along(nodes[on]) - passage.map.along(exact)).mean() * pitch
    nodes[on], places.arc[on] = exact, arcs
    axis = np.array([passage.map.axis.real, passage.map.axis.imag])
    for loop, distance in ((INLET, passage.inlet), (OUTLET, passage.outlet)):
        on = np.flatnonzero(places.loop == loop)
        nodes[on] += (distance - passage.map.axial(nodes[on]))[:, None] * axis
        side = passage.map.along(nodes[on])
        # the passage is on the left of each loop: down at the inlet, up at the outlet
        places.arc[on] = side.max() - side if loop == INLET else side - side.min()
    nodes[lower + 1] = nodes[lower] + pitch
    return flat, lower


def extended(layout: Layout, cut: Indices, passage: Passage, wall: Loop, rows: Sequence[Rows]) -> Layout:
    """Return the layout with `rows` attached, around a `wall`, as a domain with periodic sides.

    `cut` (k,) are the nodes of the lower side of its cut.
    """
    mesh = layout.mesh
    count = len(mesh.nodes)
    domain = replace(passage.domain, loops=(wall, *passage.domain.loops[1:]))
    whole = attach(layout, domain, rows)
    images = np.flatnonzero(mesh.places.partner >= 0)
    above = np.empty(count, dtype=np.intp)
    above[mesh.places.partner[images]] = images
    low, high = [cut], [above[cut]]
    for each in rows:
        order, away = loop_nodes(mesh, each.loop), each.nodes.shape[1] - 1
        if each.loop != BLADE:
            ends = [count + np.arange(away) + away * k for k in (0, len(order) - 1)]
            if order[0] in images:
                ends.reverse()
            whole.mesh.places.partner[ends[1]] = ends[0]
            for line, new in zip((low, high), ends, strict=True):
                line.insert(*((0, new[::-1]) if each.loop == INLET else (len(line), new)))
        count += len(order) * away
    return _closed(whole, passage, np.concatenate(low), np.concatenate(high))


def _closed(layout: Layout, passage: Passage, lower: Indices, upper: Indices) -> Layout:
    """Return the layout in a domain whose outer loop is cut, outlet, cut and inlet."""
    mesh, places, pitch = layout.mesh, layout.mesh.places, passage.pitch
    nodes = mesh.nodes.copy()
    nodes[upper] = nodes[lower] + pitch
    along = product(nodes, pitch)
    ends = np.concatenate([lower, upper])
    outlet, inlet = (np.setdiff1d(np.flatnonzero(places.loop == loop), ends) for loop in (OUTLET, INLET))
    ring = [
        lower,
        outlet[np.argsort(along[outlet], kind="stable")],
        upper[::-1],
        inlet[np.argsort(-along[inlet], kind="stable")],
    ]
    order = np.concatenate(ring)
    sizes = np.cumsum([0, *(len(part) for part in ring)])
    corners = [0, len(lower) - 1, int(sizes[2]), int(sizes[3]) - 1]
    outer = Loop.of_polygon(nodes[order], tuple(corners), STRETCH_NAMES)
    loop, arc, cells = np.where(places.loop == BLADE, 1, -1), places.arc.copy(), places.cells.copy()
    cells[loop < 0] = 0
    loop[order], arc[order] = 0, outer.curve.knots
    cells[order[corners]] = outer.corner_cells
    knots = outer.curve.knots[corners]
    shift = (float(pitch[0]), float(pitch[1]))
    periodic = Periodic((float(knots[0]), float(knots[1])), (float(knots[2]), float(knots[3])), shift)
    domain = Domain((outer, mesh.domain.loops[BLADE]), passage.domain.name, periodic=(periodic,))
    moved = replace(places, loop=loop, arc=arc, cells=cells)
    return Layout(QuadMesh(domain, nodes, mesh.quads, moved), layout.blocks, layout.layers)


def turned_round(layout: Layout) -> Layout:
    """Return a passage with its periodic sides exchanged, so that the pitch is reversed."""
    mesh, places = layout.mesh, layout.mesh.places
    images = np.flatnonzero(places.partner >= 0)
    partner = np.full(len(places.partner), -1, dtype=np.intp)
    partner[places.partner[images]] = images
    loops = mesh.domain.loops
    if not mesh.domain.periodic:
        return layout
    names = tuple(loops[0].names[k] for k in (2, 1, 0, 3))
    outer = Loop(loops[0].curve, loops[0].corners, names)
    (periodic,) = mesh.domain.periodic
    shift = (-periodic.shift[0], -periodic.shift[1])
    swapped = Periodic(periodic.second, periodic.first, shift)
    domain = replace(mesh.domain, loops=(outer, *loops[1:]), periodic=(swapped,))
    return replace(layout, mesh=replace(mesh, domain=domain, places=replace(places, partner=partner)))
