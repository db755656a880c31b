"""A judge of grids of blocks in space, written apart from the product in plain NumPy.

Figures come from the nodes of blocks, their connections and patches.
"""

import itertools
from collections.abc import Collection, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.blocks.grid import Grid

Floats = NDArray[np.float64]
_CHUNK = 60_000  # cells that are judged together
_SPLITS = 4  # subdivisions of cells whose coefficients leave the sign of the Jacobian open


def judged_cells(nodes: Floats) -> tuple[Floats, Floats, int, int, int]:
    """Return scaled Jacobians and largest angles of cells, and how many are folded by each test."""
    corner = np.stack(
        [
            nodes[a : a + nodes.shape[0] - 1, b : b + nodes.shape[1] - 1, c : c + nodes.shape[2] - 1]
            for a, b, c in itertools.product((0, 1), repeat=3)
        ],
        axis=3,
    ).reshape(-1, 2, 2, 2, 3)
    scaled, angle = np.empty(len(corner)), np.empty(len(corner))
    folded = opened = bezier = 0
    for start in range(0, len(corner), _CHUNK):
        own = slice(start, start + _CHUNK)
        part = corner[own]
        scaled[own], angle[own], least = _corners(part)
        folded += int((least <= 0.0).sum())
        maybe = part[(_coefficients(part) <= 0.0).any(axis=1)]
        opened += len(maybe)
        bezier += sum(not _positive(cell, _SPLITS) for cell in maybe)
    return scaled, angle, folded, opened, bezier


def _corners(cells: Floats) -> tuple[Floats, Floats, Floats]:
    """Return least scaled Jacobian, largest angle and least Jacobian (n,) of cells (n, 2, 2, 2, 3)."""
    scaled, least = np.full(len(cells), np.inf), np.full(len(cells), np.inf)
    cosine = np.full(len(cells), np.inf)
    for a, b, c in itertools.product((0, 1), repeat=3):
        here = cells[:, a, b, c]
        u, v, w = cells[:, 1 - a, b, c] - here, cells[:, a, 1 - b, c] - here, cells[:, a, b, 1 - c] - here
        lengths = [np.sqrt((e * e).sum(axis=1)) for e in (u, v, w)]
        volume = (np.cross(u, v) * w).sum(axis=1) * (-1.0) ** (a + b + c)
        least = np.minimum(least, volume)
        scaled = np.minimum(scaled, volume / (lengths[0] * lengths[1] * lengths[2]))
        for (e, le), (f, lf) in itertools.combinations(zip((u, v, w), lengths, strict=True), 2):
            cosine = np.minimum(cosine, (e * f).sum(axis=1) / (le * lf))
    return scaled, np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))), least


def _coefficients(cells: Floats) -> Floats:
    """Return the 27 Bezier coefficients (n, 27) of the Jacobians of trilinear cells (n, 2, 2, 2, 3)."""
    u, v, w = cells[:, 1] - cells[:, 0], cells[:, :, 1] - cells[:, :, 0], cells[..., 1, :] - cells[..., 0, :]
    total = np.zeros((len(cells), 3, 3, 3))
    two = tuple(itertools.product((0, 1), repeat=2))
    for (b, c), (a, d) in itertools.product(two, two):
        cross = np.cross(u[:, b, c], v[:, a, d])
        for e, f in two:
            total[:, a + e, b + f, c + d] += (cross * w[:, e, f]).sum(axis=1)
    binomial = np.array([1.0, 2.0, 1.0])
    weight = binomial[:, None, None] * binomial[:, None] * binomial
    return (total / weight).reshape(len(cells), 27)


def _positive(cell: Floats, splits: int) -> bool:
    """Return whether the Jacobian of a cell (2, 2, 2, 3) is shown to be positive by subdivision."""
    if (_coefficients(cell[None]) > 0.0).all():
        return True
    if not splits or _corners(cell[None])[2][0] <= 0.0:
        return False
    fine = cell
    for axis in range(3):
        low, high = np.take(fine, range(fine.shape[axis] - 1), axis), np.take(fine, [-1], axis)
        middle = 0.5 * (low + np.take(fine, range(1, fine.shape[axis]), axis))
        fine = np.concatenate([low, middle, high], axis=axis)
    halves = itertools.product((0, 1), repeat=3)
    return all(_positive(fine[a : a + 2, b : b + 2, c : c + 2], splits - 1) for a, b, c in halves)


def first_errors(
    grid: Grid, blocks: list[Floats], walls: Collection[str], heights: Floats
) -> dict[str, float]:
    """Return for each wall by how much first cells differ from the nearest of `heights` that fits a patch."""
    worst: dict[str, float] = {}
    for patch, rows in _on_walls(grid, blocks, walls):
        away = np.linalg.norm(rows[1] - rows[0], axis=-1)
        off = min(float(np.abs(away / height - 1.0).max()) for height in heights)
        worst[patch] = max(worst.get(patch, 0.0), off)
    return worst


