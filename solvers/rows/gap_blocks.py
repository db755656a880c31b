"""Blocks in a gap: what is filled inside the blade's outline at both of its ends, and nodes between."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.elementary import product
from meshonet.geometry.linear import least_squares
from meshonet.geometry.polygon.corners import Indices
from meshonet.geometry.rows.channel import MeridionalMap
from meshonet.geometry.rows.row import Row
from meshonet.solvers.rows.gap_fill import GapFill, filled_outline
from meshonet.solvers.rows.harmonic import harmonic
from meshonet.solvers.rows.row_nodes import RowNodes
from meshonet.solvers.rows.span_lines import key_heights
from meshonet.solvers.rows.span_spacing import SAMPLES, line_parts
from meshonet.solvers.rows.zones import Zone

_ROUNDS = 4


@dataclass(frozen=True, eq=False)
class GapBlocks:
    """The blocks inside the outline of the blade in one gap.

    Parameters
    ----------
    fill : their numbering; nodes of the outline come first.
    outline : (k,) these among the nodes of the row's sections.
    space : (levels, n, 3) x, y, z.
    """

    fill: GapFill
    outline: Indices
    space: Floats


def gap_blocks(
    row: Row, made: RowNodes, around: Indices, lead: int, zone: Zone, levels: tuple[int, int], first: float,
    growth: float,
) -> GapBlocks:  # fmt: skip
    """Return the blocks of a gap.

    Parameters
    ----------
    made : nodes of the row.
    around : (k,) those of the blade, clockwise; `lead` is the number of that at the leading edge.
    zone, levels : the gap, and the numbers of the levels that bound it.
    first, growth : height of cells inside the outline next to it, and their largest ratio.

    Raises NoValidGridError: cells stay folded.
    """
    tip = zone.high == 1.0  # the blade is below this gap, otherwise above it
    heights = (zone.low, zone.high) if tip else (zone.high, zone.low)
    maps: list[MeridionalMap] = []
    outlines: list[Floats] = []
    outside: list[Floats] = []
    for level, height in zip(levels if tip else levels[::-1], heights, strict=True):
        maps.append(row.channel.meridional(height))
        for k, out in enumerate((outlines, outside)):
            s, theta, _ = made.beside[level, :, k].T
            out.append(np.stack([maps[-1].forward(s), theta], axis=1))
    blade = row.channel.in_space(made.beside[levels[0] : levels[1] + 1, :, 0])
    radius = float(norms(blade[0, :, 1:]).mean())
    fill = filled_outline(outlines[0], outside[0], lead, first / radius, growth)
    planes = [fill.layout.mesh.nodes, _carried(fill, outlines[1])]
    ends = [
        np.stack([to.back(nodes[:, 0]), nodes[:, 1]], axis=1) for to, nodes in zip(maps, planes, strict=True)
    ]
    low, high = ends if tip else ends[::-1]
    between = _between(row, low, high, zone, blade[:, fill.outline], fill, growth)
    return GapBlocks(fill, around[fill.outline], between)


def _carried(fill: GapFill, outline: Floats) -> Floats:
    """Return nodes (n, 2) inside another outline: by the affine map nearest to their change, and the rest."""
    mesh, wanted = fill.layout.mesh, outline[fill.outline]
    k = len(wanted)
    centre = mesh.nodes[:k].mean(axis=0)
    local = np.concatenate([mesh.nodes - centre, np.ones((len(mesh.nodes), 1))], axis=1)
    nodes = product(local, least_squares(local[:k], wanted))
    moves = np.zeros_like(nodes)
    moves[:k] = wanted - nodes[:k]
    return np.asarray(nodes + harmonic(mesh, moves, np.arange(len(moves)) < k))


def _between(
    row: Row, low: Floats, high: Floats, zone: Zone, outline: Floats, fill: GapFill, growth: float
) -> Floats:
    """Return nodes (levels, n, 3) in space between those at both ends, `outline` (levels, k, 3) as given."""
    channel, k = row.channel, outline.shape[1]

    def at(part: Floats) -> Floats:
        s_theta = low + part[..., None] * (high - low)
        heights = zone.low + part * (zone.high - zone.low)
        heights[-1] = zone.high
        return channel.in_space(np.concatenate([s_theta, heights[..., None]], axis=-1))

    samples = at(np.repeat(key_heights(SAMPLES)[:, None], len(low), axis=1))
    space = at(line_parts(samples, zone.ends, growth, zone.cells))
    move = outline - space[:, :k]
    for block in fill.layout.blocks[:4]:
        rows = block.shape[1] - 1
        for j in range(1, rows):
            space[:, block[1:-1, j]] += (1.0 - j / rows) ** 2 * move[:, block[1:-1, 0]]
    for block in fill.layout.blocks[:4]:  # lines between two blocks, once
        rows = block.shape[1] - 1
        space[:, block[0, 1:rows]] += ((1.0 - np.arange(1, rows) / rows) ** 2)[:, None] * move[
            :, block[0, :1]
        ]
    space[:, :k] = outline
    for end, own, size in ((0, 1, zone.ends[0]), (-1, -2, zone.ends[1])):
        for _ in range(_ROUNDS):
            step = space[own, k:] - space[end, k:]
            space[own, k:] = space[end, k:] + step * (size / norms(step))[:, None]
    return space
