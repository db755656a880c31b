"""Parts of a surface that do not touch, whose grids might overlap."""

from itertools import combinations

import numpy as np

from meshonet.geometry.arrays import Floats, Indices
from meshonet.geometry.errors import InputError
from meshonet.geometry.surface.surface import Surface

_SAMPLES = 2000  # nodes of a part, evenly drawn, by which its distance from others is measured


def check_parts(surface: Surface, far: float) -> None:
    """Raise InputError if the grids of two parts of a surface, marched to `far`, would overlap."""
    for a, b in combinations(_parts(surface), 2):
        gap = _distance(surface.nodes[a], surface.nodes[b])
        if gap < 2.0 * far:
            places = f"at {surface.place(int(a[0]))} and {surface.place(int(b[0]))}"
            problem = f"parts of the surface, {places}, are {gap:.4g} apart: their grids would overlap"
            remedy = f"give one of them, or a {{far_field}} below {0.5 * gap:.4g}"
            raise InputError(problem, remedy)


def _parts(surface: Surface) -> list[Indices]:
    parts: list[Indices] = []
    for lattice in surface.lattices:
        nodes = np.unique(lattice)
        touched = [part for part in parts if np.isin(nodes, part).any()]
        parts = [part for part in parts if not any(part is other for other in touched)]
        parts.append(np.unique(np.concatenate([nodes, *touched])))
    return parts


def _distance(a: Floats, b: Floats) -> float:
    """Return about the smallest distance between points (n, 3) and (m, 3)."""
    a, b = (points[:: 1 + len(points) // _SAMPLES] for points in (a, b))
    return float(np.sqrt(min(((b - point) ** 2).sum(axis=1).min() for point in a)))
