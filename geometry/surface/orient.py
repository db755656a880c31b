"""Orientation of surfaces: consistent across shared edges, with outward normals."""

from collections import deque
from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import Floats, distinct
from meshonet.geometry.polygon.corners import Indices

NEARLY_CLOSED = 0.3
"""Vector area over area up to which a surface with holes still counts as one that encloses something."""

SMALL_HOLES = 0.02
"""The same where planes normal to several axes could close it."""


def turned_alike(
    patch: Indices, half_edges: tuple[Indices, Indices], twin: Indices, count: int
) -> tuple[list[int], list[int], tuple[int, int] | None]:
    """Return the component of each of `count` patches, its sign (1 or -1), and a pair of patches or None.

    `patch` (4 m,) is the patch of each half-edge, `half_edges` are its first and last nodes. Reversing the
    patches with sign -1 makes all patches of a component consistent. The pair, if any, is one between which
    that fails: the surface is not orientable.
    """
    first, _ = half_edges
    edges = np.flatnonzero(twin > np.arange(len(twin)))
    across = twin[edges]
    alike = first[edges] != first[across]
    links = distinct((patch[edges] * count + patch[across]) * 2 + alike)
    near: list[list[tuple[int, int]]] = [[] for _ in range(count)]
    for link in links.tolist():
        (a, b), sign = divmod(link // 2, count), 1 if link % 2 else -1
        near[a].append((b, sign))
        near[b].append((a, sign))
    component, signs, parts = [-1] * count, [1] * count, 0
    for seed in range(count):
        if component[seed] >= 0:
            continue
        component[seed] = parts
        queue = deque([seed])
        while queue:
            a = queue.popleft()
            for b, sign in sorted(near[a]):
                if component[b] < 0:
                    component[b], signs[b] = parts, signs[a] * sign
                    queue.append(b)
                elif signs[b] != signs[a] * sign:
                    return component, signs, (a, b)
        parts += 1
    return component, signs, None


def outward_sign(nodes: Floats, quads: Indices, flat: Sequence[int]) -> int | None:
    """Return 1 if consistently oriented `quads` (m, 4) face outwards, -1 if they face inwards.

    Open edges in planes normal to an axis of `flat` are closed by these planes. None if the surface does not
    enclose a volume: more than `NEARLY_CLOSED` of its area faces one way. Planes normal to two axes would
    close both the inside and the outside of a box corner; there, those of one axis must leave holes of less
    than `SMALL_HOLES` of the area, as half a fuselage does that is open at its end.
    """
    a, b, c, d = (nodes[quads[:, k]] for k in range(4))
    area = 0.5 * np.cross(c - a, d - b)
    arms = 0.25 * (a + b + c + d) - nodes[quads.ravel()].mean(axis=0)
    most = NEARLY_CLOSED if len(flat) < 2 else SMALL_HOLES
    signs = {_sign(area, arms, axis, most) for axis in flat or (None,)} - {None}
    return signs.pop() if len(signs) == 1 else None


def _sign(area: Floats, arms: Floats, flat: int | None, most: float) -> int | None:
    """Return the sign of the volume within faces of vector `area` (m, 3) at `arms` from its centre.

    None if more than `most` of the area, without what faces along the axis `flat`, faces one way.
    """
    if flat is not None:
        area = area.copy()
        area[:, flat] = 0.0  # planes close what faces along their axis
    total = area.sum(axis=0)
    if np.sqrt((total**2).sum()) > most * np.sqrt((area**2).sum(axis=1)).sum():
        return None
    return -1 if float((area * arms).sum()) < 0.0 else 1
