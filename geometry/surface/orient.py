"""Orientation of surfaces: consistent across shared edges, with outward normals."""

from collections import deque
from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, distinct, extent_of
from meshonet.geometry.surface.planes import FLAT, Plane, edges_in

NEARLY_CLOSED = 0.3  # largest ratio of vector area to area of a surface with holes that encloses a volume
_HOLE = 0.1  # largest extent of open edges that are the rim of a hole, divided by the extent of the surface


def turned_alike(
    patch: Indices, half_edges: tuple[Indices, Indices], twin: Indices, count: int
) -> tuple[list[int], list[int], tuple[int, int] | None]:
    """Return which patches to reverse so that each connected part of a surface has one orientation.

    The first list says for each of `count` patches to which connected part it belongs. The second has -1 for
    patches to be reversed, else 1. The third result is None, or a pair of patches if no orientation exists.
    `patch` (4 m,) is the patch of each half-edge, `half_edges` its first and last node, `twin` its opposite.
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


def closing_axes(nodes: Floats, sides: Indices, planes: Sequence[Plane]) -> list[int]:
    """Return the directions (0, 1, 2 for x, y, z) of the normals of those `planes` that close a surface.

    `sides` is the result of `open_sides`. Only one direction is returned if its planes contain all open
    edges except the rim of a small hole, such as the open tail of half a fuselage.
    """
    axes = sorted({plane.axis for plane in planes})
    slack = FLAT * extent_of(nodes)
    for axis in axes if len(axes) > 1 else ():
        own = [edges_in(nodes, sides, plane, slack) for plane in planes if plane.axis == axis]
        others = nodes[sides[~np.any(own, axis=0), :2]].reshape(-1, 3)
        if extent_of(others) < _HOLE * extent_of(nodes):
            return [axis]
    return axes


def outward_sign(nodes: Floats, quads: Indices, flat: Sequence[int]) -> int | None:
    """Return 1 if consistently oriented `quads` (m, 4) face outwards, -1 if inwards; None if undefined.

    Planes normal to the axes `flat` close the surface. The sign is undefined if the vector sum of areas shows
    that no volume is enclosed, or if `flat` has more than one axis.
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
