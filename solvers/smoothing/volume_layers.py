"""Restores the heights of layers at the outer sides of volumes, as `meshonet.solvers.smoothing.layers`."""

import math
from dataclasses import dataclass, replace

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, norms
from meshonet.geometry.blocks.block import PLACES
from meshonet.geometry.elementary import exp, log
from meshonet.geometry.volume.hex_mesh import HexMesh
from meshonet.solvers.energy.hex_tables import Targets

THIN = 3.0  # ratio of the shorter of the other sides to the height above which a cell belongs to layers
_LOW = 3.0
"""Ratio of the mean height along a line to that of its first cell above which this cell belongs to layers."""
_UNLIKE = math.log(1.5)  # largest logarithm of a height over its target that is not an error of the grid
_ROOM = 0.9  # largest fraction of a line, up to its last interior node, that layers may take


@dataclass(frozen=True, eq=False)
class VolumeLayers:
    """Lines from an outer side into the volume, with their layers of thin cells."""

    lines: Indices  # (m, n) node indices; the first node is on the side
    rows: Indices  # (m,) number of thin cells of each line
    heights: Floats  # (m, n - 1) target lengths of the edges


def layers_of(mesh: HexMesh, moves: Bools, targets: Targets) -> list[VolumeLayers]:
    """Return the layers of thin cells at outer sides of a mesh; the mask `moves` (n,) marks free nodes."""
    layers = []
    for number, (block, wanted) in enumerate(zip(mesh.blocks, targets, strict=True)):
        for side, (axis, end) in PLACES.items():
            free = mesh.free_cells(number, side)
            if not free.any() or block.shape[axis] < 4:
                continue
            way = slice(None, None, -1 if end else 1)
            lattice = np.moveaxis(block, axis, 0)[way]
            logs = [np.moveaxis(each, axis, 0)[way] for each in wanted]
            edges = [logs[axis][1:-1], *(_own(logs[d], d, axis) for d in range(3) if d != axis)]
            rows = _rows(edges, free)
            rows[~moves[lattice[1]]] = 0
            rows = np.minimum(rows, len(lattice) - 3).ravel()
            if rows.any():
                at = np.flatnonzero(rows)
                lines = lattice.reshape(len(lattice), -1)[:, at].T
                heights = _heights(mesh.nodes[lines], edges[0].reshape(len(lattice) - 1, -1)[:, at].T)
                layers.append(VolumeLayers(lines, rows[at], heights))
    return _of_one_foot(layers, len(mesh.nodes))


def _own(logs: Floats, direction: int, axis: int) -> Floats:
    """Return the edges along a direction without those beyond the block; the first index is along `axis`."""
    place = direction + 1 if direction < axis else direction
    return np.moveaxis(np.moveaxis(logs, place, 0)[1:-1], 0, place)


def _rows(logs: list[Floats], free: Bools) -> Indices:
    """Return the number of thin rows from a side on at each of its nodes (n, m)."""
    height, first, second = logs
    mean = 0.25 * (height[:, 1:, 1:] + height[:, 1:, :-1] + height[:, :-1, 1:] + height[:, :-1, :-1])
    low = exp(mean).mean(axis=0) > _LOW * exp(mean[0])
    wide = [0.25 * (each[1:, ...] + each[:-1, ...]) for each in (first, second)]
    along = wide[0][:, :, 1:] + wide[0][:, :, :-1], wide[1][:, 1:] + wide[1][:, :-1]
    thin = (np.minimum(*along) - mean > math.log(THIN)) & free
    count = np.maximum(np.logical_and.accumulate(thin, axis=0).sum(axis=0), low & free)
    rows = np.full([n + 1 for n in count.shape], np.iinfo(np.intp).max)
    for i, j in np.ndindex(2, 2):
        part = rows[i : i + count.shape[0], j : j + count.shape[1]]
        np.minimum(part, np.where(free, count, np.iinfo(np.intp).max), out=part)
    rows[rows == np.iinfo(np.intp).max] = 0
    return rows


def _heights(points: Floats, logs: Floats) -> Floats:
    """Return the lengths (m, n-1) along lines (m, n, 3), or the targets where these differ too much."""
    steps = np.diff(points, axis=1)
    squares = (steps**2).sum(axis=-1)
    own = 0.5 * log(np.maximum(squares, 1e-300))
    return np.where(np.abs(own - logs) < _UNLIKE, np.sqrt(squares), exp(logs))


def _of_one_foot(layers: list[VolumeLayers], count: int) -> list[VolumeLayers]:
    """Return layers that end before nodes that belong to lines from more than one outer node."""
    low, high = np.full(count, count), np.full(count, -1)
    for each in layers:
        for row in range(int(each.rows.max())):
            at = each.lines[each.rows > row]
            np.minimum.at(low, at[:, row + 1], at[:, 0])
            np.maximum.at(high, at[:, row + 1], at[:, 0])
    alone = low >= high
    rows = [np.logical_and.accumulate(alone[each.lines[:, 1:]], axis=1).sum(axis=1) for each in layers]
    return [replace(each, rows=np.minimum(each.rows, most)) for each, most in zip(layers, rows, strict=True)]


def with_layers(nodes: Floats, layers: list[VolumeLayers]) -> tuple[Floats, Bools]:
    """Return `nodes` (n, 3) with layers at their target heights, and a mask (n,) of the nodes in layers."""
    moved, held = nodes.copy(), np.zeros(len(nodes), dtype=bool)
    for each in layers:
        points = nodes[each.lines]
        steps = np.diff(points, axis=1)
        place = np.cumsum(norms(steps), axis=1)
        wanted = np.cumsum(each.heights, axis=1)
        rows = np.where(wanted[np.arange(len(wanted)), each.rows - 1] < _ROOM * place[:, -2], each.rows, 0)
        for row in range(int(rows.max(initial=0))):
            at = np.flatnonzero(rows > row)
            moved[each.lines[at, row + 1]] = _at(points[at], place[at], wanted[at, row])
            held[each.lines[at, row + 1]] = True
        at = np.flatnonzero(rows > 0)
        moved = with_first_heights(moved, each.lines[at, :2], each.heights[at, 0])
    return moved, held


def _at(points: Floats, place: Floats, wanted: Floats) -> Floats:
    """Return the points (m, 3) at arc lengths (m,) on lines (m, n, 3) with arc lengths `place` (m, n-1)."""
    k = np.minimum((place < wanted[:, None]).sum(axis=1), place.shape[1] - 1)
    line = np.arange(len(points))
    before = np.where(k > 0, place[line, k - 1], 0.0)
    part = (wanted - before) / np.maximum(place[line, k] - before, 1e-300)
    return np.asarray(points[line, k] + part[:, None] * (points[line, k + 1] - points[line, k]))


def with_first_heights(nodes: Floats, edges: Indices, heights: Floats) -> Floats:
    """Return `nodes` (n, 3), with `edges` (m, 2) made `heights` (m,) long by moving their second nodes."""
    foot = nodes[edges[:, 0]]
    way = nodes[edges[:, 1]] - foot
    moved = nodes.copy()
    moved[edges[:, 1]] = foot + way * (heights / np.maximum(norms(way), 1e-300))[:, None]
    return moved
