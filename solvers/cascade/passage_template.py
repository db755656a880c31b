r"""Blocks of a cascade's passage: a ring around the blade, the channel, and rows to inlet and outlet.

In the plane G of a `PassageFlow`, where the blade is a slit, all blocks except the ring are rectangles. In
the drawing, the blocks above the cut are not yet moved down by the period::

    iπ - e  +----------+=====================+----------+     = the ring's outer side
            |          |       channel       |          |
       i e  +----------s=====================s----------+
      inlet |          | ring [--slit--] ring|          | outlet
      -i e  +----------s=====================s----------+

Five blocks meet at each s, four at all other interior vertices. The channel, and the parts upstream and
downstream of it, are two rows of blocks each. The grid line between them leads from inlet to outlet and is
called the cut.
"""

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats, Indices
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.elementary import arccosh, cosh, exp, modulus
from meshonet.geometry.layout.lattice import lattice_quads
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.solvers.cascade.passage import BLADE, INLET, OUTLET, Passage
from meshonet.solvers.cascade.passage_flow import PassageFlow

CELLS = 6  # number of cells across the ring, and smallest number along each side of a block
LONG = np.pi / 12.0  # length of cells along the channel in the plane G
LONGEST = 72  # largest number of cells along the channel
ASIDE, AHEAD = 0.45, 0.12
"""Distances of the ring's outer side from the slit, beside it and at its ends; the period is π."""

_SAME = 1e-9  # distance in the plane G at which nodes are one
_FEET = 1e3  # positions in the plane G of the nodes on the blade, which have no meaning


def template(passage: Passage, *, at_corners: bool) -> Layout:
    """Return initial blocks of a passage; if `at_corners`, the nearest nodes move to corners of the blade."""
    flow = PassageFlow.of(passage.zeta(passage.front.curve.points))
    pieces, angles = _pieces(flow, passage)
    potential, blocks = _joined_pieces(pieces)
    off_blade = modulus(potential) < 0.5 * _FEET
    nodes = passage.of_zeta(flow.to_places(np.where(off_blade, potential, 0.5j * np.pi)))
    ends = [
        np.unique(np.concatenate([block[k] for block in own]))
        for k, own in ((0, blocks[:3]), (-1, blocks[5:8]))
    ]
    # far from blades streamlines are straight: where they are, and how far up each is
    up = [potential[own].imag / np.pi for own in ends]
    tops = [
        float((passage.along(nodes[own]) - share).mean()) + 0.5 for own, share in zip(ends, up, strict=True)
    ]
    domain = passage.domain(*tops)
    places = Places.inside(len(nodes))
    feet, angle = np.concatenate([block[:, 0] for block in blocks[-4:]]), np.concatenate(angles)
    places.loop[feet], places.arc[feet] = BLADE, _blade_arcs(flow, angle, passage.front)
    for number, own, share in zip((INLET, OUTLET), ends, up, strict=True):
        places.loop[own] = number
        places.arc[own] = abs(passage.period) * np.clip(
            0.5 + (share if number == OUTLET else -share), 0.0, 1.0
        )
    on = np.flatnonzero(places.loop >= 0)
    nodes[on] = domain.at(places.loop[on], places.arc[on])
    _tie(places, potential)
    images = np.flatnonzero(places.partner >= 0)
    nodes[images] = nodes[places.partner[images]] + passage.pitch
    layout = Layout(QuadMesh(domain, nodes, lattice_quads(blocks), places), blocks)
    if at_corners:
        _put_at_corners(layout, passage.front)
    return layout


def _tie(places: Places, potential: Complexes) -> None:
    """Make the nodes of the lower side of the cut the partners of those of the upper side, in place."""
    sides = []
    for end in (0.5 * np.pi, -0.5 * np.pi):
        own = np.flatnonzero((np.abs(potential.imag - end) < _SAME) & (places.loop != BLADE))
        sides.append(own[np.argsort(potential[own].real, kind="stable")])
    places.partner[sides[0]] = sides[1]


