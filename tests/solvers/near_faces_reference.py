"""The test of inner nodes next to faces, in NumPy: what `edge_corners.closed_place` computes."""

from itertools import combinations, product

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats, Side
from meshonet.geometry.blocks.block import PLACES
from meshonet.geometry.blocks.six_faces import SixFaces
from meshonet.solvers.volumes.edge_corners import Place, Ranges, next_to_faces

ROUNDING = 1e-12
OPEN = 0.05
"""Product of the sum of four unit normals with each of them from which on they plainly have a common side."""
FLAT = 1e-4
"""Sum of four determinants of unit normals below which these are too nearly in a plane to tell anything."""


def closed_place(faces: SixFaces) -> Place | None:
    """Return i, j, k of an inner node that has no place at which the corners around it are open, or None."""
    for sides, ranges in next_to_faces(faces.counts):
        bad = _closed(faces, sides, ranges)
        if bad.any():
            at = np.unravel_index(int(np.argmax(bad)), bad.shape)
            i, j, k = (int(low + step) for (low, _), step in zip(ranges, at, strict=True))
            return i, j, k
    return None


def _closed(faces: SixFaces, sides: tuple[Side, ...], ranges: Ranges) -> NDArray[np.bool_]:
    """Return for the nodes in `ranges` whether their half-spaces, of all `sides`, have nothing in common."""
    halves = [_half_spaces(faces, side, ranges) for side in sides]
    normals = np.concatenate([normal for normal, _ in halves])
    if len(sides) == 1:  # of most nodes it is plain that all four have a direction in common
        common = normals.sum(axis=0)
        open_ = (normals * common).sum(axis=-1).min(axis=0) > OPEN
        if open_.all():
            return np.zeros(open_.shape, dtype=bool)
    bounds = np.concatenate([bound for _, bound in halves])
    fours = np.array(list(combinations(range(len(normals)), 4)))
    n, b = np.moveaxis(normals, -1, 0)[:, fours], bounds[fours]
    shares = np.stack([(-1) ** m * _determinant(np.delete(n, m, axis=2)) for m in range(4)], axis=1)
    shares *= np.where(shares.sum(axis=1, keepdims=True) < 0, -1.0, 1.0)
    total = shares.sum(axis=1)
    slack = -ROUNDING * (shares * np.abs(b)).sum(axis=1)
    closed = (shares >= 0).all(axis=1) & (total > FLAT) & ((shares * b).sum(axis=1) >= slack)
    first, second = np.array(
        list(combinations(range(len(normals)), 2))
    ).T  # opposite ones, as of a plane face
    opposite = (normals[first] * normals[second]).sum(axis=-1) < -1.0 + ROUNDING
    facing = opposite & (bounds[first] + bounds[second] >= -ROUNDING * np.abs(bounds[first]))
    return np.asarray(closed.any(axis=0) | facing.any(axis=0))


def _determinant(three: Floats) -> Floats:
    """Return the determinants of (3, m, 3, ...): coordinate, set, vector."""
    (x, y, z), (a, b, c) = three, (0, 1, 2)
    return np.asarray(
        x[:, a] * (y[:, b] * z[:, c] - z[:, b] * y[:, c])
        + y[:, a] * (z[:, b] * x[:, c] - x[:, b] * z[:, c])
        + z[:, a] * (x[:, b] * y[:, c] - y[:, b] * x[:, c])
    )


def _half_spaces(faces: SixFaces, side: Side, ranges: Ranges) -> tuple[Floats, Floats]:
    """Return unit normals (4, ..., 3), inwards, and bounds (4, ...) of n · p at the nodes in `ranges`."""
    axis, end = PLACES[side]
    face = getattr(faces, side)
    spans = [ranges[each] for each in range(3) if each != axis]
    inwards = (1.0 if end == 0 else -1.0) * (-1.0 if axis == 1 else 1.0)
    here = _part(face, spans, (0, 0))
    centre = faces.bottom[0, 0]
    normals = []
    for a, b in product((-1, 1), (-1, 1)):
        first, second = _part(face, spans, (a, 0)) - here, _part(face, spans, (0, b)) - here
        normal = np.cross(first, second) * (a * b * inwards)
        normals.append(normal / np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-300))
    stacked = np.expand_dims(np.stack(normals), axis + 1)
    return stacked, (stacked * np.expand_dims(here - centre, axis)).sum(axis=-1)


def _part(face: Floats, spans: list[tuple[int, int]], step: tuple[int, int]) -> Floats:
    first, second = (slice(low + by, high + by) for (low, high), by in zip(spans, step, strict=True))
    return np.asarray(face[first, second])
