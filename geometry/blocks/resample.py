"""The edges of a boundary with other node counts, spaced as they were."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise

import numpy as np

from meshonet.geometry.arrays import Floats, Side, distinct
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.curves.monotone import monotone_cubic
from meshonet.geometry.errors import InputError


def resample_edge(nodes: Floats, m: int, *, closed: bool) -> Floats:
    """Return `m` nodes (m, 2) on the curve through `nodes` (n, 2), spaced by the same law.

    Arc length as a function of the place along the edge, 0 to 1, is kept; corners of the curve stay
    nodes as far as `m` suffices; the end nodes are kept bitwise.

    Parameters
    ----------
    nodes : a closed edge repeats its first node at the end.
    m : at least 2.
    closed : the edge returns to its start.

    Examples
    --------
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
    """Return the four `edges` of a block with ni nodes along xi and nj along eta.

    Parameters
    ----------
    edges : by side.
    closed : south and north are closed.
    wake : cells at each end of south whose nodes are the same; they get their share of the cells.

    Raises
    ------
    InputError
        too few nodes for a closed edge, or for the wall between the two sides of a wake.
    """
    if closed and ni < 4:
        raise InputError(f"{ni} nodes around a body", "use at least 4")
    sides: dict[Side, Floats] = {}
    around: tuple[Side, Side] = ("south", "north")
    across: tuple[Side, Side] = ("west", "east")
    if wake:
        marks = wake_marks(len(edges["south"]), wake, ni)
        for side in around:
            sides[side] = _in_pieces(edges[side], *marks)
        cells = marks[1][1]
        sides["south"][ni - 1 - cells :] = sides["south"][: cells + 1][::-1]
    else:
        for side in around:
            sides[side] = resample_edge(edges[side], ni, closed=closed)
    for side in across:
        sides[side] = resample_edge(edges[side], nj, closed=False)
    return sides


def wake_marks(had: int, wake: int, ni: int) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Return ends of wake, wall and wake among `had` nodes and among `ni`: four node numbers each.

    Raises
    ------
    InputError
        no room for the wall.
    """
    cells = max(round(wake * (ni - 1) / (had - 1)), 1) if wake else 0
    if wake and ni - 1 - 2 * cells < 2:
        raise InputError(f"{ni} nodes along a C boundary with a wake", f"use at least {2 * cells + 3}")
    return (0, wake, had - 1 - wake, had - 1), (0, cells, ni - 1 - cells, ni - 1)


def _in_pieces(side: Floats, ends: tuple[int, ...], places: tuple[int, ...]) -> Floats:
    """Return the nodes of `side`, each stretch between two `ends` resampled to lie between two `places`."""
    pieces = [
        resample_edge(side[a : b + 1], q - p + 1, closed=False)
        for (a, b), (p, q) in zip(pairwise(ends), pairwise(places), strict=True)
    ]
    return np.concatenate([*(piece[:-1] for piece in pieces[:-1]), pieces[-1]])


def resample_patches(
    patches: tuple[Patch, ...], had: tuple[int, int], has: tuple[int, int], wake: int
) -> tuple[Patch, ...]:
    """Return the patches of a boundary that `had` so many nodes along xi and eta and now `has` so many."""
    along_xi = wake_marks(had[0], wake, has[0])
    along_eta = (0, had[1] - 1), (0, has[1] - 1)

    def moved(patch: Patch) -> Patch:
        marks = along_xi if patch.side in ("south", "north") else along_eta
        start, stop = (round(float(np.interp(k, *marks))) for k in (patch.start, patch.stop))
        start = min(start, marks[1][-1] - 1)
        return replace(patch, start=start, stop=max(stop, start + 1))

    return tuple(moved(patch) for patch in patches)
