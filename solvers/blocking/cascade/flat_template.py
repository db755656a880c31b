"""Blocks of a cascade's passage in its own plane, where the passage is cut in the middle between blades.

They are those of `meshonet.solvers.blocking.cascade.passage_template`. In the plane of the passage's map,
inlet and outlet shrink exponentially with the length of the blade in pitches, and coordinates have no digits
left for blades that are much longer than their pitch, as those of impellers.

::

    inlet ----------------- cut ------------------ outlet
      |         .-----------------------.            |        nodes of the upper side of the cut
      |        (          blade          )           |        are those of the lower side, moved
      |         '-----------------------'            |        by the pitch
    inlet ----------------- cut ------------------ outlet
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats, complex_of, pairs_of
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.domain.periodic import Periodic
from meshonet.geometry.elementary import modulus, times
from meshonet.geometry.layout.lattice import lattice_quads
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking.cascade.passage import BLADE, INLET, OUTLET, Passage
from meshonet.solvers.blocking.cascade.passage_flow import PassageFlow
from meshonet.solvers.blocking.cascade.passage_map import PassageMap
from meshonet.solvers.blocking.cascade.passage_template import (
    FEET,
    blade_arcs,
    joined_pieces,
    put_at_corners,
    template_pieces,
)
from meshonet.solvers.blocking.sizes.size_metric import SizeMetric

LONGEST = 72
"""Most cells along the channel."""
_SAME = 1e-9  # of the potential


def upright(passage: Passage, sizes: SizeMetric) -> tuple[Passage, SizeMetric]:
    """Return a passage and the sizes in its plane, turned so that the pitch points along y."""
    back = np.conj(passage.map.axis)
    turned = PassageMap(1j * abs(passage.map.pitch), complex(times(passage.map.centre, back)))
    points = _turned(passage.front.curve.points, back)
    front = replace(passage.front, curve=Curve(points, closed=True, corners=passage.front.curve.corner_index))
    domain = replace(passage.domain, loops=(front, *passage.domain.loops[1:]))
    sizes = replace(sizes, points=_turned(sizes.points, back), normals=_turned(sizes.normals, back))
    return replace(passage, front=front, map=turned, domain=domain), sizes


def turned_back(layout: Layout, passage: Passage) -> tuple[Layout, Indices]:
    """Return a layout of `upright` in the passage's own plane, and the nodes of the lower side of its cut."""
    mesh = layout.mesh
    nodes, arcs = _turned(mesh.nodes, passage.map.axis), mesh.places.arc.copy()
    on, images = np.flatnonzero(mesh.places.loop == BLADE), np.flatnonzero(mesh.places.partner >= 0)
    arcs[on] = replace(passage, domain=mesh.domain).front_arcs(arcs[on])
    nodes[on] = passage.front.at(arcs[on])
    nodes[images] = nodes[mesh.places.partner[images]] + passage.pitch
    turned = replace(mesh, nodes=nodes, places=replace(mesh.places, arc=arcs))
    return replace(layout, mesh=turned), flat_cut(layout)


def _turned(points: Floats, way: complex) -> Floats:
    """Return points (n, 2) turned as a unit vector `way` is turned from the axis of abscissas."""
    return pairs_of(times(complex_of(points), way))


def flat_passage(passage: Passage, inlet: float, outlet: float) -> Passage:
    """Return a passage with the domain in its own plane.

    The loops of inlet and outlet are rectangles before and behind the passage, which have the blade in
    between; their first sides are inlet, downwards from the ordinate `inlet`, and outlet, upwards to
    `outlet`. The pitch points along y.
    """
    pitch = passage.map.pitch.imag
    x = passage.map.centre.real + np.array([passage.inlet, passage.outlet])
    far = np.array([x[0] - pitch, x[1] + pitch])
    ends = [
        _polygon([[x[0], inlet], [x[0], inlet - pitch], [far[0], inlet - pitch], [far[0], inlet]], "inlet"),
        _polygon(
            [[x[1], outlet - pitch], [x[1], outlet], [far[1], outlet], [far[1], outlet - pitch]], "outlet"
        ),
    ]
    around = _polygon([[far[0], 0.0], [far[1], 0.0], [far[1], pitch], [far[0], pitch]], "")
    periodic = Periodic((0.0, 0.0), (0.0, 0.0), (0.0, pitch))
    domain = Domain((passage.front, *ends, around), passage.domain.name, periodic=(periodic,))
    return replace(passage, domain=domain)


def _polygon(points: list[list[float]], name: str) -> Loop:
    return Loop.of_polygon(np.array(points), (0, 1, 2, 3), (name,))


def flat_template(passage: Passage, *, at_corners: bool) -> Layout:
    """Return the layout of a passage in its own plane; nodes may be moved to the blade's corners."""
    map_ = passage.map
    flow = PassageFlow.of(map_.zeta(passage.front.curve.points))
    pieces, angles = template_pieces(flow, passage, longest=LONGEST, cut=True)
    potential, blocks = joined_pieces(pieces, periodic=False)
    off_blade = modulus(potential) < 0.5 * FEET
    zeta = flow.to_places(np.where(off_blade, potential, 0.5j * np.pi))
    nodes = pairs_of(map_.centre + times(zeta, map_.pitch) / (1j * np.pi))
    columns = [
        np.unique(np.concatenate([block[k] for block in own]))
        for k, own in ((0, blocks[:3]), (-1, blocks[5:8]))
    ]
    pitch = map_.pitch.imag
    tops = []
    for own in columns:  # far from blades streamlines are straight
        share = potential[own].imag / np.pi
        tops.append(float((nodes[own, 1] - pitch * share).mean()) + 0.5 * pitch)
        nodes[own, 1] = tops[-1] + pitch * (share - 0.5)
    flat = flat_passage(passage, *tops)
    places = Places.inside(len(nodes))
    feet, angle = np.concatenate([block[:, 0] for block in blocks[-4:]]), np.concatenate(angles)
    places.loop[feet], places.arc[feet] = BLADE, blade_arcs(flow, angle, passage.front)
    for number, own, top in zip((INLET, OUTLET), columns, tops, strict=True):
        places.loop[own] = number
        below = np.clip(top - nodes[own, 1], 0.0, pitch)
        places.arc[own] = below if number == INLET else pitch - below
    for number in (BLADE, INLET, OUTLET):
        own = np.flatnonzero(places.loop == number)
        nodes[own] = flat.domain.loops[number].at(places.arc[own])
    _tie(places, potential)
    images = np.flatnonzero(places.partner >= 0)
    nodes[images] = nodes[places.partner[images]] + flat.pitch
    layout = Layout(QuadMesh(flat.domain, nodes, lattice_quads(blocks), places), blocks)
    if at_corners:
        put_at_corners(layout, passage.front)
    return layout


def _tie(places: Places, potential: Complexes) -> None:
    """Make the nodes of the lower side of the cut the partners of those of the upper side, in place."""
    sides = []
    for end in (0.5 * np.pi, -0.5 * np.pi):
        own = np.flatnonzero((np.abs(potential.imag - end) < _SAME) & (places.loop != BLADE))
        sides.append(own[np.argsort(potential[own].real, kind="stable")])
    places.partner[sides[0]] = sides[1]


def flat_cut(layout: Layout) -> Indices:
    """Return the nodes (k,) of the lower side of the cut of a layout with the template's blocks."""
    return np.concatenate([layout.blocks[2][:, 0], layout.blocks[4][1:, 0], layout.blocks[7][1:, 0]])
