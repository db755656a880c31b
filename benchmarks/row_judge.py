"""A judge of grids of blade rows, written apart from the product in plain NumPy.

All figures come from the nodes of blocks, their connections and patches, and from the row for the surface of
its blade.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.rows.row import Row

Floats = NDArray[np.float64]
_CHUNK = 60_000  # cells that are judged together
_PICKED = 120  # nodes of the blade whose distance is measured
_SPLITS = 4  # subdivisions of cells whose coefficients leave the sign of the Jacobian open
WALLS = ("blade", "tip", "foot", "hub", "shroud")


@dataclass
class Judged:
    """Figures of a grid."""

    nodes: int
    cells: int
    folded_corners: int
    """Cells with a Jacobian at one of the eight corners that is not positive."""
    open_cells: int
    """Cells with one of the 27 Bezier coefficients of the Jacobian that is not positive."""
    folded_bezier: int
    """Those of them that stay open when they are subdivided."""
    scaled: Floats
    """(cells,) least scaled Jacobian of each."""
    angle: Floats
    """(cells,) largest angle of each in degrees."""
    first: dict[str, float]
    """By wall: largest relative error of first cells."""
    growth: dict[str, Floats]
    """By kind of line: ratios, at least 1, of consecutive edges."""
    periodic: float
    """Largest distance of periodic nodes, after turning, over the radius."""
    blade: float
    """Largest distance of blade nodes from the blade's surface, in chords."""

    @property
    def growths(self) -> Floats:
        """Ratios along all lines."""
        return np.concatenate(list(self.growth.values()))


def judge(grid: Grid, row: Row, first: float, *, blade: bool = True) -> Judged:
    """Return the figures of a grid whose first cells are to be `first` high, or less in narrow gaps.

    Without `blade` the distance from its surface is left out, which takes longest.
    """
    blocks = [np.asarray(block.nodes) for block in grid.blocks]
    parts = [_cells(block) for block in blocks]
    scaled, angle = (np.concatenate([part[k] for part in parts]) for k in (0, 1))
    folded, opened, bezier = (sum(part[k] for part in parts) for k in (2, 3, 4))
    return Judged(
        sum(int(np.prod(block.shape[:3])) for block in blocks), len(scaled), folded, opened, bezier, scaled,
        angle, _first(grid, blocks, row, first), _growth(grid, blocks), _periodic(grid),
        _off_blade(grid, row) if blade else math.nan,
    )  # fmt: skip


def _cells(nodes: Floats) -> tuple[Floats, Floats, int, int, int]:
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


def _first(grid: Grid, blocks: list[Floats], row: Row, first: float) -> dict[str, float]:
    """Return for each wall by how much first cells differ from the height that they are to have."""
    gaps = [gap for gap in (row.tip_gap, row.hub_gap) if gap > 0.0]
    heights = np.array([first, *(gap / 17.0 for gap in gaps if gap / 17.0 < first)])
    worst: dict[str, float] = {}
    for patch in grid.outer_patches():
        if patch.name in WALLS:
            axis, end = patch.place
            rows = np.moveaxis(blocks[patch.block], axis, 0)
            rows = rows if end == 0 else rows[::-1]
            away = np.linalg.norm(rows[1] - rows[0], axis=-1)
            across = patch.across or (0, away.shape[1] - 1)
            own = away[patch.start : patch.stop + 1, across[0] : across[1] + 1]
            off = min(float(np.abs(own / height - 1.0).max()) for height in heights)
            worst[patch.name] = max(worst.get(patch.name, 0.0), off)
    return worst


def _growth(grid: Grid, blocks: list[Floats]) -> dict[str, Floats]:
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


def _periodic(grid: Grid) -> float:
    worst = 0.0
    for each in grid.connections:
        if each.transform:
            one, other = replace(each, transform=None).nodes(grid.face)
            one, other = one.reshape(-1, 3), other.reshape(-1, 3)
            turn = np.array(each.transform.turn)
            moved = (one[:, None, :] * turn).sum(axis=-1)
            radius = np.hypot(other[:, 1], other[:, 2])
            off = np.linalg.norm(moved - other, axis=1) / radius
            if off.max() > 1e-6:  # the motion is that of the other side
                back = (one[:, None, :] * turn.T).sum(axis=-1)
                off = np.linalg.norm(back - other, axis=1) / radius
            worst = max(worst, float(off.max()))
    return worst


def _off_blade(grid: Grid, row: Row) -> float:
    """Return the largest distance of blade nodes from the surface through the profiles, in chords.

    At the height of each node that is the distance from a dense polygon around the blade whose points are on
    the surface, refined by a parabola through the nearest point and its neighbours.
    """
    faces = [grid.at(patch).reshape(-1, 3) for patch in grid.outer_patches() if patch.name == "blade"]
    points = np.concatenate(faces)
    radius, theta = np.hypot(points[:, 1], points[:, 2]), np.arctan2(points[:, 1], points[:, 2])
    _, height = row.channel.places(np.stack([points[:, 0], radius], axis=1))
    dense = 0.5 * (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 600, endpoint=False)))
    u = np.concatenate([0.5 * dense, 0.5 + 0.5 * dense])
    worst = 0.0
    order = np.argsort(height)
    picked = order[:: max(1, len(order) // _PICKED)]
    for k in picked:
        h = float(height[k])
        place, step = _nearest(row, h, u, points[k], float(theta[k]))
        for _ in range(24):  # the range around the best of nine, narrowed to a fourth
            tries = place + step * np.linspace(-1.0, 1.0, 9)
            away = _away(row, h, tries, points[k], float(theta[k]))
            place, step = float(tries[int(away.argmin())]), 0.25 * step
            if step < 1e-11:
                break
        worst = max(worst, float(_away(row, h, np.array([place]), points[k], float(theta[k]))[0]))
    return worst / row.chord


def _nearest(row: Row, h: float, u: Floats, point: Floats, theta: float) -> tuple[float, float]:
    away = _away(row, h, u, point, theta)
    k = int(away.argmin())
    around = np.diff(np.concatenate([u[-1:] - 1.0, u, u[:1] + 1.0]))
    return float(u[k]), float(max(around[k], around[k + 1]))


def _away(row: Row, h: float, u: Floats, point: Floats, theta: float) -> Floats:
    """Return the distances (n,) in space of a point from places u (n,) of the blade at a height."""
    s, angle = row.surface.section(h, np.mod(u, 1.0)).T
    x_r = row.channel.at(s, np.full(len(s), h))
    angle = angle - row.pitch * np.round((angle - theta) / row.pitch) if row.blades > 1 else angle
    turned = angle + 2.0 * math.pi * np.round((theta - angle) / (2.0 * math.pi))
    place = np.stack([x_r[:, 0], x_r[:, 1] * np.sin(turned), x_r[:, 1] * np.cos(turned)], axis=1)
    return np.linalg.norm(place - point, axis=1)


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
