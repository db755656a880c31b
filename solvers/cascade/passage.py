"""The passage of a cascade outside the blade's layers; its blocks, with layers and rows to both ends.

::

    inlet ----------------- cut ------------------ outlet
      |         .-----------------------.            |        nodes of the upper side of the cut
      |        (          blade          )           |        are those of the lower side, moved
      |         '-----------------------'            |        by the pitch
    inlet ----------------- cut ------------------ outlet
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats, Indices, complex_of, pairs_of
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.domain.periodic import Periodic
from meshonet.geometry.elementary import product, times
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.periodic_sides import chain, following
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.solvers.blocking.layers.attach import Rows, attach

BLADE, INLET, OUTLET = 0, 1, 2  # numbers of the loops of a passage whose blocks end at the layers
NEAR = 0.3  # distance in pitches, up- and downstream of a blade, at which blocks end and straight rows start
STRETCH_NAMES = ("periodic1", "outlet", "periodic2", "inlet")
_SMALL = 1e-12  # width of a blade below which a chord of it is no inside


@dataclass(frozen=True, eq=False)
class Passage:
    """The passage around one blade of a cascade.

    Parameters
    ----------
    front : clockwise loop along the blade, or along the outer edge of its layers.
    period : displacement from one blade to the next one on the left of the flow direction.
    centre : point inside the blade from which axial distances are measured.
    inlet, outlet : axial distances from `centre` at which the blocks end upstream and downstream.
    name : name of the blade.
    """

    front: Loop
    period: complex
    centre: complex
    inlet: float
    outlet: float
    name: str = ""

    @classmethod
    def around(
        cls, front: Loop, period: complex, inlet: float, outlet: float, name: str = "",
        near: tuple[float, float] = (NEAR, NEAR), centre: complex | None = None,
    ) -> Self:  # fmt: skip
        """Return the passage around a closed front (the blade, or the outer edge of its layers).

        It reaches from the length `inlet` upstream of the front to `outlet` downstream. The blocks around the
        front end earlier, at the distances `near` in pitches, if these are shorter than `inlet` and `outlet`;
        straight grid lines fill the rest. `centre` is a point inside the front.
        """
        points = front.curve.points
        centre = inner_point(points) if centre is None else centre
        passage = cls(front, period, centre, 0.0, 0.0, name)
        axial = passage.axial(points)
        before, behind = min(near[0] * abs(period), inlet), min(near[1] * abs(period), outlet)
        return replace(passage, inlet=float(axial.min()) - before, outlet=float(axial.max()) + behind)

    @property
    def pitch(self) -> Floats:
        """(2,) displacement from a blade to the next."""
        return np.array([self.period.real, self.period.imag])

    @property
    def axis(self) -> Floats:
        """(2,) unit vector from inlet to outlet, perpendicular to the pitch."""
        return np.array([self.period.imag, -self.period.real]) / abs(self.period)

    def axial(self, points: Floats) -> Floats:
        """Return the axial coordinates (n,) of points (n, 2): 0 at `centre`, positive towards the outlet."""
        return product(points - pairs_of(np.array(self.centre)), self.axis)

    def along(self, points: Floats) -> Floats:
        """Return the coordinates (n,) of points (n, 2) along the pitch vector, in pitches; 0 at `centre`."""
        return np.asarray(((complex_of(points) - self.centre) / self.period).real)

    def at(self, axial: Sequence[float], pitches: Sequence[float]) -> Floats:
        """Return points (n, 2): centre + `axial` * (unit vector of the axis) + `pitches` * (pitch vector)."""
        centre = pairs_of(np.array(self.centre))
        return centre + np.array(axial)[:, None] * self.axis + np.array(pitches)[:, None] * self.pitch

    def zeta(self, points: Floats) -> Complexes:
        """Return complex coordinates ζ (n,) of points (n, 2): real along the axis, and iπ per pitch."""
        return np.asarray(times(1j * np.pi, (complex_of(points) - self.centre)) / self.period)

    def of_zeta(self, zeta: Complexes) -> Floats:
        """Return points (n, 2) from complex coordinates `zeta` (n,): the inverse of the method `zeta`."""
        return pairs_of(self.centre + times(zeta, self.period) / (1j * np.pi))

    def domain(self, inlet: float, outlet: float) -> Domain:
        """Return the domain of the blocks between the blade, the inlet and the outlet.

        The upper end of the inlet is `inlet` pitches above the blade's `centre`, measured along the pitch
        vector, that of the outlet `outlet` pitches. The lower ends are one pitch below.
        """
        pitch = abs(self.period)
        x, far = (self.inlet, self.outlet), (self.inlet - pitch, self.outlet + pitch)
        before = self.at([x[0], x[0], far[0], far[0]], [inlet, inlet - 1.0, inlet - 1.0, inlet])
        behind = self.at([x[1], x[1], far[1], far[1]], [outlet - 1.0, outlet, outlet, outlet - 1.0])
        around = self.at([far[0], far[1], far[1], far[0]], [0.0, 0.0, 1.0, 1.0])
        rectangles = [
            Loop.of_polygon(points, (0, 1, 2, 3), (name,))
            for points, name in ((before, "inlet"), (behind, "outlet"), (around, ""))
        ]
        shift = (self.period.real, self.period.imag)
        periodic = Periodic((0.0, 0.0), (0.0, 0.0), shift)
        return Domain((self.front, *rectangles), self.name, periodic=(periodic,))


def inner_point(polygon: Floats) -> complex:
    """Return the point, among test points inside a polygon (n, 2), that is farthest from its vertices."""
    low, high = polygon.min(axis=0), polygon.max(axis=0)
    best, most = complex(*polygon.mean(axis=0)), -1.0
    for rows in (40, 160, 640):
        x = np.linspace(low[0], high[0], rows + 2)[1:-1]
        for value in x:
            y = _crossings(polygon, value)
            if len(y) < 2:
                continue
            for a, b in zip(y[::2], y[1::2], strict=False):
                middle = np.array([value, 0.5 * (a + b)])
                room = float(np.hypot(*(polygon - middle).T).min())
                if room > most and b - a > _SMALL:
                    best, most = complex(*middle), room
        if most > 0:
            break
    return best


def _crossings(polygon: Floats, x: float) -> Floats:
    """Return the ascending y at which a closed polygon crosses the vertical line at `x`."""
    a, b = polygon, np.roll(polygon, -1, axis=0)
    across = (a[:, 0] > x) != (b[:, 0] > x)
    a, b = a[across], b[across]
    return np.sort(a[:, 1] + (x - a[:, 0]) / (b[:, 0] - a[:, 0]) * (b[:, 1] - a[:, 1]))


def extended(layout: Layout, passage: Passage, wall: Loop, rows: Sequence[Rows]) -> Layout:
    """Return the layout extended by `rows` of cells to the blade's `wall`, to the inlet and to the outlet."""
    mesh, cut = layout.mesh, _lower_side(layout.mesh)
    count = len(mesh.nodes)
    domain = replace(mesh.domain, loops=(wall, *mesh.domain.loops[1:]))
    whole = attach(layout, domain, rows)
    images = np.flatnonzero(mesh.places.partner >= 0)
    above = np.empty(count, dtype=np.intp)
    above[mesh.places.partner[images]] = images
    low, high = [cut], [above[cut]]
    for each in rows:
        order, away = mesh.places.along(each.loop), each.nodes.shape[1] - 1
        if each.loop != BLADE:
            ends = [count + np.arange(away) + away * k for k in (0, len(order) - 1)]
            if order[0] in images:
                ends.reverse()
            whole.mesh.places.partner[ends[1]] = ends[0]
            for line, new in zip((low, high), ends, strict=True):
                line.insert(*((0, new[::-1]) if each.loop == INLET else (len(line), new)))
        count += len(order) * away
    return _closed(whole, passage, np.concatenate(low), np.concatenate(high))


