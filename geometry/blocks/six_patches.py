"""The six faces of a volume: those of a block, or six patches in any order, matched by position."""

import math
from collections.abc import Iterator
from itertools import product

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats, Indices, Side, norms
from meshonet.geometry.blocks.block import PLACES
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.handedness import flux_through
from meshonet.geometry.blocks.six_faces import FACES, SixFaces, edge_of, edges, share_edges
from meshonet.geometry.errors import InputError, place_of
from meshonet.geometry.notes import Change

TOLERANCE = 1e-6  # largest distance between nodes of a shared edge, over the diagonal of the bounding box
_NEAR = 0.2  # largest distance between matching corners, over the shortest side of a patch


def six_faces(grid: Grid) -> SixFaces:
    """Return the boundary of a volume, from the faces of one block or from six patches in any order.

    The nodes of a shared edge may differ by 1e-6 of the diagonal of the bounding box. Then one patch gets the
    nodes of the other patch, and a note says so.

    Raises InputError: neither one block nor six patches; patches that do not close (the message gives the
    edge and the width of the gap).
    """
    volumes = [block for block in grid.blocks if len(block.counts) == 3]
    if len(grid.blocks) == 1 and volumes:
        return SixFaces.of_block(volumes[0].nodes, name=grid.name, patches=grid.patches)
    if volumes or len(grid.blocks) != 6:
        what = f"{len(grid.blocks)} {'blocks' if volumes else 'surface patches'}"
        raise InputError(
            f"{what} where the six faces of a volume are needed", "give six patches, or one block"
        )
    return matched_patches(grid)


def matched_patches(grid: Grid) -> SixFaces:
    """Return the faces of the volume that the six patches of `grid`, each (n, m, 3), enclose.

    Patches in the order west, east, south, north, bottom, top keep their sides and directions; otherwise the
    first patch becomes the bottom. The volume is right-handed.

    Raises InputError, with the patches and the place: corners at which more or fewer than three patches meet;
    shared edges with different node counts, or with nodes that differ by more than 1e-6 of the diagonal of
    the bounding box.
    """
    patches = [block.nodes for block in grid.blocks]
    vertices = _vertices(patches)
    # patches 0, 2 and 4 each share no vertex with their opposite patch only
    apart = [[j for j in range(6) if not np.isin(vertices[j], vertices[k]).any()] for k in (0, 2, 4)]
    first = 4 if apart == [[1], [3], [5]] else 0
    faces, order = _arranged(patches, vertices, first, turned=False)
    if _volume(faces) < 0:
        faces, order = _arranged(patches, vertices, first, turned=True)
    notes = _closed(faces, order)
    west, east, south, north, bottom, top = (faces[side] for side in FACES)
    return SixFaces(west, east, south, north, bottom, top, grid.name, (), notes)


def _vertices(patches: list[Floats]) -> Indices:
    """Return the vertex number, 0 to 7, of each corner (6, 2, 2) of the patches."""
    corners = np.array([patch[:: len(patch) - 1, :: patch.shape[1] - 1] for patch in patches])
    first, second = np.triu_indices(4, 1)
    fours = corners.reshape(6, 4, 3)
    shortest = float(norms(fours[:, first] - fours[:, second]).min())
    points = corners.reshape(24, 3)
    apart = norms(points[:, None] - points[None])
    label = (apart <= _NEAR * shortest).argmax(axis=1)
    meeting = np.bincount(label, minlength=24)
    wrong = np.flatnonzero(meeting[label] != 3)
    if len(wrong):
        at = int(wrong[0])
        problem = f"{meeting[label[at]]} patches meet in this corner of patch {at // 4} where three have to"
        remedy = "give the six faces of one volume, with all their corners"
        raise InputError(problem, remedy, place=place_of(points[at]))
    return np.searchsorted(np.flatnonzero(meeting), label).reshape(6, 2, 2)