def off_normals(grid: Grid, blocks: list[Floats], walls: Collection[str]) -> Floats:
    """Return angles (n,) in degrees of the first edges of lines with the normals of the walls they leave.

    The normal of a node is the mean of those of the faces of its wall around it, also in other blocks, and
    has no part across the plane of symmetry z = 0.
    """
    nodes: dict[str, list[Floats]] = {}
    lines: dict[str, list[Floats]] = {}
    areas: dict[str, list[Floats]] = {}
    for name, rows in _on_walls(grid, blocks, walls):
        wall, line = rows[0], rows[1] - rows[0]
        area = 0.5 * np.cross(wall[1:, 1:] - wall[:-1, :-1], wall[:-1, 1:] - wall[1:, :-1])
        middle = line[1:, 1:] + line[:-1, :-1] + line[:-1, 1:] + line[1:, :-1]
        area *= np.sign((area * middle).sum(axis=-1))[..., None]
        total = np.zeros_like(wall)
        for a, b in itertools.product((slice(None, -1), slice(1, None)), repeat=2):
            total[a, b] += area
        for table, values in ((nodes, wall), (lines, line), (areas, total)):
            table.setdefault(name, []).append(values.reshape(-1, 3))
    return np.concatenate(
        [_angles(*(np.concatenate(t[name]) for t in (nodes, lines, areas))) for name in nodes]
    )


def _angles(nodes: Floats, lines: Floats, areas: Floats) -> Floats:
    places, at = np.unique(nodes, axis=0, return_inverse=True)
    normal = np.stack([np.bincount(at.ravel(), areas[:, k], len(places)) for k in range(3)], axis=1)
    normal[places[:, 2] == 0.0, 2] = 0.0
    normal = normal[at.ravel()]
    cosine = (normal * lines).sum(axis=1) / np.linalg.norm(normal, axis=1) / np.linalg.norm(lines, axis=1)
    return np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))


def _on_walls(grid: Grid, blocks: list[Floats], walls: Collection[str]) -> Iterator[tuple[str, Floats]]:
    """Yield the name of each patch on a wall, and its nodes (rows, m, n, 3), row by row away from it."""
    for patch in grid.outer_patches():
        if patch.name in walls:
            axis, end = patch.place
            rows = np.moveaxis(blocks[patch.block], axis, 0)
            rows = rows if end == 0 else rows[::-1]
            across = patch.across or (0, rows.shape[2] - 1)
            yield patch.name, rows[:, patch.start : patch.stop + 1, across[0] : across[1] + 1]


def growth_ratios(grid: Grid, blocks: list[Floats]) -> dict[str, Floats]:
    """Return ratios of consecutive edges: along i and j in the blocks, along the span, and across sides."""
    ratios: dict[str, list[Floats]] = {"i": [], "j": [], "span": [], "sides": [], "periodic": []}
    for nodes in blocks:
        for axis, name in enumerate(("i", "j", "span")):
            steps = np.linalg.norm(np.diff(nodes, axis=axis), axis=-1)
            steps = np.moveaxis(steps, axis, 0)
            ratios[name].append((steps[1:] / steps[:-1]).ravel())

    def edges(block: int, side: str) -> Floats:
        nodes = blocks[block]
        axis = {"west": 0, "east": 0, "south": 1, "north": 1, "bottom": 2, "top": 2}[side]
        rows = np.moveaxis(nodes, axis, 0)
        one, two = (0, 1) if side in ("west", "south", "bottom") else (-1, -2)
        return np.linalg.norm(rows[two] - rows[one], axis=-1)[..., None]

    for each in grid.connections:
        one, other = replace(each, transform=None).nodes(edges)
        name = "span" if each.side in ("bottom", "top") else "periodic" if each.transform else "sides"
        ratios[name].append((other / one).ravel())
    out = {name: np.concatenate(values) if values else np.empty(0) for name, values in ratios.items()}
    return {name: np.maximum(values, 1.0 / values) for name, values in out.items()}


def worst_growth(grid: Grid, count: int = 10) -> list[str]:
    """Return where growth inside blocks is largest: ratio, block, line, node; for a look at a grid."""
    lines = []
    for number, block in enumerate(grid.blocks):
        nodes = np.asarray(block.nodes)
        for axis in range(3):
            steps = np.linalg.norm(np.diff(nodes, axis=axis), axis=-1)
            steps = np.moveaxis(steps, axis, 0)
            ratio = steps[1:] / steps[:-1]
            ratio = np.maximum(ratio, 1.0 / ratio)
            at = np.unravel_index(int(ratio.argmax()), ratio.shape)
            many = float((ratio > 1.25).mean())
            lines.append(
                (
                    float(ratio.max()),
                    f"block {number} {nodes.shape[:3]} along {'ijk'[axis]}: "
                    f"{ratio.max():.2f} at {tuple(map(int, at))}, {100 * many:.2f} % over 1.25",
                )
            )
    return [text for _, text in sorted(lines, reverse=True)[:count]]
