"""Decides whether the blocks of a three-dimensional file are a planar grid, volumes or surfaces.

Only slices across one coordinate, at the same places, are a planar grid (`lattices`).
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.mesh.axis_order import nodes_of
from meshonet.formats.mesh.recover_topology import is_left_handed
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.handedness import signed_volume
from meshonet.geometry.errors import InputError, in_place

_SAME = 1e-6  # tolerance for equal planes and coordinates, relative to the grid's size (float32 has 1e-7)
_SURFACES = ContextVar("_SURFACES", default=False)


@contextmanager
def surfaces_wanted() -> Iterator[None]:
    """Return a context in which flat patches in space are read as surfaces, not as planar grids."""
    token = _SURFACES.set(True)
    try:
        yield
    finally:
        _SURFACES.reset(token)


@dataclass(frozen=True)
class IndexedNodes:
    """Nodes (ni, nj, 2 or 3) or (ni, nj, nk, 3) of a block, and how its directions relate to the file's.

    Direction d of `nodes` (0 is i) is direction ``axes[d]`` (0 to 2) of the file's arrays. If `reversed`, i
    of `nodes` runs against its direction in the file.
    """

    nodes: Floats
    axes: tuple[int, ...]
    reversed: bool = False


class _Slice(NamedTuple):
    """A slice: normal index, kept coordinates, constant coordinate and its values, size."""

    axis: int
    kept: tuple[int, ...]
    flat: int
    heights: tuple[float, ...]
    size: float


def lattices(blocks: Sequence[Sequence[Floats]], places: Sequence[str] = ()) -> list[IndexedNodes]:
    """Return the nodes of each block of a file, given as coordinates x, y[, z] of shape (n1, n2, n3) each.

    Blocks are planar if all nodes lie in one plane of constant x, y or z. They are also planar if each block
    has the same nodes twice, once in each of two such planes. This coordinate is then left out. Otherwise, or
    inside ``with surfaces_wanted()``, blocks with one node in a direction are surface patches, others are
    volumes. Left-handed planar blocks and volumes are reversed along i. `places` are names of blocks in
    messages. Raises InputError if a block has no cells.
    """
    with np.errstate(all="ignore"):  # what is not finite is refused later, with its place
        slices = []
        for coordinates, place in zip(blocks, places or [""] * len(blocks), strict=True):
            with in_place(place):
                slices.append(_slice_of(coordinates))
        if _in_one_plane(slices) and not _SURFACES.get():
            planes = [_plane(block, each) for block, each in zip(blocks, slices, strict=True) if each]
            return [
                replace(each, nodes=each.nodes[::-1], reversed=True) if is_left_handed(each.nodes) else each
                for each in planes
            ]
        return [_in_space(block) for block in blocks]


def planar(coordinates: Sequence[Floats]) -> Floats:
    """Return nodes (ni, nj, 2) from x, y[, z] of one plane or several equal ones; else raise InputError."""
    with np.errstate(all="ignore"):
        cut = _slice_of(coordinates, most=max(coordinates[0].shape))
        if cut:
            return _plane(coordinates, cut).nodes
    counts = "x".join(map(str, coordinates[0].shape))
    if 1 in coordinates[0].shape:
        problem = f"the {counts} nodes lie on a curved or tilted surface"
        raise InputError(problem, "give a grid in a coordinate plane")
    remedy = "give a plane one: one plane, or copies of one, in some direction"
    raise InputError(f"a grid of {counts} nodes is three-dimensional", remedy)


def _plane(coordinates: Sequence[Floats], cut: _Slice) -> IndexedNodes:
    within = [_at(coordinates[k], cut.axis, 0) for k in cut.kept]
    return IndexedNodes(nodes_of(within), tuple(axis for axis in range(3) if axis != cut.axis))


def _in_space(coordinates: Sequence[Floats]) -> IndexedNodes:
    """Return a volume block or a surface patch."""
    axes = tuple(axis for axis, count in enumerate(coordinates[0].shape) if count > 1)
    coordinates = [np.squeeze(values) for values in coordinates]
    left_handed = len(axes) == 3 and signed_volume(coordinates) < 0
    if left_handed:
        coordinates = [values[::-1] for values in coordinates]
    return IndexedNodes(nodes_of(coordinates), axes, left_handed)


def _in_one_plane(slices: Sequence[_Slice | None]) -> bool:
    """Return whether all blocks are slices at the same positions."""
    first, *rest = slices
    if first is None:
        return False
    size = max(each.size if each else 0.0 for each in slices)
    return all(
        each is not None
        and (each.flat, len(each.heights)) == (first.flat, len(first.heights))
        and np.allclose(sorted(each.heights), sorted(first.heights), rtol=0, atol=_SAME * size)
        for each in rest
    )


def _slice_of(coordinates: Sequence[Floats], most: int = 2) -> _Slice | None:
    """Return the slice that a block with at most `most` planes is, or None."""
    dims = coordinates[0].shape
    if sum(count > 1 for count in dims) < 2:
        problem = f"a grid of {'x'.join(map(str, dims))} nodes has no cells"
        raise InputError(problem, "give at least 2 nodes in two directions")
    for axis in sorted(range(3), key=lambda k: (dims[k], -k)):
        if dims[axis] > most:
            break
        first = [_at(values, axis, 0) for values in coordinates]
        cut = _flat(first, axis) if dims[axis] == 1 else None
        for k in range(1, dims[axis]):
            cut = _copies(first, [_at(values, axis, k) for values in coordinates], axis, cut)
            if cut is None:
                break
        if cut or dims[axis] == 1:
            return cut
    return None


def _at(values: NDArray[Any], axis: int, index: int) -> NDArray[Any]:
    """Return a view of plane `index` of (n1, n2, n3) along `axis`."""
    return values[(slice(None),) * axis + (index,)]


def _flat(plane: list[Floats], axis: int) -> _Slice | None:
    """Return the slice that a plane of nodes is; of several constant coordinates the last is dropped."""
    spans = [float(np.ptp(values)) for values in plane]
    size = max(spans)
    if len(plane) == 2:
        return _Slice(axis, (0, 1), 2, (), size)
    for flat in (2, 1, 0):
        if not spans[flat] > _SAME * size:
            kept = tuple(k for k in range(3) if k != flat)
            return _Slice(axis, kept, flat, (float(plane[flat].flat[0]),), size)
    return None


def _copies(first: list[Floats], next_plane: list[Floats], axis: int, before: _Slice | None) -> _Slice | None:
    """Return the slice of two planes with one constant coordinate and equal others, or None."""
    size = max(float(np.ptp(values)) for values in first)
    for flat in (2, 1, 0):
        if flat >= len(first) or (before and before.flat != flat):
            continue
        kept = tuple(k for k in range(len(first)) if k != flat)
        thin = max(float(np.ptp(first[flat])), float(np.ptp(next_plane[flat]))) <= _SAME * size
        if thin and all(np.allclose(first[k], next_plane[k], rtol=0, atol=_SAME * size) for k in kept):
            heights = before.heights if before else (float(first[flat].flat[0]),)
            return _Slice(axis, kept, flat, (*heights, float(next_plane[flat].flat[0])), size)
    return None