def _arranged(
    patches: list[Floats], vertices: Indices, first: int, *, turned: bool
) -> tuple[dict[Side, Floats], dict[Side, int]]:
    """Return the faces with patch `first` as the bottom, and the index of the patch of each face.

    The directions of the bottom are i and j, or `turned` j and i.
    """
    bottom = vertices[first].T if turned else vertices[first]
    lattice = np.empty((2, 2, 2), dtype=np.intp)
    lattice[:, :, 0] = bottom
    for a, b in product(range(2), range(2)):
        lattice[a, b, 1] = _above(vertices, first, int(bottom[a, b]))
    faces: dict[Side, Floats] = {}
    order: dict[Side, int] = {}
    for side, (axis, end) in PLACES.items():
        wanted = np.take(lattice, end, axis=axis)
        fits = [
            (number, nodes)
            for number in range(6)
            for nodes, corners in _turns(patches[number], vertices[number])
            if np.array_equal(corners, wanted)
        ]
        if len(fits) != 1:
            raise InputError(f"{len(fits)} of the patches fit as {side}", "give the six faces of one volume")
        order[side], faces[side] = fits[0]
    return faces, order


def _above(vertices: Indices, first: int, vertex: int) -> int:
    """Return the vertex outside patch `first` that an edge joins to the given one of its vertices."""
    joined = set()
    for corners in np.delete(vertices, first, axis=0):
        for a, b in np.argwhere(corners == vertex):
            joined |= {int(corners[1 - a, b]), int(corners[a, 1 - b])}
    above = joined - set(vertices[first].ravel().tolist())
    if len(above) != 1:
        raise InputError("the six patches are not the faces of a volume", "check which edges they share")
    return above.pop()


def _turns(nodes: Floats, corners: Indices) -> Iterator[tuple[Floats, NDArray[np.intp]]]:
    """Yield a patch and its corners in all eight orientations."""
    for swapped, a, b in product((False, True), (1, -1), (1, -1)):
        patch, four = (nodes.swapaxes(0, 1), corners.T) if swapped else (nodes, corners)
        yield patch[::a, ::b], four[::a, ::b]


def _volume(faces: dict[Side, Floats]) -> float:
    """Return the enclosed volume; it is negative if the directions are left-handed."""
    total, centre = 0.0, np.mean([face.mean(axis=(0, 1)) for face in faces.values()], axis=0)
    for side, (axis, end) in PLACES.items():
        x = np.moveaxis(faces[side] - centre, -1, 0)
        outwards = (-1.0 if end == 0 else 1.0) * (-1.0 if axis == 1 else 1.0)
        total += outwards * flux_through(x)
    return total


def _closed(faces: dict[Side, Floats], order: dict[Side, int]) -> tuple[str, ...]:
    """Make shared edges bitwise equal, in place; return a note if that moved nodes."""
    size = math.hypot(*np.ptp(np.concatenate([face.reshape(-1, 3) for face in faces.values()]), axis=0))
    widest, where = 0.0, ""
    for side, second in edges():
        own, donor = (edge_of(faces[a], a, b) for a, b in ((side, second), (second, side)))
        pair = f"patches {order[side]} and {order[second]} ({side} and {second})"
        if len(own) != len(donor):
            problem = f"{pair} have {len(own)} and {len(donor)} nodes along their common edge"
            raise InputError(problem, "give both as many", place=place_of(own[0]))
        gaps = norms(own - donor)
        at = int(gaps.argmax())
        if gaps[at] > TOLERANCE * size:
            problem = f"{pair} are {gaps[at]:.3g} apart along their common edge, at node {at}"
            raise InputError(problem, "close the gap", place=place_of(own[at]))
        if gaps[at] > widest:
            widest, where = float(gaps[at]), pair
    share_edges(faces)
    note = Change(f"nodes of shared edges were up to {widest:.3g} apart ({where}) and are now equal")
    return (note,) if widest else ()