def _pieces(flow: PassageFlow, passage: Passage) -> tuple[list[Complexes], list[Floats]]:
    """Return the twelve blocks in the plane G, those of the ring last, and the angles (n,) of `_ring`."""
    x = flow.half + AHEAD
    to_axis = np.pi / abs(passage.period)
    before = max(flow.far[0] - to_axis * passage.inlet, x + AHEAD)
    behind = max(to_axis * passage.outlet - flow.far[1], x + AHEAD)
    columns = (-before, -x, x, behind)
    along = int(min(max(CELLS, round(2.0 * x / LONG)), LONGEST))
    rows = ((-ASIDE, ASIDE), (ASIDE, 0.5 * np.pi), (-0.5 * np.pi, -ASIDE))
    pieces = []
    for i in range(3):
        for j in range(3):
            if (i, j) != (1, 0):
                u = np.linspace(columns[i], columns[i + 1], (along if i == 1 else CELLS) + 1)[:, None]
                v = np.linspace(*rows[j], CELLS + 1)[None, :]
                pieces.append(np.asarray(u + 1j * v, dtype=np.complex128))
    ring, angles = _ring(flow, x, along)
    return pieces + ring, angles


def _ring(flow: PassageFlow, x: float, cells: int) -> tuple[list[Complexes], list[Floats]]:
    """Return the four blocks of the ring, i clockwise, j away from the blade, and angles ν (n,) at j = 0.

    Lines leave the slit along hyperbolae, G = h cosh(μ + iν).
    """
    along, up = np.linspace(-x, x, cells + 1), np.linspace(-ASIDE, ASIDE, CELLS + 1)
    blocks, angles = [], []
    for side in (along + 1j * ASIDE, x - 1j * up, -along - 1j * ASIDE, -x + 1j * up):
        outer = arccosh(side / flow.half)
        lines = np.linspace(0.0, 1.0, CELLS + 1) * outer.real[:, None] + 1j * outer.imag[:, None]
        blocks.append(flow.half * cosh(lines))
        blocks[-1][:, 0] = _FEET * exp(1j * outer.imag)  # away from all others: nodes are told apart
        angles.append(outer.imag)
    return blocks, angles


def _joined_pieces(pieces: list[Complexes]) -> tuple[Complexes, tuple[Indices, ...]]:
    """Return the distinct positions of nodes, and the blocks as indices of these."""
    places = np.concatenate([piece.ravel() for piece in pieces])
    inner = np.zeros(len(places), dtype=bool)
    ends = np.cumsum([0, *(piece.size for piece in pieces)])
    for start, piece in zip(ends[:-1], pieces, strict=True):
        inner[start : start + piece.size].reshape(piece.shape)[1:-1, 1:-1] = True
    side = np.flatnonzero(~inner)
    own = np.arange(len(places))
    away = places[side, None] - places[side]
    own[side] = side[(modulus(away) < _SAME).argmax(axis=1)]
    kept, number = np.unique(own, return_inverse=True)
    parts = np.split(number.astype(np.intp), ends[1:-1])
    return places[kept], tuple(part.reshape(piece.shape) for part, piece in zip(parts, pieces, strict=True))


def _put_at_corners(layout: Layout, front: Loop) -> None:
    """Move the nearest free node to each corner of the front, in place."""
    places = layout.mesh.places
    free = places.loop == BLADE
    for arc, cells in zip(front.corner_arcs, front.corner_cells, strict=True):
        away = np.abs(places.arc - arc)
        away = np.where(free, np.minimum(away, front.length - away), np.inf)
        node = int(np.argmin(away))
        places.arc[node], places.cells[node], free[node] = arc, cells, False
        layout.mesh.nodes[node] = front.at(np.array([arc]))[0]


def _blade_arcs(flow: PassageFlow, angles: Floats, front: Loop) -> Floats:
    """Return the arc lengths (k,) on the loop of the blade for angles (k,) around the slit."""
    turn = 2.0 * np.pi
    around, knots = flow.around, np.append(front.curve.knots, front.length)
    parts = len(around) // (len(knots) - 1)
    knots = np.interp(np.arange(len(around) + 1) / parts, np.arange(len(knots)), knots)
    closed = np.append(around, around[0] + np.copysign(turn, around[-1] - around[0]))
    if closed[-1] < closed[0]:
        closed, knots = closed[::-1], knots[::-1]
    at = closed[0] + np.mod(angles - closed[0], turn)
    return np.asarray(np.mod(np.interp(at, closed, knots), front.length))
