"""Slices of volumes: grid surfaces of constant index, ``k=0``, and sections by a plane, ``x=.5``."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError

_SPEC = re.compile(r"\s*([ijkxyz])\s*=\s*([-+.\w]+)\s*", re.ASCII)  # a slice as text: direction and number
_MOST = 12  # number of edges of a cell, the largest number of corners of a polygon


@dataclass(frozen=True)
class Slice:
    """A slice of a volume: a direction (0, 1, 2) and either a node index or a coordinate along it."""

    direction: int
    index: int | None = None
    coordinate: float = 0.0

    def __str__(self) -> str:
        if self.index is None:
            return f"{'xyz'[self.direction]} = {self.coordinate:g}"
        return f"{'ijk'[self.direction]} = {self.index}"


def parse_slice(text: str) -> Slice:
    """Return the slice in a text such as ``i=10``, ``k=-1`` or ``x=.5``. Raises InputError: other text."""
    match = _SPEC.fullmatch(text)
    try:
        if match and match[1] in "ijk":
            return Slice("ijk".index(match[1]), index=int(match[2]))
        coordinate = float(match[2]) if match else math.nan
    except ValueError:
        coordinate = math.nan
    if match is None or not math.isfinite(coordinate):
        remedy = "use i, j or k and an index, or x, y or z and a coordinate: k=0, i=-1, x=.5"
        raise InputError(f"{text!r} is no slice", remedy, parameter="slice")
    return Slice("xyz".index(match[1]), coordinate=coordinate)


@dataclass(frozen=True, eq=False)
class CellSheet:
    """A surface of cells in space: nodes (n, m, 3) and optional cell values (n-1, m-1).

    `outside` is 1 if the cross product of its first and second direction points into the flow, -1 if it
    points out of the flow, and 0 if this is unknown.
    """

    nodes: Floats
    values: Floats | None
    outside: int = 0


def layers(grid: Grid, at: Slice, values: list[Floats] | None) -> list[CellSheet]:
    """Return the surface of constant index that `at` selects, such as k = 0, in each block with this index.

    The surface has the values of the adjacent cells. Raises InputError if no block has the index.
    """
    index = at.index or 0
    sheets = []
    for number, block in enumerate(grid.blocks):
        count = block.counts[at.direction]
        if not -count <= index < count:
            continue
        node = index % count
        nodes = np.moveaxis(block.nodes, at.direction, 0)[node]
        beside = np.moveaxis(values[number], at.direction, 0)[min(node, count - 2)] if values else None
        sheets.append(CellSheet(nodes, beside))
    if not sheets:
        most = max(block.counts[at.direction] for block in grid.blocks)
        remedy = f"use 0 to {most - 1}, or -1 for the last"
        raise InputError(f"no block has {at}", remedy, parameter="slice")
    return sheets


@dataclass(frozen=True, eq=False)
class Cut:
    """Section through n cells: a polygon in each, and the cell values (n,).

    `polygons` is (n, 12, 2). A polygon with fewer than 12 corners repeats its last corner.
    """

    polygons: Floats
    values: Floats | None


def cut(grid: Grid, at: Slice, values: list[Floats] | None) -> Cut:
    """Return the cells cut by a plane of constant coordinate. Raises InputError if it cuts none."""
    nodes = [block.nodes for block in grid.blocks]
    distances = [each[..., at.direction] - at.coordinate for each in nodes]
    flat = [np.delete(each, at.direction, axis=-1) for each in nodes]
    made = cut_where(distances, flat, values)
    if not len(made.polygons):  # nodes on the plane count as above it: it may be the lower boundary
        made = cut_where([-each for each in distances], flat, values)
    if not len(made.polygons):
        low, high = (float(corner[at.direction]) for corner in grid.box)
        problem = f"the plane {at} cuts no cell"
        remedy = f"the grid is from {'xyz'[at.direction]} = {low:.6g} to {high:.6g}"
        raise InputError(problem, remedy, parameter="slice")
    return made


def cut_where(distances: Sequence[Floats], flat: Sequence[Floats], values: list[Floats] | None) -> Cut:
    """Return the polygons in which a surface cuts the cells of all blocks.

    Parameters
    ----------
    distances : for each block, the signed distances (ni, nj, nk) of its nodes from the surface.
    flat : for each block, the picture coordinates (ni, nj, nk, 2) of its nodes.
    values : for each block, its cell values.
    """
    polygons, shown = [], []
    for number, (distance, plane) in enumerate(zip(distances, flat, strict=True)):
        cells = _crossed(distance)
        at = [tuple((cells + corner).T) for corner in _CORNERS]
        corners = (np.stack([each[place] for place in at], axis=1) for each in (distance, plane))
        polygons.append(_polygons(*corners))
        if values:
            shown.append(values[number][tuple(cells.T)])
    return Cut(np.concatenate(polygons), np.concatenate(shown) if values else None)


_CORNERS = np.array(list(product((0, 1), repeat=3)))  # corners of a cell as offsets along i, j and k
_EDGES = np.array([(a, b) for a in range(8) for b in range(a) if bin(a ^ b).count("1") == 1])
"""Pairs of corners that are joined by an edge."""


def _crossed(distance: Floats) -> NDArray[np.intp]:
    """Return indices (n, 3) of cells with signed distances (ni, nj, nk) of both signs."""
    low = high = distance >= 0
    for axis in range(3):
        first, last = (slice(None),) * axis + (slice(-1),), (slice(None),) * axis + (slice(1, None),)
        low, high = low[first] & low[last], high[first] | high[last]
    return np.argwhere(high & ~low)


def _polygons(distance: Floats, plane: Floats) -> Floats:
    """Return polygons (n, 12, 2) from distances (n, 8) and picture coordinates (n, 8, 2) of corners."""
    a, b = _EDGES.T
    part = np.divide(
        distance[:, a], distance[:, a] - distance[:, b],
        out=np.full((len(distance), _MOST), np.nan), where=(distance[:, a] >= 0) != (distance[:, b] >= 0),
    )  # fmt: skip
    points = plane[:, a] + part[..., None] * (plane[:, b] - plane[:, a])
    middle = np.nanmean(points, axis=1, keepdims=True) if len(points) else points[:, :1]
    around = np.arctan2(*np.moveaxis(points - middle, -1, 0)[::-1])
    order = np.argsort(around, axis=1, kind="stable")  # what is not cut comes last
    points = np.take_along_axis(points, order[..., None], axis=1)
    count = np.isfinite(part).sum(axis=1)
    last = np.minimum(np.arange(_MOST), count[:, None] - 1)
    return np.take_along_axis(points, last[..., None], axis=1)
