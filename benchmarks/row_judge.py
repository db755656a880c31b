"""A judge of grids of blade rows, written apart from the product in plain NumPy.

All figures come from the nodes of blocks, their connections and patches, and from the row for the surface of
its blade.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from space_judge import first_errors, growth_ratios, judged_cells

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.rows.row import Row

Floats = NDArray[np.float64]
_PICKED = 120  # nodes of the blade whose distance is measured
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
    parts = [judged_cells(block) for block in blocks]
    scaled, angle = (np.concatenate([part[k] for part in parts]) for k in (0, 1))
    folded, opened, bezier = (sum(part[k] for part in parts) for k in (2, 3, 4))
    return Judged(
        sum(int(np.prod(block.shape[:3])) for block in blocks), len(scaled), folded, opened, bezier, scaled,
        angle, first_errors(grid, blocks, WALLS, _heights(row, first)), growth_ratios(grid, blocks),
        _periodic(grid), _off_blade(grid, row) if blade else math.nan,
    )  # fmt: skip


def _heights(row: Row, first: float) -> Floats:
    """Return the heights that first cells may have: in gaps narrower than 17 of them they are lower."""
    gaps = [gap for gap in (row.tip_gap, row.hub_gap) if gap > 0.0]
    return np.array([first, *(gap / 17.0 for gap in gaps if gap / 17.0 < first)])


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
