r"""Blocks of a cascade's passage: a ring around the blade, the channel, and rows to inlet and outlet.

In the plane G of a `PassageFlow`, whose slit is the blade, all but the ring are rectangles::

    iπ - e  +----------+=====================+----------+     = the ring's outer side
            |          |       channel       |          |
       i e  +----------s=====================s----------+
      inlet |          | ring [--slit--] ring|          | outlet
      -i e  +----------s=====================s----------+

Five blocks meet at each s, four at all other nodes inside. The channel and what lies before and behind it
are two rows of blocks each, so that a line of nodes leads straight from inlet to outlet: the cut.
"""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking.attach import quads_of
from meshonet.solvers.blocking.passage import BLADE, INLET, OUTLET, Passage
from meshonet.solvers.blocking.passage_flow import PassageFlow
from meshonet.solvers.blocking.passage_map import complex_of, pairs_of

CELLS = 6
"""Cells across the ring, and at the least along each side of a block."""
LONG = np.pi / 12.0
"""Length of cells along the channel, in the plane of the flow."""
ASIDE, AHEAD = 0.45, 0.12
"""Distances of the ring's outer side from the slit, aside and at its ends; the period is π."""


_SAME = 1e-9  # distance in the disc at which nodes are one


def template(passage: Passage) -> Layout:
    """Return the layout of a passage in the plane of its map."""
    flow = PassageFlow.around(passage.map.zeta(passage.front.curve.points))
    x = flow.half + AHEAD
    w = complex_of(passage.domain.loops[BLADE].curve.points)
    ends = [
        max(flow.distance(w, passage.domain.loops[number].length / (2.0 * np.pi), behind), x + AHEAD)
        for number, behind in ((INLET, False), (OUTLET, True))
    ]
    columns = (-ends[0], -x, x, ends[1])
    along = max(CELLS, round(2.0 * x / LONG))
    rows = (-ASIDE, ASIDE, 0.5 * np.pi, np.pi - ASIDE)
    pieces = []
    for i in range(3):
        for j in range(3):
            if (i, j) != (1, 0):
                u = np.linspace(columns[i], columns[i + 1], (along if i == 1 else CELLS) + 1)[:, None]
                v = np.linspace(rows[j], rows[j + 1], CELLS + 1)[None, :]
                pieces.append(flow.disc(np.asarray(u + 1j * v, dtype=np.complex128)))
    pieces += _ring(flow, x, along)
    nodes, blocks = _joined(pieces)
    return _placed(passage, flow, nodes, blocks)


def _ring(flow: PassageFlow, x: float, cells: int) -> list[Complexes]:
    """Return the four blocks of the ring in the disc: i clockwise around the blade, j away from it."""
    along, up = np.linspace(-x, x, cells + 1), np.linspace(-ASIDE, ASIDE, CELLS + 1)
    sides = (along + 1j * ASIDE, x - 1j * up, -along - 1j * ASIDE, -x + 1j * up)
    blocks = []
    for side in sides:
        outer = flow.disc(side)
        foot = outer / np.abs(outer)
        share = np.linspace(0.0, 1.0, CELLS + 1)
        blocks.append(foot[:, None] + share * (outer - foot)[:, None])
    return blocks


def _joined(pieces: list[Complexes]) -> tuple[Complexes, tuple[Indices, ...]]:
    """Return the places of nodes, and blocks of their numbers: what coincides in the disc is one node."""
    places = np.concatenate([piece.ravel() for piece in pieces])
    inner = np.zeros(len(places), dtype=bool)
    ends = np.cumsum([0, *(piece.size for piece in pieces)])
    for start, piece in zip(ends[:-1], pieces, strict=True):
        inner[start : start + piece.size].reshape(piece.shape)[1:-1, 1:-1] = True
    side = np.flatnonzero(~inner)
    own = np.arange(len(places))
    own[side] = side[(np.abs(places[side, None] - places[side]) < _SAME).argmax(axis=1)]
    kept, number = np.unique(own, return_inverse=True)
    parts = np.split(number.astype(np.intp), ends[1:-1])
    return places[kept], tuple(part.reshape(piece.shape) for part, piece in zip(parts, pieces, strict=True))


def _placed(passage: Passage, flow: PassageFlow, nodes: Complexes, blocks: tuple[Indices, ...]) -> Layout:
    """Return the layout with nodes of the disc in the plane of the map, those of walls on its loops."""
    domain = passage.domain
    front = domain.loops[BLADE]
    mapped = pairs_of(flow.inside(complex_of(front.curve.points), nodes))
    places = Places.inside(len(nodes))
    feet = np.unique(np.concatenate([block[:, 0] for block in blocks[-4:]]))
    places.loop[feet], places.arc[feet] = BLADE, _arcs(flow, nodes[feet], front)
    for number, columns in (
        (INLET, [block[0] for block in blocks[:3]]),
        (OUTLET, [block[-1] for block in blocks[-7:-4]]),
    ):
        on = np.unique(np.concatenate(columns))
        places.loop[on] = number
        places.arc[on] = passage.line_arcs(number, mapped[on])
    for number, loop in enumerate(domain.loops):
        on = places.loop == number
        mapped[on] = loop.at(places.arc[on])
    return Layout(QuadMesh(domain, mapped, quads_of(blocks), places), blocks)


def cut_of(layout: Layout) -> Indices:
    """Return the nodes (k,) of the cut of a layout with the template's blocks, from the inlet."""
    return np.concatenate([layout.blocks[1][:, -1], layout.blocks[3][1:, -1], layout.blocks[6][1:, -1]])


def _arcs(flow: PassageFlow, feet: Complexes, front: Loop) -> Floats:
    """Return the arc lengths (k,) of places on the unit circle, on the loop whose points `flow` has."""
    angle = np.unwrap(np.angle(flow.circle))
    knots = np.append(front.curve.knots, front.length)
    turn = 2.0 * np.pi
    at = angle[0] + np.mod(np.angle(feet) - angle[0], turn)
    return np.asarray(np.mod(np.interp(at, np.append(angle, angle[0] + turn), knots), front.length))
