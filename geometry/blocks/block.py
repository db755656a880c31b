"""A block: a structured array of nodes, in the plane, on a surface in space, or in a volume.

::

        north (j = nj-1)         A three-dimensional block has two more sides, bottom (k = 0) and top
      +----------------+         (k = nk-1). Directions and sides are those of the indices. A node may have
      |                |         more coordinates than its block has directions: a surface patch in space
 west |   eta          | east    has two directions and three coordinates.
(i=0) |    ^           | (i = ni-1)
      |    |           |
      |    +--> xi     |
      +----------------+
       south (j = 0)
"""

import math
from collections.abc import Sequence
from dataclasses import InitVar, dataclass
from typing import Literal, TypeAlias

import numpy as np

from meshonet.geometry.arrays import AnyArray, Floats, Side, as_planar
from meshonet.geometry.errors import InputError

Range: TypeAlias = tuple[tuple[int, int], ...]
"""First and last node, both included, along each direction of a side."""

PLACES: dict[Side, tuple[int, int]] = {
    "west": (0, 0), "east": (0, -1), "south": (1, 0), "north": (1, -1), "bottom": (2, 0), "top": (2, -1),
}  # fmt: skip
"""The index direction normal to a side (0 is xi, 1 eta, 2 zeta), and its end: 0 the first, -1 the last."""

Form: TypeAlias = Literal["plane", "surface", "volume"]

_KINDS = {(2, 2), (2, 3), (3, 3)}  # number of index directions of a block, number of coordinates of its nodes


@dataclass(frozen=True, eq=False)
class Block:
    """The nodes of one block, in any unit of length.

    `nodes` are (ni, nj, 2) in the plane, (ni, nj, 3) on a surface, or (ni, nj, nk, 3) in a volume. They are
    kept as float64 in planar layout (see `meshonet.geometry.arrays`). With `finite`, the check for infinities
    and NaN is skipped.

    Raises InputError: nodes of another shape, fewer than 2 along a direction, or not finite.
    """

    nodes: Floats
    finite: InitVar[bool] = False

    def __post_init__(self, finite: bool) -> None:
        nodes = np.asarray(self.nodes)
        shape = nodes.shape
        if (nodes.ndim - 1, shape[-1] if shape else 0) not in _KINDS or min(shape[:-1]) < 2:
            raise InputError(
                f"grid nodes have shape {shape}",
                "give (ni, nj, 2), (ni, nj, nk, 3) or (ni, nj, 3), with at least 2 nodes a direction",
            )
        nodes = as_planar(nodes)
        if not finite:
            _check_finite(nodes)
        object.__setattr__(self, "nodes", nodes)

    @property
    def counts(self) -> tuple[int, ...]:
        """Number of nodes along each direction."""
        return self.nodes.shape[:-1]

    @property
    def cells(self) -> int:
        """Number of cells."""
        return math.prod(count - 1 for count in self.counts)

    def face(self, side: Side) -> Floats:
        """Return a view of the nodes (n, d) or (n, m, d) of a side."""
        return face_of(self.nodes, side)


def face_of(values: AnyArray, side: Side) -> AnyArray:
    """Return a view of the entries of `values` (ni, nj, ...) or (ni, nj, nk, ...) at the nodes of a side."""
    axis, end = PLACES[side]
    return values[(slice(None),) * axis + (end,)]  # type: ignore[return-value]


def part_of(values: AnyArray, span: Range) -> AnyArray:
    """Return a view of the `values` (n, ...) or (n, m, ...) of a side that lie in the index range `span`."""
    for axis, (first, last) in enumerate(span):
        values = values[(slice(None),) * axis + (slice(first, last + 1),)]  # type: ignore[assignment]
    return values


def face_counts(counts: tuple[int, ...], side: Side) -> tuple[int, ...]:
    """Return the node counts along the directions of a side of a block with the node counts `counts`."""
    axis = PLACES[side][0]
    return counts[:axis] + counts[axis + 1 :]


def sides_of(counts: tuple[int, ...]) -> tuple[Side, ...]:
    """Return the sides of a block with `counts` nodes per direction, in the order of `PLACES`."""
    return tuple(PLACES)[: 2 * len(counts)]


def _check_finite(nodes: Floats) -> None:
    # a sum is finite exactly if its terms are (overflow aside): one pass without a temporary array
    with np.errstate(invalid="ignore", over="ignore"):  # infinity minus infinity
        total = nodes.sum()
    if not np.isfinite(total):
        finite = np.isfinite(nodes).all(axis=-1)
        if not finite.all():
            place = ", ".join(f"{name}={k}" for name, k in zip("ijk", np.argwhere(~finite)[0], strict=False))
            raise InputError(f"node {place} is not finite", "check the file for NaN or infinity")


def form_of(nodes: Floats) -> Form:
    """Return the form of a block from the shape of its nodes: ``plane``, ``surface`` or ``volume``."""
    if nodes.ndim == 4:
        return "volume"
    return "plane" if nodes.shape[-1] == 2 else "surface"


def check_alike(blocks: Sequence[Block]) -> None:
    """Raise InputError unless all blocks are planar, all are surface patches, or all are volumes."""
    first = form_of(blocks[0].nodes)
    for number, block in enumerate(blocks):
        if form_of(block.nodes) != first:
            names = {"plane": "in the plane", "surface": "a surface patch", "volume": "a volume"}
            mixed = f"block 0 is {names[first]} and block {number} is {names[form_of(block.nodes)]}"
            raise InputError(mixed, "keep them in grids of their own")
