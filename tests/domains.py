"""Domains and layouts made by hand, for tests of what comes before and behind decomposition."""

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.layout.lattice import lattice_quads
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh

STEP = np.array([[0.0, 1.0], [2.0, 1.0], [2.0, 0.0], [6.0, 0.0], [6.0, 2.0], [0.0, 2.0]])
STEP_NAMES = ("floor", "step", "bottom", "outlet", "roof", "inlet")


def circle(x: float, y: float, radius: float, n: int = 60) -> Floats:
    """Points around a circle, counter-clockwise."""
    angle = np.linspace(0, 2 * np.pi, n, endpoint=False)
    return np.stack([x + radius * np.cos(angle), y + radius * np.sin(angle)], axis=1)


def step_domain(points: Floats = STEP, name: str = "step") -> Domain:
    """A backward-facing step, every side named."""
    return Domain((Loop.of_polygon(points, tuple(range(6)), STEP_NAMES),), name)


def step_layout() -> Layout:
    """Three blocks of a step: before it above, behind it above and below."""
    lines = {
        0: (np.linspace(0, 2, 5), np.linspace(1, 2, 4)),
        1: (np.linspace(2, 6, 9), np.linspace(1, 2, 4)),
        2: (np.linspace(2, 6, 9), np.linspace(0, 1, 5)),
    }
    lattices = [np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1) for x, y in lines.values()]
    return layout_of(step_domain(), lattices)


def ring_layout(inner: float = 1.0, outer: float = 3.0, cuts: int = 1) -> Layout:
    """An annulus of as many blocks as it is cut, smooth loops without corners."""
    domain = Domain.of_polygons([circle(0, 0, outer, 400), circle(0, 0, inner, 400)], "ring")
    around = np.linspace(0, 2 * np.pi, 24 * cuts + 1)
    radii = np.linspace(outer, inner, 6)  # i runs counter-clockwise from the outer loop inwards: right-handed
    lattice = radii[None, :, None] * np.stack([np.cos(around), np.sin(around)], axis=1)[:, None]
    lattice[-1] = lattice[0]
    return layout_of(domain, [lattice[24 * k : 24 * (k + 1) + 1] for k in range(cuts)])


def layout_of(domain: Domain, lattices: list[Floats]) -> Layout:
    """The layout of blocks of nodes (ni, nj, 2), equal ones shared; nodes near loops are put on them."""
    every = np.concatenate([lattice.reshape(-1, 2) for lattice in lattices])
    _, first, number = np.unique(np.round(every, 7), axis=0, return_index=True, return_inverse=True)
    nodes = every[first].copy()
    ends = np.cumsum([0, *(lattice.shape[0] * lattice.shape[1] for lattice in lattices)])
    blocks = tuple(
        number.ravel()[a:b].reshape(lattice.shape[:2])
        for a, b, lattice in zip(ends, ends[1:], lattices, strict=False)
    )
    places = Places.inside(len(nodes))
    for k, loop in enumerate(domain.loops):
        arcs = np.concatenate([np.linspace(0, loop.length, 20001)[:-1], loop.corner_arcs])
        points = loop.at(arcs)
        for node in range(len(nodes)):
            gap = np.hypot(*(points - nodes[node]).T)
            best = len(gap) - 1 - int(np.argmin(gap[::-1]))  # corners last, and before others
            if gap[best] < 2e-3:
                places.loop[node], places.arc[node] = k, arcs[best]
                nodes[node] = points[best]
                corner = best - 20000
                places.cells[node] = loop.corner_cells[corner] if corner >= 0 else 0
    return Layout(QuadMesh(domain, nodes, lattice_quads(blocks), places), blocks)
