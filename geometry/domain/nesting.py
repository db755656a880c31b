"""Nesting of closed curves: which are outer loops, and which are holes in each."""

from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.polygon.area import contains, polygon_area


def nested(polygons: Sequence[Floats]) -> list[tuple[int, list[int]]]:
    """Return, for each outer polygon, its index and the indices of its holes, in the order of `polygons`.

    A polygon inside a hole is an outer polygon. Three points of a polygon are tested; if at least two are
    inside another polygon, so is the polygon.

    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> nested([square + 1.0, 4.0 * square, square + 2.5])
    [(1, [0, 2])]
    """
    areas = [abs(polygon_area(polygon)) for polygon in polygons]
    boxes = [(polygon.min(axis=0), polygon.max(axis=0)) for polygon in polygons]
    parent: list[int | None] = []
    for k, polygon in enumerate(polygons):
        around = [
            j
            for j in range(len(polygons))
            if areas[j] > areas[k]
            and (boxes[k][0] >= boxes[j][0]).all()
            and (boxes[k][1] <= boxes[j][1]).all()
            and _inside(polygon, polygons[j])
        ]
        parent.append(min(around, key=lambda j: areas[j], default=None))

    def depth(k: int) -> int:
        up = parent[k]
        return 0 if up is None else 1 + depth(up)

    outer = [k for k in range(len(polygons)) if depth(k) % 2 == 0]
    return [(k, [j for j in range(len(polygons)) if parent[j] == k]) for k in outer]


def _inside(polygon: Floats, around: Floats) -> bool:
    """Return whether most of three points of a polygon lie inside another polygon."""
    places = np.linspace(0, len(polygon), 3, endpoint=False).astype(int)
    return int(contains(around, polygon[places]).sum()) >= 2
