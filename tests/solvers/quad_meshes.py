"""Quad meshes of simple domains, made here."""

from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Floats, Indices
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.domain.periodic import Periodic
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh


def lattice_quads(lattice: Indices) -> Indices:
    """Return the quads of a lattice of node numbers."""
    corners = lattice[:-1, :-1], lattice[1:, :-1], lattice[1:, 1:], lattice[:-1, 1:]
    return np.stack(corners, axis=-1).reshape(-1, 4)


def placed(domain: Domain, nodes: Floats, quads: Indices, walls: dict[int, tuple[int, float]]) -> QuadMesh:
    """Return a mesh whose nodes `walls` are at (loop, arc length), corners where the loop has them."""
    places = Places.inside(len(nodes))
    nodes = nodes.copy()
    for node, (number, arc) in walls.items():
        loop = domain.loops[number]
        places.loop[node], places.arc[node] = number, arc % loop.length
        apart = np.abs(loop.corner_arcs - places.arc[node])
        apart = np.minimum(apart, loop.length - apart)
        if apart.size and apart.min() < 1e-9 * loop.length:
            places.cells[node] = loop.corner_cells[apart.argmin()]
        nodes[node] = loop.at(np.array([arc]))[0]
    return QuadMesh(domain, nodes, np.ascontiguousarray(quads), places)


def rectangle(x: Floats, y: Floats) -> QuadMesh:
    """Return the product of two sets of coordinates; node (i, j) has the number i len(y) + j."""
    a, b = np.ptp(x), np.ptp(y)
    corners = np.array([[x[0], y[0]], [x[-1], y[0]], [x[-1], y[-1]], [x[0], y[-1]]])
    domain = Domain((Loop.of_polygon(corners),))
    nodes = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    lattice = np.arange(len(nodes)).reshape(len(x), len(y))
    walls = {}
    for i, node in enumerate(lattice[:, 0]):
        walls[int(node)] = (0, x[i] - x[0])
    for j, node in enumerate(lattice[-1]):
        walls[int(node)] = (0, a + y[j] - y[0])
    for i, node in enumerate(lattice[:, -1]):
        walls[int(node)] = (0, a + b + x[-1] - x[i])
    for j, node in enumerate(lattice[0, 1:-1], 1):
        walls[int(node)] = (0, 2 * a + b + y[-1] - y[j])
    return placed(domain, nodes, lattice_quads(lattice), walls)


def butterfly(points: Floats, core: int = 6, rings: int = 4, rounds: float = 0.5) -> QuadMesh:
    """Return a square of cells in the middle of a smooth curve (n, 2), and rings of cells around it."""
    domain = Domain((Loop(Curve(points, closed=True, corners=())),))
    middle, loop = points.mean(axis=0), domain.loops[0]
    arc = np.arange(4 * core) * loop.length / (4 * core)
    rim = loop.at(arc)
    inner = middle + rounds * (rim - middle)
    lattice = np.full((core + 1, core + 1), -1)
    around = [(i, 0) for i in range(core)] + [(core, j) for j in range(core)]
    around += [(core - i, core) for i in range(core)] + [(0, core - j) for j in range(core)]
    for k, place in enumerate(around):
        lattice[place] = k
    lattice[lattice < 0] = np.arange(4 * core, (core + 1) ** 2)
    nodes = np.zeros(((core + 1) ** 2, 2))
    nodes[: 4 * core] = inner
    s = np.linspace(0.0, 1.0, core + 1)[1:-1]
    edges = [nodes[lattice[side]] for side in (np.s_[:, 0], np.s_[:, -1], np.s_[0], np.s_[-1])]
    for i in range(1, core):
        for j in range(1, core):
            t, u = s[i - 1], s[j - 1]
            one = (1 - u) * edges[0][i] + u * edges[1][i]
            other = (1 - t) * edges[2][j] + t * edges[3][j]
            nodes[lattice[i, j]] = 0.5 * (one + other)
    quads, below = [lattice_quads(lattice)], np.arange(4 * core)
    for ring in range(1, rings + 1):
        share, above = ring / rings, len(nodes) + np.arange(4 * core)
        nodes = np.concatenate([nodes, inner + share * (rim - inner)])
        after = np.roll(above, -1), np.roll(below, -1)
        quads.append(np.stack([above, after[0], after[1], below], axis=1))
        below = above
    return placed(
        domain, nodes, np.concatenate(quads), {int(k): (0, a) for k, a in zip(below, arc, strict=True)}
    )