def _lower_side(mesh: QuadMesh) -> Indices:
    """Return the nodes (k,) on the lower periodic boundary of a passage, from inlet to outlet."""
    lower = mesh.places.partner[mesh.places.partner >= 0]
    begin, end = (int(lower[mesh.places.loop[lower] == number][0]) for number in (INLET, OUTLET))
    return chain(following(mesh), begin, end)


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
    domain = Domain((outer, mesh.domain.loops[BLADE]), passage.name, periodic=(periodic,))
    moved = replace(places, loop=loop, arc=arc, cells=cells)
    return Layout(QuadMesh(domain, nodes, mesh.quads, moved), layout.blocks, layout.layers)


def turned_round(layout: Layout) -> Layout:
    """Return a passage with its two periodic sides exchanged and its pitch reversed."""
    mesh, places = layout.mesh, layout.mesh.places
    images = np.flatnonzero(places.partner >= 0)
    partner = np.full(len(places.partner), -1, dtype=np.intp)
    partner[places.partner[images]] = images
    loops = mesh.domain.loops
    names = tuple(loops[0].names[k] for k in (2, 1, 0, 3))
    outer = Loop(loops[0].curve, loops[0].corners, names)
    (periodic,) = mesh.domain.periodic
    shift = (-periodic.shift[0], -periodic.shift[1])
    swapped = Periodic(periodic.second, periodic.first, shift)
    domain = replace(mesh.domain, loops=(outer, *loops[1:]), periodic=(swapped,))
    return replace(layout, mesh=replace(mesh, domain=domain, places=replace(places, partner=partner)))
