"""Joins the curves of a drawing at coincident ends."""

from collections import Counter
from collections.abc import Iterable, Iterator

import numpy as np

from meshonet.formats.mesh.surface import MOST_EDGES, MeshBoundary, noted, shapes_of
from meshonet.formats.mesh.unstructured import Indices
from meshonet.formats.source import LARGEST, printable
from meshonet.geometry.arrays import Floats, extent_of
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.shape import Shape

MOST_BYTES = 64 << 20  # largest drawing that is read, in bytes
SAG = 1e-5  # largest distance of a chord from its curve, relative to the extent
MEET = 1e-6  # largest distance of two ends that are joined, relative to the extent


def shapes_of_drawing(lines: list[tuple[str, Floats]], skipped: Iterable[str], name: str) -> Iterator[Shape]:
    """Yield the shapes that named curves (n, 2) enclose, with a note on the `skipped` kinds of elements."""
    counts = Counter(skipped)
    listed = ", ".join(f"{count} {printable(kind)}" for kind, count in sorted(counts.items()))
    notes = (f"of the drawing, elements that are no curves are left out: {listed}",) if counts else ()
    yield from (noted(shape, notes) for shape in shapes_of(joined(lines), name))


def extent_checked(points: Floats) -> float:
    """Return the extent of points (n, 2). Raises InputError if it is zero or not finite."""
    extent = extent_of(points)
    if not (np.abs(points) < LARGEST).all() or extent == 0:
        raise InputError("its curves have no size, or one that is not finite", "check the drawing")
    return extent


def joined(lines: list[tuple[str, Floats]]) -> MeshBoundary:
    """Return curves (n, 2) as a mesh boundary, in which coincident ends are one point.

    Raises InputError if the curves have too many points.
    """
    lines = [(name, line[np.append(True, (np.diff(line, axis=0) != 0).any(axis=1))]) for name, line in lines]
    lines = [(name, line) for name, line in lines if len(line) > 1]
    if sum(len(line) for _, line in lines) > MOST_EDGES:
        raise InputError(f"has more than {MOST_EDGES} points", "simplify the drawing")
    points = np.concatenate([line for _, line in lines])
    reach = MEET * extent_of(points)
    counts = [len(line) for _, line in lines]
    stops = np.cumsum(counts)
    starts = stops - counts
    same = np.arange(len(points))
    ends = np.concatenate([starts, stops - 1])
    order = ends[np.argsort(points[ends, 0], kind="stable")].tolist()
    for k, end in enumerate(order):
        if same[end] != end:
            continue
        for later in order[k + 1 :]:
            if points[later, 0] - points[end, 0] > reach:
                break
            if same[later] == later and abs(points[later, 1] - points[end, 1]) <= reach:
                same[later] = end
    edges: dict[str, list[Indices]] = {}
    for (name, _), start, stop in zip(lines, starts, stops, strict=True):
        nodes = same[start:stop]
        edges.setdefault(name, []).append(np.stack([nodes[:-1], nodes[1:]], axis=1))
    return MeshBoundary(points, {name: np.concatenate(pieces) for name, pieces in edges.items()})
