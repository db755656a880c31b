"""Quad meshes that are their own mirror images: which node each one becomes, and nodes made so exactly."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence

import numpy as np

from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking.decomposition.symmetry.mirrors import Mirror

STARTS = 24
"""Edges of a wall tried as the image of one, the nearest of them: a disc's quads fit in several ways."""
CLOSE = 1e-3
"""Distance by the extent, less than a cell, to which nodes and images are known to belong together."""


Images = list[tuple[Mirror, Indices]]
"""Mirrors, and the node (n,) that each node of a mesh becomes in them."""


def images_of(mesh: QuadMesh, mirrors: Sequence[Mirror]) -> Images:
    """Return the images of nodes in those mirrors of its domain to which a mesh has symmetric quads."""
    images = ((mirror, _image(mesh, mirror)) for mirror in mirrors)
    return [(mirror, to) for mirror, to in images if to is not None]


def made_symmetric(mesh: QuadMesh, images: Images) -> QuadMesh:
    """Return the mesh with all nodes and their images at the means of both; corners stay."""
    for mirror, to in images:
        places, nodes = mesh.places, 0.5 * (mesh.nodes + mirror.images(mesh.nodes[to]))
        arc, fixed = places.arc.copy(), places.cells > 0
        for number, loop in enumerate(mesh.domain.loops):
            on = np.flatnonzero((places.loop == number) & ~fixed)
            step = mirror.sums[mirror.loops[number]] - places.arc[to[on]] - arc[on]
            arc[on] = np.mod(arc[on] + 0.5 * (step - loop.length * np.round(step / loop.length)), loop.length)
            nodes[on] = loop.at(arc[on])
        nodes[fixed] = mesh.nodes[fixed]
        mesh = mesh.with_nodes(nodes, arc)
    return mesh


def _image(mesh: QuadMesh, mirror: Mirror) -> Indices | None:
    """Return the node (n,) that each node becomes; of several ways that which moves nodes least."""
    least, image = np.inf, None
    for seed in _seeds(mesh, mirror):
        to = _spread(mesh, *seed)
        if to is not None and _suits(mesh, mirror, to):
            off = float(np.abs(mirror.images(mesh.nodes) - mesh.nodes[to]).max())
            if off < 0.5 * least:
                least, image = off, to
            if off < CLOSE * mesh.domain.extent:
                break
    return image


def _seeds(mesh: QuadMesh, mirror: Mirror) -> Iterator[tuple[int, int, int, int]]:
    """Yield a quad and its edge on the outer wall, and those that may be their images, nearest first."""
    places, wall = mesh.places, mesh.twin.ravel() < 0
    first, second = mesh.quads.ravel(), np.roll(mesh.quads, -1, axis=1).ravel()
    sides = np.flatnonzero(wall & (places.loop[first] == 0) & (places.loop[second] == 0))
    corner = places.cells[first[sides]] > 0
    start = sides[np.argmax(corner)]
    length = mesh.domain.loops[0].length
    # the image of an edge begins where the edge ends
    apart = mirror.sums[0] - places.arc[first[start]] - places.arc[second[sides]]
    apart = np.abs(apart - length * np.round(apart / length))
    for k in np.argsort(apart, kind="stable")[:STARTS].tolist():
        yield *divmod(int(start), 4), *divmod(int(sides[k]), 4)


def _spread(mesh: QuadMesh, quad: int, edge: int, image: int, beyond: int) -> Indices | None:
    """Return the images of all nodes when edge `edge` of a quad becomes edge `beyond` of `image`."""
    quads, twin, valence = mesh.quads.tolist(), mesh.twin.tolist(), mesh.valence.tolist()
    to = [-1] * len(mesh.nodes)
    # node i of a quad is node (turn - i) of its image: mirrors turn quads over
    pairs = {quad: (image, edge + beyond + 1)}
    queue = deque([quad])
    while queue:
        at = queue.popleft()
        other, turn = pairs[at]
        for i in range(4):
            a, b = quads[at][i], quads[other][(turn - i) % 4]
            if to[a] not in (-1, b) or valence[a] != valence[b]:
                return None
            to[a] = b
            here, there = twin[at][i], twin[other][(turn - i - 1) % 4]
            if (here < 0) != (there < 0):
                return None
            if here >= 0:
                (q, j), (r, k) = divmod(here, 4), divmod(there, 4)
                if q not in pairs:
                    pairs[q] = r, j + k + 1
                    queue.append(q)
                elif pairs[q][0] != r or (pairs[q][1] - j - k - 1) % 4:
                    return None
    return np.array(to, dtype=np.intp)


def _suits(mesh: QuadMesh, mirror: Mirror, to: Indices) -> bool:
    """Return whether images of nodes lie on the images of their loops, corners on corners."""
    places, on = mesh.places, mesh.places.loop >= 0
    loops = np.where(on, mirror.loops[places.loop], -1)
    return bool((places.loop[to] == loops).all() and (places.cells[to] == places.cells).all())
