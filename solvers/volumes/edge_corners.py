"""Checks whether faces fold cells wherever the inner nodes are: along edges, or next to faces."""

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from meshonet.geometry.arrays import Floats, Side, norms
from meshonet.geometry.blocks.block import PLACES
from meshonet.geometry.blocks.six_faces import FACES, SixFaces, edges
from meshonet.geometry.errors import InputError, place_of
from meshonet.geometry.threads import threads_for
from meshonet.kernels._native import closed_node

Place = tuple[int, int, int]

Ranges = list[tuple[int, int]]  # first and end index of nodes along each direction


def check_corners(faces: SixFaces) -> None:
    """Raise InputError, which names a place, if the faces fold a cell wherever the inner nodes are.

    At an edge of the volume, the two faces alone determine the Jacobians of cells, which must be positive.
    Elsewhere, each inner node next to faces must have a position that folds no cell (see `closed_place`).
    """
    check_hand(faces)
    worst = []
    negative = 0
    for side, second in edges():
        scaled = _jacobians(faces, side, second)
        bad = ~(scaled > 0)
        negative += int(bad.sum())
        if bad.any():
            segment, end = np.unravel_index(int(np.where(bad, scaled, 1.0).argmin()), scaled.shape)
            worst.append((float(scaled[segment, end]), side, second, int(segment + end)))
    if not worst:
        place = closed_place(faces)
        if place is not None:
            at_node = ", ".join(f"{name}={number}" for name, number in zip("ijk", place, strict=True))
            problem = f"wherever node {at_node} is, the faces next to it fold a cell"
            raise InputError(problem, "change the faces there", place=_near(faces, place))
        return
    least, side, second, at = min(worst)
    node = faces.edge(side, second)[at]
    index = _index(faces, side, second, at)
    at_node = ", ".join(f"{name}={number}" for name, number in zip("ijk", index, strict=True))
    problem = (
        f"{side} and {second} fold the cells along their common edge at {at_node} (scaled Jacobian "
        f"{least:.3g}, {negative} such corners), whatever the nodes inside are"
    )
    raise InputError(problem, "change the faces there", place=place_of(node))


def check_hand(faces: SixFaces) -> None:
    """Raise InputError if a volume is left-handed at all eight of its corners."""
    steps = [np.diff(np.stack(faces.edges_along(axis)), axis=1)[:, [0, -1]] for axis in range(3)]
    places = np.array(list(np.ndindex(2, 2, 2))).T
    edges = []
    for axis, step in enumerate(steps):
        first, second = (place for each, place in enumerate(places) if each != axis)
        edges.append(step[first + 2 * second, places[axis]])
    if ((np.cross(edges[0], edges[1]) * edges[2]).sum(axis=1) < 0).all():
        raise InputError("the volume is left-handed", "reverse one of its directions")


def _near(faces: SixFaces, place: tuple[int, int, int]) -> str:
    for side, (axis, end) in PLACES.items():
        if place[axis] == (1 if end == 0 else faces.counts[axis] - 2):
            first, second = (place[each] for each in range(3) if each != axis)
            return place_of(getattr(faces, side)[first, second])
    return ""


def _jacobians(faces: SixFaces, side: Side, second: Side) -> Floats:
    """Return the scaled Jacobians (n - 1, 2) at both ends of the segments of an edge."""
    axis, other = PLACES[side][0], PLACES[second][0]
    edge = faces.edge(side, second)
    # off the edge, in each of the two faces, along the direction that the other face is an end of
    vectors = {other: faces.steps_at_edge(side, second), axis: faces.steps_at_edge(second, side)}
    along = ({0, 1, 2} - {axis, other}).pop()
    step = np.diff(edge, axis=0)
    values = []
    for part in (slice(None, -1), slice(1, None)):
        three = [step if each == along else vectors[each][part] for each in range(3)]
        sizes = np.prod([norms(vector) for vector in three], axis=0)
        jacobian = (np.cross(three[0], three[1]) * three[2]).sum(axis=1)
        values.append(np.divide(jacobian, sizes, out=np.zeros_like(sizes), where=sizes > 0))
    return np.stack(values, axis=1)


def _index(faces: SixFaces, side: Side, second: Side, at: int) -> list[int]:
    index = [at, at, at]
    for name in (side, second):
        axis, end = PLACES[name]
        index[axis] = 0 if end == 0 else faces.counts[axis] - 1
    return index


def closed_place(faces: SixFaces) -> Place | None:
    """Return i, j, k of an inner node that folds cells wherever it is; None if there is no such node.

    Only nodes next to faces are tested, with those corners of cells that lie in the faces.
    """
    for sides, ranges in next_to_faces(faces.counts):
        walls = tuple((np.ascontiguousarray(getattr(faces, side)), *PLACES[side]) for side in sides)
        sizes = [last - low for low, last in ranges]
        number = closed_node(walls, tuple(ranges), threads_for(int(np.prod(sizes))))
        if number >= 0:
            at = np.unravel_index(number, sizes)
            i, j, k = (int(low + step) for (low, _), step in zip(ranges, at, strict=True))
            return i, j, k
    return None


def next_to_faces(counts: tuple[int, int, int]) -> Iterator[tuple[tuple[Side, ...], Ranges]]:
    """Yield each set of 1 to 3 faces that meet, and index ranges of inner nodes next to every one of them."""
    for size in (3, 2, 1) if min(counts) > 2 else ():
        for sides in combinations(FACES, size):
            if len({PLACES[side][0] for side in sides}) == size:
                yield sides, _ranges(sides, counts)


def _ranges(sides: tuple[Side, ...], counts: tuple[int, int, int]) -> Ranges:
    ranges = [(1, n - 1) for n in counts]
    for side in sides:
        axis, end = PLACES[side]
        at = 1 if end == 0 else counts[axis] - 2
        ranges[axis] = (at, at + 1)
    return ranges
