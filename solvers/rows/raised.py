"""Layers that rise or fall from the blade next to a narrow gap, so that their first cells lean less.

Lines off the blade lie in surfaces of revolution; if it leans far over these, narrow cells would be skewed.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, dots, norms, smooth_step
from meshonet.geometry.rows.row import Row
from meshonet.solvers.rows.exact_cells import exact_in_corners
from meshonet.solvers.rows.span_lines import SpanLines
from meshonet.solvers.rows.zones import Zone

LEAN = 1.5
"""Largest tangent between first cells and the blade's normal at narrow gaps, 0.4 of OpenFOAM's skewness."""
NARROW = 0.4  # cells along the span next to a gap, in first cells of the blade, below which layers rise
_MOST = 0.12  # largest move of nodes, as a fraction of the width of the gap
_DEEP, _PART = 2.0, 0.25  # how far nodes move below the blade's end: in gap widths, and at most in spans
_STEP = 1e-5  # steps of u and of the height from which tangents of the blade are computed


@dataclass(frozen=True, eq=False)
class Rise:
    """Displacements of nodes in the blade's wall layers, near a gap between blade and hub or casing."""

    end: float  # height at which the blade ends
    up: float  # 1 if the gap is above it, -1 below
    gap: float  # height of the gap
    deep: Floats  # (k,) height below the end at which displacements of each column become 0
    moves: Floats  # (k, 3) displacement in space of the node of each column at the end

    @classmethod
    def of(cls, row: Row, zone: Zone, blade: Zone, around: SpanLines, lines: SpanLines) -> Self:
        """Return displacements, along the span, of nodes in the blade's wall layers next to a gap.

        Parameters
        ----------
        row, zone, blade : the row, and the height ranges (zones) of the gap and of the blade.
        around : places (0 to 1 around the blade) where k grid lines leave it, as functions of the height.
        lines : s (along the channel) and theta of the k * (layers + 1) nodes on these lines, also as
            functions of the height.
        """
        end, up, width = (blade.high, 1.0, row.tip_gap)
        if zone.low == 0.0:
            end, up, width = blade.low, -1.0, row.hub_gap
        walls, first_nodes = _at_end(row, end, up, around, lines)
        along, moves = _moves(row, walls, first_nodes)
        length = norms(moves)
        moves *= np.minimum(1.0, _MOST * width / np.where(length > 0.0, length, np.inf))[:, None]
        deep = np.minimum(_DEEP * width / along, _PART * (blade.high - blade.low))
        return cls(end, up, zone.high - zone.low, deep, moves)

    def of_columns(self, part: slice) -> Self:
        """Return the displacements of nodes on only some grid lines, those with the indices `part`."""
        return replace(self, deep=self.deep[part], moves=self.moves[part])

    def shares(self, heights: Floats) -> Floats:
        """Return factors of displacements at `heights` (levels, k): 1 where blade and gap meet, 0 far off."""
        off = self.up * (heights - self.end)
        away = np.where(off > 0.0, off / self.gap, -off / self.deep)
        return np.asarray(smooth_step(np.clip(1.0 - away, 0.0, 1.0)))


def rises_of(
    row: Row, zones: Sequence[Zone], around: SpanLines, lines: SpanLines, first: float
) -> list[Rise]:
    """Return, for each narrow gap at hub or casing, displacements of the blade's layers next to the gap.

    Nodes move so that first cells (`first` high) lean less. For `around` and `lines`, see `Rise.of`.
    """
    blade = next(zone for zone in zones if not zone.gap)
    narrow = [zone for zone in zones if zone.gap and zone.ends[0] < NARROW * first]
    rises = [Rise.of(row, zone, blade, around, lines) for zone in narrow]
    return [rise for rise in rises if rise.moves.any()]


def raise_layers(
    rises: Sequence[Rise], space: Floats, heights: Floats, ends: tuple[Indices, Indices, Floats], first: float
) -> None:
    """Raise or lower the blade's layers next to a narrow gap, in place; first cells keep their exact heights.

    Parameters
    ----------
    space : (levels, k, n, 3) x, y, z by level along the span, grid line off the blade, node on the line.
    heights : (levels, k) heights of the nodes on the blade, 0 at the hub and 1 at the casing.
    ends : three arrays (2 z,) for both ends, along the span, of z zones (the blade, and its gaps at hub and
        casing): index of the level at the end, of the next level in the zone, height of the cell between.
    first : height of first cells at the blade.
    """
    rows = space.shape[2]
    left = np.clip((rows - 1.0 - np.arange(float(rows))) / (rows - 2.0), 0.0, 1.0)[1:, None]
    walls, beside, sizes = ends
    for rise in rises:
        columns = np.flatnonzero(rise.moves.any(axis=1))
        own = space[:, columns]
        blade, lines = own[:, :, :1], own[:, :, 1:] - own[:, :, :1]
        moves = rise.shares(heights)[:, columns, None] * rise.moves[columns]
        lines += smooth_step(left) * moves[:, :, None]
        longer = first / norms(lines[:, :, 0])
        own[:, :, 1:] = blade + lines * (1.0 + left**2 * (longer - 1.0)[..., None, None])
        begin, way = own[walls][:, :, 1:], own[beside][:, :, 1:] - own[walls][:, :, 1:]
        own[beside, :, 1:] = begin + way * (sizes[:, None, None] / norms(way))[..., None]
        begins, lengths = (own[beside][:, :, 0], own[walls][:, :, 1]), (first, sizes[:, None])
        own[beside, :, 1] = exact_in_corners(own[beside][:, :, 1], begins, lengths, np.asarray)
        space[:, columns] = own


def _at_end(row: Row, end: float, up: float, around: SpanLines, lines: SpanLines) -> tuple[Floats, Floats]:
    """Return s, theta, h (4, k, 3) on the blade at its end, and of the nodes next to it (k, 3).

    The four are where columns begin, next along the span, and on both sides around.
    """
    inside = end - up * _STEP
    u, nodes = around.at(np.array([[end], [inside]])), lines.at(np.array([[end]]))[0]
    count = u.shape[1]
    walls, out = np.empty((4, count, 3)), np.full((count, 3), end)
    for k, (at, height) in enumerate(((u[0], end), (u[1], inside), (u[0] - _STEP, end), (u[0] + _STEP, end))):
        walls[k, :, :2], walls[k, :, 2] = row.surface.at(np.mod(at, 1.0), np.full((1, count), height)), height
    columns = nodes.reshape(count, -1, 2)
    out[:, :2] = columns[:, 1] + walls[0, :, :2] - columns[:, 0]
    return walls, out


def _moves(row: Row, walls: Floats, first_nodes: Floats) -> tuple[Floats, Floats]:
    """Return lengths (k,) per unit of height along the blade, and moves (k, 3) that limit lean to `LEAN`.

    Lean is the component of a line in the blade's tangent plane over the normal one.
    """
    wall, inside, before, after = row.channel.in_space(walls)
    off, along = row.channel.in_space(first_nodes) - wall, wall - inside
    length = norms(along)
    along /= length[:, None]
    normal = np.cross(after - before, along)
    normal /= norms(normal)[:, None]
    straight = dots(off, normal)
    aside = off - straight[:, None] * normal
    half = dots(aside, along)
    more = dots(aside, aside) - (LEAN * straight) ** 2
    root = np.sqrt(np.maximum(half * half - more, 0.0))
    move = np.where(more > 0.0, np.where(half > 0.0, root, -root) - half, 0.0)
    return length / _STEP, move[:, None] * along
