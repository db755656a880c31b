"""The boundary of a volume: six faces that share twelve edges.

::

    west, east (nj, nk)      i = 0, ni-1          the indices of a face are those of the block
    south, north (ni, nk)    j = 0, nj-1          other than its own, in the same order
    bottom, top (ni, nj)     k = 0, nk-1
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations

import numpy as np

from meshonet.geometry.arrays import Floats, Side, norms
from meshonet.geometry.blocks.block import PLACES, Block, face_counts, face_of
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.curves.cubic import cubic_spline
from meshonet.geometry.errors import InputError, place_of

FACES: tuple[Side, ...] = tuple(PLACES)  # west, east, south, north, bottom, top


@dataclass(frozen=True, eq=False)
class SixFaces:
    """Nodes of the six faces of a volume, in any unit of length.

    Parameters
    ----------
    west, east : (nj, nk, 3)
    south, north : (ni, nk, 3)
    bottom, top : (ni, nj, 3)
    name : name of the shape.
    patches : names of the sides, as in `meshonet.geometry.blocks.grid.Grid`.
    notes : sentences for users that say how nodes were changed.

    Raises InputError: node counts that disagree; nodes of a shared edge that are not bitwise equal.
    """

    west: Floats
    east: Floats
    south: Floats
    north: Floats
    bottom: Floats
    top: Floats
    name: str = ""
    patches: tuple[Patch, ...] = ()
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for side in FACES:
            object.__setattr__(self, side, Block(getattr(self, side)).nodes)
        for side, second in edges():
            own, donor = self.edge(side, second), self.edge(second, side)
            if len(own) != len(donor):
                problem = f"{len(own)} nodes on {side} and {len(donor)} on {second} along their common edge"
                raise InputError(problem, "give both as many")
            if not np.array_equal(own, donor):
                at = int(np.argmax((own != donor).any(axis=-1)))
                gap = norms(own - donor).max()
                problem = f"{side} and {second} are {gap:.3g} apart along their common edge"
                raise InputError(problem, "give both the same nodes", place=place_of(own[at]))

    @classmethod
    def of_block(cls, nodes: Floats, *, name: str = "", patches: tuple[Patch, ...] = ()) -> "SixFaces":
        """Return the outer faces of nodes (ni, nj, nk, 3)."""
        west, east, south, north, bottom, top = (face_of(nodes, side) for side in FACES)
        return cls(west, east, south, north, bottom, top, name, patches)

    @property
    def counts(self) -> tuple[int, int, int]:
        """Number of nodes along each direction."""
        return self.bottom.shape[0], self.bottom.shape[1], self.west.shape[1]

    @property
    def faces(self) -> tuple[Floats, ...]:
        """The six faces, in the order of `FACES`."""
        return self.west, self.east, self.south, self.north, self.bottom, self.top

    def edge(self, side: Side, second: Side) -> Floats:
        """Return a view of the nodes (n, 3) of the edge that two faces share, as stored in face `side`."""
        return edge_of(getattr(self, side), side, second)

    def steps_at_edge(self, side: Side, second: Side) -> Floats:
        """Return the vectors (n, 3) across that row of cells of face `side` that touches face `second`.

        There is a vector for each node of their common edge. It points to the side of larger indices.
        """
        axis, end = PLACES[second]
        rows = np.moveaxis(getattr(self, side), axis - (axis > PLACES[side][0]), 0)
        return np.asarray(rows[1] - rows[0] if end == 0 else rows[-1] - rows[-2])

    @cached_property
    def size(self) -> float:
        """The diagonal of the box around all nodes."""
        low = np.min([face.min(axis=(0, 1)) for face in self.faces], axis=0)
        high = np.max([face.max(axis=(0, 1)) for face in self.faces], axis=0)
        return math.hypot(*(high - low))

    def edges_along(self, axis: int) -> list[Floats]:
        """Return the four edges (n, 3) of the volume along the direction number `axis`.

        In the two other directions, the edges are at (low, low), (high, low), (low, high) and (high, high).
        """
        first, second = (
            [side for side in FACES if PLACES[side][0] == each] for each in range(3) if each != axis
        )
        return [self.edge(side, other) for other in second for side in first]

    def grid(self, nodes: Floats, provenance: dict[str, object] | None = None) -> Grid:
        """Return the grid of nodes (ni, nj, nk, 3) between these faces, with their patches."""
        block = Block(nodes, finite=True)
        patches = self.patches or _sides(block.counts)
        return Grid((block,), patches, (), self.name, provenance or {})

    def resampled(self, counts: tuple[int, int, int]) -> "SixFaces":
        """Return the faces with other node counts but the same distribution, interpolated by cubic splines.

        Raises InputError: fewer than 2 nodes along a direction.
        """
        if min(counts) < 2:
            raise InputError(f"{counts} nodes of a volume", "use at least 2 a direction", parameter="res")
        if counts == self.counts:
            return self
        knots = [np.linspace(0.0, 1.0, n) for n in self.counts]
        return replace(
            self.at(knots, [np.linspace(0.0, 1.0, n) for n in counts]), patches=self._scaled(counts)
        )

    def at(self, knots: list[Floats], places: list[Floats]) -> "SixFaces":
        """Return the faces with new nodes, interpolated by cubic splines.

        `knots` and `places` are parameters, 0 to 1, of present and of new nodes along each direction.
        """
        made: dict[Side, Floats] = {}
        for side in FACES:
            first, second = (axis for axis in range(3) if axis != PLACES[side][0])
            rows = cubic_spline(getattr(self, side), knots[first], places[first])
            made[side] = np.moveaxis(
                cubic_spline(np.moveaxis(rows, 1, 0), knots[second], places[second]), 0, 1
            )
        share_edges(made)
        west, east, south, north, bottom, top = (made[side] for side in FACES)
        return SixFaces(west, east, south, north, bottom, top, self.name, (), self.notes)

    def _scaled(self, counts: tuple[int, int, int]) -> tuple[Patch, ...]:
        """Return the patches for other node counts if each covers a whole side; otherwise none."""
        whole = len({patch.side for patch in self.patches}) == len(self.patches)
        if not whole:
            return ()
        sides = {patch.side: patch for patch in _sides(counts)}
        return tuple(
            replace(patch, start=0, stop=sides[patch.side].stop, across=None) for patch in self.patches
        )


def edges() -> Iterator[tuple[Side, Side]]:
    """Yield the pairs of faces that share an edge."""
    for side, second in combinations(FACES, 2):
        if PLACES[side][0] != PLACES[second][0]:
            yield side, second


def edge_of(face: Floats, side: Side, second: Side) -> Floats:
    """Return a view of the nodes (n, 3) that `face`, which is on `side`, shares with the face on `second`."""
    axis, end = PLACES[second]
    return np.asarray(np.moveaxis(face, axis - (axis > PLACES[side][0]), 0)[end])


def share_edges(faces: dict[Side, Floats]) -> None:
    """Make shared edges exactly equal, in place: the nodes of the face that is first in `FACES` are kept."""
    for side in FACES:
        faces[side] = np.array(faces[side])
    for side, second in edges():
        edge_of(faces[second], second, side)[...] = edge_of(faces[side], side, second)


def _sides(counts: tuple[int, ...]) -> tuple[Patch, ...]:
    """Return one patch for each side of a block with `counts` nodes, with the name of the side."""
    return tuple(Patch(side, side, 0, face_counts(counts, side)[0] - 1) for side in PLACES)
