"""The edges of a boundary resampled to other node counts, with the same node distribution."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from meshonet.geometry.arrays import Floats, Side, arc_parts, distinct
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.curves.monotone import monotone_cubic
from meshonet.geometry.errors import InputError

if TYPE_CHECKING:
    from meshonet.geometry.blocks.boundary import Boundary

_AROUND: tuple[Side, Side] = ("south", "north")
_ACROSS: tuple[Side, Side] = ("west", "east")


def resample_edge(nodes: Floats, m: int, *, closed: bool) -> Floats:
    """Return `m` >= 2 nodes (m, 2) on the curve through `nodes` (n, 2), distributed like `nodes`.

    Corners of the curve remain nodes if `m` is large enough; the end nodes are kept bitwise. A `closed` edge
    repeats its first node at the end, both in `nodes` and in the result. Raises InputError: the errors of
    `Curve`.

    >>> resample_edge(np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]), 5, closed=False)[:, 0].tolist()
    [0.0, 0.5, 1.0, 1.5, 2.0]
    """
    n = len(nodes)
    curve = Curve(nodes, closed=closed)
    knots = np.append(curve.knots, curve.length) if closed else curve.knots
    stops = distinct(np.concatenate([[0], curve.corner_index, [n - 1]]))
    place = np.rint(stops * ((m - 1) / (n - 1))).astype(np.intp)
    kept = np.concatenate([[True], (np.diff(place[:-1]) > 0) & (place[1:-1] < m - 1), [True]])
    s = np.empty(m)
    for (a, p), (b, q) in pairwise(zip(stops[kept], place[kept], strict=True)):
        old, new = np.linspace(0.0, 1.0, b - a + 1), np.linspace(0.0, 1.0, q - p + 1)
        s[p : q + 1] = monotone_cubic(old, knots[a : b + 1], new)
    out = curve.at(s)
    out[0], out[-1] = nodes[0], nodes[-1]
    return out


def resample_edges(
    edges: Mapping[Side, Floats], ni: int, nj: int, *, closed: bool, wake: int
) -> dict[Side, Floats]:
    """Return the four `edges` of a block, resampled to `ni` nodes along xi and `nj` along eta.

    The wake is the first and the last `wake` cells of the south edge. The nodes of these two parts stay
    equal, and the fraction of the edge's cells in the wake is kept. If `closed`, south and north are closed.
    Raises InputError: too few nodes for a closed edge, or for the wall between the two sides of a wake.
    """
    if closed and ni < 4:
        raise InputError(f"{ni} nodes around a body", "use at least 4")
    marks = _marks(len(edges["south"]), ni, wake)
    south, north = (_in_pieces(edges[side], *marks, closed) for side in _AROUND)
    west, east = (resample_edge(edges[side], nj, closed=False) for side in _ACROSS)
    if wake:
        cells = marks[1][1]
        south[ni - 1 - cells :] = south[: cells + 1][::-1]
    return {"south": south, "north": north, "west": west, "east": east}


def _marks(had: int, ni: int, wake: int) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Return the end indices of wake, wall and wake, or of the whole side, among `had` and `ni` nodes."""
    if not wake:
        return (0, had - 1), (0, ni - 1)
    cells = max(round(wake * (ni - 1) / (had - 1)), 1)
    if ni - 1 - 2 * cells < 2:
        raise InputError(f"{ni} nodes along a C boundary with a wake", f"use at least {2 * cells + 3}")
    return (0, wake, had - 1 - wake, had - 1), (0, cells, ni - 1 - cells, ni - 1)


def _in_pieces(side: Floats, ends: tuple[int, ...], places: tuple[int, ...], closed: bool) -> Floats:
    """Return `side` resampled in pieces: the nodes between two `ends` come to lie between two `places`."""
    pieces = [
        resample_edge(side[a : b + 1], q - p + 1, closed=closed)
        for (a, b), (p, q) in zip(pairwise(ends), pairwise(places), strict=True)
    ]
    return np.concatenate([*(piece[:-1] for piece in pieces[:-1]), pieces[-1]])


def resample_patches(
    patches: tuple[Patch, ...], had: tuple[int, int], has: tuple[int, int], wake: int
) -> tuple[Patch, ...]:
    """Return `patches` with new index ranges, after node counts (xi, eta) change from `had` to `has`.

    `wake` is the number of cells from end to end of the wake of a C boundary before the change, else 0.
    """
    along_xi, along_eta = _marks(had[0], has[0], wake), _marks(had[1], has[1], 0)

    def moved(patch: Patch) -> Patch:
        marks = along_xi if patch.side in _AROUND else along_eta
        start, stop = (round(float(np.interp(k, *marks))) for k in (patch.start, patch.stop))
        return _with_cell(patch, start, stop, marks[1][-1])

    return tuple(moved(patch) for patch in patches)


def patches_in_place(old: Boundary, new: Boundary) -> tuple[Patch, ...]:
    """Return the patches of `old` for `new`; each end moves to the node nearest in relative arc length."""

    def moved(patch: Patch) -> Patch:
        before, after = (arc_parts(getattr(edges, patch.side)) for edges in (old, new))
        start, stop = (int(np.abs(after - before[k]).argmin()) for k in (patch.start, patch.stop))
        return _with_cell(patch, start, stop, len(after) - 1)

    return tuple(moved(patch) for patch in old.patches)


def _with_cell(patch: Patch, start: int, stop: int, last: int) -> Patch:
    """Return a patch from `start` to `stop`, with a cell at least, on a side whose last node is `last`."""
    start = min(start, last - 1)
    return replace(patch, start=start, stop=max(stop, start + 1))
