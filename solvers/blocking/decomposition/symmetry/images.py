"""Mirror images of the nodes of a symmetric quad mesh; averages that make the nodes exactly symmetric."""

from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import Indices, norms
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.kernels._native import nearest_points, quad_images
from meshonet.solvers.blocking.decomposition.symmetry.mirrors import Mirror, mirrors_of

Images = Sequence[tuple[Mirror, Indices]]
"""For each mirror: the mirror, and for each node of a mesh (n,) the index of its mirror image."""
SOME = 100  # number of quads whose images are searched for; the images of the others follow from these


def images_of(mesh: QuadMesh, mirrors: Sequence[Mirror] | None = None) -> Images:
    """Return the mirrors about which the quads of a mesh are symmetric, and each node's image (n,) in them.

    Only `mirrors` are tried, by default all mirrors of the domain.
    """
    mirrors = mirrors_of(mesh.domain) if mirrors is None else mirrors
    images = []
    for mirror in mirrors:
        known = mesh.of_quads.get(mirror)
        to = known if isinstance(known, np.ndarray) else _image(mesh, mirror)
        if to is not None:
            mesh.of_quads[mirror] = to
            images.append((mirror, to))
    return images


def node_images(mesh: QuadMesh, mirrors: Sequence[Mirror] | None = None) -> list[Indices]:
    """Return, for each mirror of the mesh, the indices (n,) of the nodes' mirror images."""
    return [to for _, to in images_of(mesh, mirrors)]


def agree(images: Images) -> bool:
    """Return whether images of nodes in several mirrors, found for one mirror at a time, are consistent."""
    if len(images) < 2:
        return True
    (_, one), (_, other) = images[:2]
    turn = now = other[one]  # mirrors by their angles: each turns by as much more
    for _, to in images[1:]:
        if not np.array_equal(to[one], now):
            return False
        now = turn[now]
    return np.array_equal(now, np.arange(len(now)))


def made_symmetric(mesh: QuadMesh, images: Images | None = None) -> QuadMesh:
    """Return the mesh with each node at the mean of itself and its mirror images.

    `images` has the images of the nodes in each mirror, by default in all mirrors of the mesh. Only the first
    mirror is used if images in different mirrors contradict each other. Corners do not move.
    """
    images = images_of(mesh) if images is None else images
    if not agree(images):
        images = images[:1]
    for some in filter(None, (images[:1], images[1:])):
        mesh = _mean(mesh, some)
    return mesh


def _mean(mesh: QuadMesh, images: Images) -> QuadMesh:
    """Return the mesh with each node at the mean of itself and its `images`."""
    places, part = mesh.places, 1.0 / (len(images) + 1)
    on = np.flatnonzero((places.loop >= 0) & (places.cells == 0))
    loop, length = places.loop[on], mesh.domain.lengths[places.loop[on]]
    nodes, arc, moves = mesh.nodes.copy(), places.arc.copy(), np.zeros(len(on))
    for mirror, to in images:
        nodes += mirror.images(mesh.nodes[to])
        step = mirror.sums[mirror.loops[loop]] - arc[to[on]] - arc[on]
        moves += step - length * np.round(step / length)
    nodes *= part
    arc[on] = np.mod(arc[on] + part * moves, length)
    nodes[on] = mesh.domain.at(loop, arc[on])
    fixed = places.cells > 0
    nodes[fixed] = mesh.nodes[fixed]
    return mesh.with_nodes(nodes, arc)


def _image(mesh: QuadMesh, mirror: Mirror) -> Indices | None:
    """Return the image (n,) of each node, from that of one quad; None unless quads and walls have images."""
    x, y = (mesh.nodes[mesh.quads, axis].mean(axis=1) for axis in (0, 1))
    middles, some = np.stack([x, y], axis=1), slice(None, None, 1 + len(mesh.quads) // SOME)
    near, squares = nearest_points(mirror.images(middles[some]), middles)
    corners = mesh.nodes[mesh.quads[some]]
    one, other = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
    size = np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])
    best = int(np.argmin(squares / np.maximum(size, 1e-300)))
    quad, image = best * (1 + len(mesh.quads) // SOME), int(near[best])
    off = norms(mirror.images(mesh.nodes[mesh.quads[quad, 0]]) - mesh.nodes[mesh.quads[image]])
    to = _continued(mesh, quad, image, int(off.argmin()))
    if to is None:
        return None
    places = mesh.places
    loops = np.where(places.loop >= 0, mirror.loops[places.loop], -1)
    suits = np.array_equal(places.loop[to], loops) and np.array_equal(places.cells[to], places.cells)
    off = norms(mirror.images(mesh.nodes) - mesh.nodes[to]).mean()
    return to if suits and off < mesh.edge_lengths.mean() else None


def _continued(mesh: QuadMesh, quad: int, image: int, corner: int) -> Indices | None:
    """Return the image (n,) of each node if the first corner of a quad has the image `corner`, else None."""
    images_and_corners = quad_images(mesh.twin, quad, image, corner)
    if images_and_corners is None:
        return None
    images, first = images_and_corners
    to = np.zeros(len(mesh.nodes), dtype=np.intp)
    turned = mesh.quads[images[:, None], (first[:, None] - np.arange(4)) % 4]  # images run clockwise
    to[mesh.quads] = turned
    fits = np.array_equal(to[mesh.quads], turned) and (images >= 0).all()
    return to if fits and np.array_equal(to[to], np.arange(len(to))) else None
