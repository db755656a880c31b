"""Quad meshes of simple domains, built from arrays of nodes whose common nodes are found by position."""

import numpy as np

from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh


def place_on(domain, point):
    """Return number of loop and arc length of the place on the polygons of a domain closest to a point."""
    best = (np.inf, 0, 0.0)
    for number, loop in enumerate(domain.loops):
        p = loop.curve.points
        step = np.roll(p, -1, axis=0) - p
        length = np.hypot(*step.T)
        t = np.clip(((point - p) * step).sum(axis=1) / length**2, 0.0, 1.0)
        off = np.hypot(*(p + t[:, None] * step - point).T)
        k = int(off.argmin())
        best = min(
            best, (float(off[k]), number, float(np.mod(loop.curve.knots[k] + t[k] * length[k], loop.length)))
        )
    return best


def mesh_of(domain, arrays):
    """Return the mesh of all cells of `arrays`, each (ni, nj, 2) and right-handed, in one domain."""
    points = np.concatenate([array.reshape(-1, 2) for array in arrays])
    _, first, number = np.unique(np.round(points, 9), axis=0, return_index=True, return_inverse=True)
    quads, start = [], 0
    for array in arrays:
        k = start + np.arange(array.shape[0] * array.shape[1]).reshape(array.shape[:2])
        quads.append(np.stack([k[:-1, :-1], k[1:, :-1], k[1:, 1:], k[:-1, 1:]], axis=-1).reshape(-1, 4))
        start += k.size
    nodes, quads = points[first].copy(), number.ravel()[np.concatenate(quads)]
    bare = QuadMesh(domain, nodes, quads, Places.inside(len(nodes)))
    places = bare.places
    for node in np.flatnonzero(bare.wall_nodes):
        _, loop, arc = place_on(domain, nodes[node])
        places.loop[node], places.arc[node] = loop, arc
        at = domain.loops[loop]
        near = np.abs((at.corner_arcs - arc + at.length / 2) % at.length - at.length / 2) < 1e-6
        if near.any():
            places.cells[node] = at.corner_cells[near][0]
            places.arc[node] = at.corner_arcs[near][0]
        nodes[node] = at.at(places.arc[node : node + 1])[0]
    return bare


def box(x0, x1, y0, y1, ni, nj):
    """Return a uniform lattice (ni + 1, nj + 1, 2)."""
    x, y = np.linspace(x0, x1, ni + 1), np.linspace(y0, y1, nj + 1)
    return np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)


def rectangle(ni=6, nj=4):
    """Return a mesh of ni x nj cells in [0, 3] x [0, 2]."""
    domain = Domain.of_polygons([np.array([[0.0, 0], [3, 0], [3, 2], [0, 2]])])
    return mesh_of(domain, [box(0, 3, 0, 2, ni, nj)])


def corner(n=3):
    """Return a mesh of an L of three squares, n x n cells each."""
    domain = Domain.of_polygons([np.array([[0.0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]])])
    return mesh_of(domain, [box(0, 1, 0, 1, n, n), box(1, 2, 0, 1, n, n), box(0, 1, 1, 2, n, n)])


def circle(radius, points=240, centre=(0.0, 0.0)):
    """Return the polygon (points, 2) of a circle, counter-clockwise."""
    t = np.arange(points) * 2 * np.pi / points
    return np.array(centre) + radius * np.stack([np.cos(t), np.sin(t)], axis=1)


def annulus(around=24, across=4):
    """Return a mesh of the ring between radii 1 and 2."""
    domain = Domain.of_polygons([circle(2.0), circle(1.0)])
    t = np.arange(around + 1) * -2 * np.pi / around
    r = np.linspace(1.0, 2.0, across + 1)
    return mesh_of(domain, [r[None, :, None] * np.stack([np.cos(t), np.sin(t)], axis=1)[:, None]])


def disc(n=4):
    """Return the butterfly of a unit disc: a square of 2n x 2n cells, and four blocks of n rows around it."""
    domain = Domain.of_polygons([circle(1.0)])
    core = box(-0.5, 0.5, -0.5, 0.5, 2 * n, 2 * n)
    edges = core[:, 0], core[-1], core[::-1, -1], core[0, ::-1]
    arrays = [core]
    for k, edge in enumerate(edges):
        t = np.radians(-135.0 + 90.0 * k + np.linspace(0.0, 90.0, 2 * n + 1))
        wall = np.stack([np.cos(t), np.sin(t)], axis=1)
        share = np.linspace(0.0, 1.0, n + 1)[:, None]
        arrays.append(wall[:, None] + share * (edge - wall)[:, None])
    return mesh_of(domain, arrays)


def lattice_in_a_circle(n=4):
    """Return n x n cells of a square pulled out to the unit circle, its corners on it too."""
    nodes = box(-1.0, 1.0, -1.0, 1.0, n, n)
    longest = np.abs(nodes).max(axis=-1, keepdims=True)
    around = np.hypot(nodes[..., :1], nodes[..., 1:])
    nodes = nodes * longest / np.maximum(around, 1e-12)
    return mesh_of(Domain.of_polygons([circle(1.0)]), [nodes])
