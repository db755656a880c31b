"""Quad meshes that are their own mirror images: which node each one becomes, and nodes made so exactly."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.geometry.polygon.corners import Indices
from meshonet.kernels._native import nearest_points
from meshonet.solvers.blocking.decomposition.symmetry.mirrors import Mirror

Images = list[tuple[Mirror, Indices]]
"""Mirrors, and the node (n,) that each node of a mesh becomes in them."""


def images_of(mesh: QuadMesh, mirrors: Sequence[Mirror]) -> Images:
    """Return the images of nodes in those mirrors of its domain to which a mesh is nearly symmetric."""
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
    """Return the node (n,) nearest to the image of each; None unless quads, walls and corners become such."""
    places, quads = mesh.places, mesh.quads
    to = nearest_points(mirror.images(mesh.nodes), np.ascontiguousarray(mesh.nodes))[0]
    if (np.bincount(to, minlength=len(to)) != 1).any():
        return None
    own, images = (each[np.lexsort(each.T)] for each in (np.sort(quads, axis=1), np.sort(to[quads], axis=1)))
    loops = np.where(places.loop >= 0, mirror.loops[places.loop], -1)
    suits = np.array_equal(places.loop[to], loops) and np.array_equal(places.cells[to], places.cells)
    return to if suits and np.array_equal(own, images) else None