def kidney(count: int = 160) -> Floats:
    """Return points (count, 2) of a bent blob with two narrow ends."""
    t = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    x, y = 2.0 * np.cos(t), 0.45 * np.sin(t)
    return np.stack([x, y + 0.35 * x**2], axis=1)


def passage(n: int = 12, m: int = 8) -> QuadMesh:
    """Return a periodic passage: the upper side is the lower one moved by (0.2, 1)."""
    x = np.linspace(0.0, 2.0, n + 1)
    low = np.stack([x, 0.2 * np.sin(np.pi * x)], axis=1)
    shift = np.array([0.2, 1.0])
    outline = np.concatenate([low, (low + shift)[::-1]])
    corners = (0, n, n + 1, 2 * n + 1)
    loop = Loop.of_polygon(outline, corners=corners)
    arcs = [float(a) for a in loop.corner_arcs]
    periodic = Periodic((arcs[0], arcs[1]), (arcs[2], arcs[3]), (float(shift[0]), float(shift[1])))
    domain = Domain((loop,), periodic=(periodic,))
    t = np.linspace(0.0, 1.0, m + 1)
    nodes = (low[:, None] + t[:, None] * shift).reshape(-1, 2)
    lattice = np.arange(len(nodes)).reshape(n + 1, m + 1)
    walls = {int(k): (0, float(loop.curve.knots[i])) for i, k in enumerate(lattice[:, 0])}
    walls |= {int(k): (0, float(loop.curve.knots[2 * n + 1 - i])) for i, k in enumerate(lattice[:, -1])}
    side = float(np.hypot(*shift))
    walls |= {int(k): (0, arcs[1] + side * t[j]) for j, k in enumerate(lattice[-1]) if 0 < j < m}
    walls |= {int(k): (0, arcs[3] + side * (1 - t[j])) for j, k in enumerate(lattice[0]) if 0 < j < m}
    mesh = placed(domain, nodes, lattice_quads(lattice), walls)
    partner = mesh.places.partner.copy()
    partner[lattice[:, -1]] = lattice[:, 0]
    return replace(mesh, places=replace(mesh.places, partner=partner))


def sagitta(mesh: QuadMesh) -> float:
    """Return the largest distance of a curve from an edge between two of its nodes, in roots of cells."""
    cell, side = np.nonzero(mesh.on_wall[mesh.edge_of])
    worst = 0.0
    for q, k in zip(cell, side, strict=True):
        a, b = mesh.quads[q, k], mesh.quads[q, (k + 1) % 4]
        loop = mesh.domain.loops[mesh.places.loop[a]]
        along = (mesh.places.arc[b] - mesh.places.arc[a]) % loop.length
        points = loop.at(mesh.places.arc[a] + along * np.linspace(0.0, 1.0, 33))
        chord = points[-1] - points[0]
        away = (points - points[0]) @ np.array([-chord[1], chord[0]]) / np.hypot(*chord)
        z = mesh.nodes[mesh.quads[q]] @ np.array([1.0, 1j])
        area = 0.5 * abs((np.conj(z[2] - z[0]) * (z[3] - z[1])).imag)
        worst = max(worst, float(np.abs(away).max() / np.sqrt(area)))
    return worst


def ring(radii: Floats, count: int) -> QuadMesh:
    """Return cells around a circle, out to another one; node (i, j), at radius i, is number i count + j."""
    angle = np.arange(count) * 2.0 * np.pi / count
    unit = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    fine = np.arange(8 * count) * 2.0 * np.pi / (8 * count)
    circle = np.stack([np.cos(fine), np.sin(fine)], axis=1)
    outer, inner = Curve(radii[-1] * circle, closed=True, corners=()), circle[::-1] * radii[0]
    domain = Domain((Loop(outer), Loop(Curve(inner, closed=True, corners=()), names=("body",))))
    nodes = (radii[:, None, None] * unit).reshape(-1, 2)
    lattice = np.arange(len(nodes)).reshape(len(radii), count)
    quads = lattice_quads(np.concatenate([lattice, lattice[:, :1]], axis=1))
    first, last = domain.loops[1].curve.knots, domain.loops[0].curve.knots
    walls = {int(k): (0, float(last[8 * j])) for j, k in enumerate(lattice[-1])}
    walls |= {int(k): (1, float(first[8 * count - 1 - 8 * j])) for j, k in enumerate(lattice[0])}
    return placed(domain, nodes, quads, walls)
