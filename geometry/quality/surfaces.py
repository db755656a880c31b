"""Metrics of quadrilaterals of surface patches, relative to the normal of each at its centre.

The normal is the cross product of the grid lines' directions there. Corners with an edge of zero length, as
at a pole, are left out. Definitions: `meshonet.geometry.quality.metrics`.
"""

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats, cross2, norms, ring_of
from meshonet.geometry.elementary import arccos
from meshonet.geometry.quality.bad_cell import BadCell
from meshonet.geometry.quality.metrics import NAMES

_TINY, _LARGE = 1e-300, 1e30  # in place of 0 in divisors; upper bound of ratios, as in the compiled metrics


def quad_metrics(nodes: Floats) -> Floats:
    """Return the metrics `NAMES` (metrics, ni-1, nj-1) of the cells of a surface patch (ni, nj, 3)."""
    ring = ring_of(nodes)
    edges = np.roll(ring, -1, axis=0) - ring
    before = np.roll(edges, 1, axis=0)
    lengths = norms(edges)
    product = lengths * np.roll(lengths, 1, axis=0)
    scaled = _scaled_jacobians(ring)
    cosine = np.divide(-(before * edges).sum(axis=-1), product, out=np.zeros_like(product), where=product > 0)
    angle = np.degrees(arccos(np.clip(cosine, -1.0, 1.0)))
    widest = np.where(scaled.min(axis=0) < 0, 360.0 - angle.max(axis=0), angle.max(axis=0))
    narrowest = angle.min(axis=0)
    along, across = edges[0] - edges[2], edges[1] - edges[3]
    normal = np.cross(along, across)
    area = 0.25 * norms(normal)  # as Verdict's for a planar cell
    size = np.maximum(norms(along) * norms(across), _TINY)
    crossing = np.degrees(arccos(np.clip(np.abs((along * across).sum(axis=-1)) / size, 0.0, 1.0)))
    aspect = lengths.max(axis=0) * lengths.sum(axis=0) / np.maximum(4.0 * area, _TINY)
    values = {
        "max_angle": widest,
        "min_angle": narrowest,
        "skewness": np.maximum(widest - 90.0, 90.0 - narrowest) / 90.0,
        "scaled_jacobian": scaled.min(axis=0),
        "aspect_ratio": np.minimum(aspect, _LARGE),
        "orthogonality": crossing,
        "area_ratio": _area_ratios(area),
    }
    return np.stack([values[name] for name in NAMES])


def folded_quads(nodes: Floats) -> NDArray[np.int64]:
    """Return the indices (n, 2) of the folded cells of `nodes` (ni, nj, 3)."""
    return np.argwhere(~(_scaled_jacobians(ring_of(nodes)).min(axis=0) > 0)).astype(np.int64)


def worst_quads(nodes: Floats, limit: int = 10) -> list[BadCell]:
    """Return up to `limit` folded cells of `nodes` (ni, nj, 3), by ascending scaled Jacobian."""
    ring = ring_of(nodes)
    least, centre = _scaled_jacobians(ring).min(axis=0), ring.mean(axis=0)
    places = folded_quads(nodes)
    order = np.argsort(least[tuple(places.T)], kind="stable")[:limit]
    return [bad_cell(place, centre[tuple(place)]) for place in places[order]]


def bad_cell(place: Iterable[int], centre: Iterable[float]) -> BadCell:
    """Return the folded cell with the indices `place`, (i, j) or (i, j, k), and the `centre` (2 or 3,)."""
    (i, j, *k), (x, y, *z) = map(int, place), map(float, centre)
    return BadCell(i, j, x, y, k=k[0] if k else None, z=z[0] if z else None)


def areas(rows: Floats) -> Floats:
    """Return the areas (m-1, n-1) of the cells of nodes `rows` (m, n, 2 or 3)."""
    first, second = rows[1:, 1:] - rows[:-1, :-1], rows[1:, :-1] - rows[:-1, 1:]
    if rows.shape[-1] == 2:
        return 0.5 * np.abs(cross2(first, second))
    return 0.5 * norms(np.cross(first, second))


def _scaled_jacobians(ring: Floats) -> Floats:
    """Return the scaled Jacobians (4, ni-1, nj-1) of cell corners, 1 where an edge has zero length."""
    edges = np.roll(ring, -1, axis=0) - ring
    before = np.roll(edges, 1, axis=0)
    normal = np.cross(edges[0] - edges[2], edges[1] - edges[3])
    normal /= np.maximum(norms(normal), _TINY)[..., None]
    jacobian = (np.cross(before, edges) * normal).sum(axis=-1)
    size = norms(before) * norms(edges)
    least = np.divide(jacobian, size, out=np.ones_like(size), where=size > 0)
    least[:, (size > 0).sum(axis=0) == 0] = 0.0
    return least


def _area_ratios(area: Floats) -> Floats:
    padded = np.pad(area, 1, mode="edge")
    beside: Sequence[Floats] = padded[:-2, 1:-1], padded[2:, 1:-1], padded[1:-1, :-2], padded[1:-1, 2:]
    high, low = np.maximum.reduce(beside), np.minimum.reduce(beside)
    own = np.maximum(area, _TINY)
    return np.minimum(np.maximum(high / own, area / np.maximum(low, _TINY)).clip(1.0), _LARGE)
