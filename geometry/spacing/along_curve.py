"""Nodes along a stretch of a curve by a given spacing, with the curve's corners on nodes."""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.curves.monotone import monotone_cubic
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.laws import LAWS, Spacing

MANY = 64  # corners beyond this number, and beyond a quarter of the cells, are facets that need not be nodes


def stretch_arcs(
    curve: Curve,
    begin: float,
    end: float,
    cells: int,
    spacing: Spacing,
    *,
    forward: bool = True,
    step: int = 1,
) -> Floats:
    """Return arc lengths (cells + 1,) of nodes on a closed curve from `begin` to `end`; once around if equal.

    Unless `forward`, nodes run against the curve. With the spacing ``tanh``, end cells have a quarter of the
    mean length. The spacings ``auto`` and ``conformal`` give equal steps. The indices of nodes at corners are
    multiples of `step` if there are enough nodes.
    """
    sign = 1.0 if forward else -1.0
    length = (sign * (end - begin)) % curve.length or curve.length
    q, place = np.linspace(0.0, 1.0, cells + 1), LAWS[spacing].place
    if spacing == "curvature":
        from meshonet.geometry.spacing.size_field import distances_by_curvature

        distance = distances_by_curvature(curve, begin, sign * length, cells)
    elif spacing == "tanh" and cells > 3:
        from meshonet.geometry.spacing.tanh_law import TanhLaw

        distance = length * TanhLaw.fitted(cells, 0.25 / cells, 0.25 / cells)(q)
    else:
        distance = length * (place(q) if place else q)
    corners = np.sort((sign * (curve.corners - begin)) % curve.length)
    tiny = 1e-12 * curve.length
    corners = corners[(corners > tiny) & (corners < length - tiny)]
    if len(corners) <= max(MANY, cells // 4):
        distance = on_corners(distance, corners, step=step)
    return begin + sign * distance


def on_corners(distance: Floats, corners: Floats, fixed: tuple[int, ...] = (), step: int = 1) -> Floats:
    """Return the `distance` (n,) of nodes along a curve, after a change that puts nodes at `corners` (m,).

    Each corner takes the nearest node whose index is a multiple of `step`, or any node if these are too few.
    The first, the last and the nodes with indices `fixed` stay. Raises InputError: more corners than nodes.
    """
    if corners.size == 0:
        return distance
    last = len(distance) - 1
    index = np.arange(last + 1.0)
    place = np.interp(corners, distance, index)
    stays = sorted({0, last, *fixed})
    node = _nearest(place, stays, step)
    if node is None and step > 1:
        node = _nearest(place, stays, 1)
    if node is None:
        raise InputError(f"{len(corners)} corners do not fit on {last + 1} nodes", "use more nodes")
    kept = np.concatenate([np.array(stays, dtype=np.float64), node])
    order = np.argsort(kept, kind="stable")
    source = np.concatenate([np.array(stays, dtype=np.float64), place])
    out = monotone_cubic(index, distance, np.interp(index, kept[order], source[order]))
    out[node] = corners
    out[stays] = distance[stays]
    return out


def _nearest(place: Floats, stays: list[int], step: int) -> NDArray[np.intp] | None:
    """Return different nodes (m,) near places (m,): multiples of `step` other than those that stay."""
    node = np.rint(place / step).astype(np.intp)
    for low, high in pairwise(stays):
        mine = np.flatnonzero((place > low) & (place < high))
        first, last = low // step + 1, (high - 1) // step
        if len(mine) > last - first + 1:
            return None
        rank = np.arange(len(mine))
        node[mine] = np.maximum.accumulate(np.maximum(node[mine], first) - rank) + rank
        back = np.minimum(node[mine], last)[::-1] + rank
        node[mine] = (np.minimum.accumulate(back) - rank)[::-1]
    return node * step
