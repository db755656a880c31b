"""Orientation of surfaces: alike across shared edges, with normals that point out of what they enclose."""

from collections import deque
from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import Floats, distinct
from meshonet.geometry.polygon.corners import Indices

NEARLY_CLOSED = 0.3
"""Vector area over area up to which a surface with holes still counts as one that encloses something."""


def turned_alike(
    patch: Indices, half_edges: tuple[Indices, Indices], twin: Indices, count: int
) -> tuple[list[int], list[int], tuple[int, int] | None]:
    """Return the component of each of `count` patches, its sign (1 or -1), and patches where that fails.

    `patch` (4 m,) is the patch of each half-edge, `half_edges` their first and last nodes. Patches of sign -1
    are to be turned so that all of a component are alike. The third is a pair of patches between which a
    surface has one side only.
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
    """Return 1 if `quads` (m, 4), turned alike, face away from what they enclose, -1 if towards it.

    Open edges in planes normal to an axis of `flat` are closed by these. None where the surface encloses
    nothing: more than `NEARLY_CLOSED` of its area faces one way, or planes normal to two axes would have to
    close it, which a corner of a room and that of a box do alike.
    """
    if len(flat) > 1:
        return None
    a, b, c, d = (nodes[quads[:, k]] for k in range(4))
    area = 0.5 * np.cross(c - a, d - b)
    area[:, list(flat)] = 0.0  # planes close what faces along their axis
    total = area.sum(axis=0)
    if np.sqrt((total**2).sum()) > NEARLY_CLOSED * np.sqrt((area**2).sum(axis=1)).sum():
        return None
    centre = nodes[quads.ravel()].mean(axis=0)
    volume = float((area * (0.25 * (a + b + c + d) - centre)).sum())
    return -1 if volume < 0.0 else 1
