"""The boundary of a grid as named faces, each with its cell; periodic faces in pairs, row by row.

A row is an edge a b or quadrilateral a b c d; its partner, moved, is b' a' or a' d' c' b'.
"""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from meshonet.formats.mesh.cell_faces import cell_numbers, faces_of
from meshonet.formats.mesh.names import unused
from meshonet.geometry.arrays import Indices
from meshonet.geometry.blocks.block import Range, face_of
from meshonet.geometry.blocks.connection import Connection, cells_at
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.blocks.outer_patches import owners_of

_SAME = 1e-9  # largest difference of motions that count as equal; for translations relative to their length
_OPPOSITE = {2: [1, 0], 4: [0, 3, 2, 1]}  # order of the nodes in the partner's row, by number of nodes


class NamedFaces(NamedTuple):
    """Node numbers (k, 2 or 4) of faces, and for each the number (k,) of its cell."""

    faces: Indices
    cells: Indices


class PeriodicPair(NamedTuple):
    """Two periodic boundaries, each with its name and faces; `motion` maps the first onto its partner."""

    name: str
    partner: str
    motion: Motion
    own: NamedFaces
    opposite: NamedFaces

    @property
    def faces(self) -> Indices:
        """Node numbers (k, 2 or 4) of the faces of the first boundary."""
        return self.own.faces

    @property
    def nodes(self) -> Indices:
        """Distinct pairs (n, 2) of a node of the first boundary and the corresponding node of the partner."""
        opposite = self.opposite.faces[:, _OPPOSITE[self.faces.shape[1]]]
        rows = np.stack([self.faces.ravel(), opposite.ravel()], axis=1)
        return np.asarray(np.unique(rows, axis=0))


def outer_parts(
    grid: Grid, numbers: Sequence[Indices]
) -> tuple[dict[str, NamedFaces], tuple[PeriodicPair, ...]]:
    """Return the boundary faces by name, with periodic ones last, and the pairs of periodic boundaries.

    `numbers` has the node numbers of each block. Unnamed faces get the name of their side.
    """
    cells = cell_numbers([block.counts for block in grid.blocks])
    pieces: dict[str, list[NamedFaces]] = {}
    for patch in grid.outer_patches():
        side = face_of(numbers[patch.block], patch.side)
        ranges = patch.range(side.shape)
        nodes = side[tuple(slice(start, stop + 1) for start, stop in ranges)]
        behind = face_of(cells[patch.block], patch.side)[tuple(slice(*span) for span in ranges)]
        part = NamedFaces(faces_of(nodes, patch.side), behind.ravel(order="F"))
        pieces.setdefault(patch.name, []).append(part)
    parts = {
        name: NamedFaces(*map(np.concatenate, zip(*several, strict=True))) for name, several in pieces.items()
    }
    pairs = tuple(periodic_pairs(grid, numbers, cells, parts))
    for pair in pairs:
        parts |= {pair.name: pair.own, pair.partner: pair.opposite}
    return parts, pairs


def periodic_pairs(
    grid: Grid, numbers: Sequence[Indices], cells: Sequence[Indices], taken: Iterable[str]
) -> list[PeriodicPair]:
    """Return the pairs of periodic boundaries of a grid, with a name for each boundary.

    `numbers` and `cells` have node and cell numbers of each block. A boundary without a patch name is called
    periodic1, periodic2 and so on. Names in `taken` are not used.
    """
    motions: list[Motion] = []
    by_motion: dict[tuple[int, str, str], list[tuple[NamedFaces, NamedFaces]]] = {}
    for connection in grid.connections:
        if connection.transform is None:
            continue
        number, backwards = _known(connection.transform, motions)
        ends = _parts(connection.reversed() if backwards else connection, numbers, cells)
        names = patch_on(grid, connection), patch_on(grid, connection.reversed())
        by_motion.setdefault((number, *(names[::-1] if backwards else names)), []).append(ends)
    pairs, used = [], set(taken)
    for count, ((number, *both), ends_of) in enumerate(by_motion.items()):
        own, partner = (
            NamedFaces(*map(np.concatenate, zip(*ends, strict=True))) for ends in zip(*ends_of, strict=True)
        )
        titles = []
        for k, name in enumerate(both, start=1):
            plain = f"{name}{k}" if both[0] == both[1] and name else name
            titles.append(unused(plain or f"periodic{2 * count + k}", used))
            used.add(titles[-1])
        pairs.append(PeriodicPair(titles[0], titles[1], motions[number], own, partner))
    return pairs


def _known(motion: Motion, motions: list[Motion]) -> tuple[int, bool]:
    """Return the index of a motion in `motions`, perhaps new, and whether it is inverse."""
    for number, known in enumerate(motions):
        for backwards, like in ((False, motion), (True, motion.inverse())):
            if known.alike(like, _SAME):
                return number, backwards
    motions.append(motion)
    return len(motions) - 1, False


def _parts(
    connection: Connection, numbers: Sequence[Indices], cells: Sequence[Indices]
) -> tuple[NamedFaces, NamedFaces]:
    """Return faces and cells of both sides of a connection, those of the donor reversed."""
    faces = [faces_of(nodes[..., 0], connection.side) for nodes in connection.pairs(numbers)]
    behind = [rows.ravel(order="F") for rows in cells_beside(connection, cells)]
    return NamedFaces(faces[0], behind[0]), NamedFaces(faces[1][:, _OPPOSITE[faces[1].shape[1]]], behind[1])


def cells_beside(connection: Connection, cells: Sequence[Indices]) -> tuple[Indices, Indices]:
    """Return the ids of the cells on each side of a connection; ids at the same place are of neighbours."""
    own, donor = cells_at(connection, lambda block, side: face_of(cells[block][..., None], side))
    return own[..., 0], donor[..., 0]


def donor_range(each: Connection) -> Range:
    """Return the donor's node range; along a reversed direction, the range begins at the greater index."""
    span = list(each.donor_range)
    for way in each.orientation:
        if way < 0:
            span[-way - 1] = span[-way - 1][::-1]
    return tuple(span)


def patch_on(grid: Grid, connection: Connection) -> str:
    """Return the patch name on the first side of a connection; empty if there are several names."""
    own = [patch for patch in grid.patches if patch.block == connection.block]
    counts = grid.blocks[connection.block].counts
    owners = owners_of(own, counts, (), connection.side)
    part = owners[tuple(slice(first, last) for first, last in connection.range)]
    names = {own[number].name if number >= 0 else "" for number in np.unique(part).tolist()}
    return names.pop() if len(names) == 1 else ""
