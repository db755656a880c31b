"""Blocks in a gap, inside the outline of the blade."""

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, norms, wrapped
from meshonet.geometry.elementary import product
from meshonet.geometry.linear import least_squares
from meshonet.geometry.rows.row import Row
from meshonet.solvers.rows.gap_fill import GapFill, filled_outline
from meshonet.solvers.rows.harmonic import HarmonicMoves
from meshonet.solvers.rows.span_lines import key_heights
from meshonet.solvers.rows.span_places import SpanPlaces
from meshonet.solvers.rows.span_spacing import SAMPLES, line_parts
from meshonet.solvers.rows.zones import Zone

_ROUNDS = 4


@dataclass(frozen=True, eq=False)
class GapEnds:
    """Nodes inside the blade's outline at both sides of a gap: on the blade's end, and on hub or casing."""

    fill: GapFill  # numbering of the nodes; those of the outline come first
    low: Floats  # (n, 2) s and theta on the lower surface
    high: Floats  # (n, 2) s and theta on the upper surface


@dataclass(frozen=True, eq=False)
class GapBlocks:
    """The blocks in a gap between blade and hub or casing, inside the outline of the blade."""

    fill: GapFill  # numbering of the nodes; those of the outline come first
    outline: Indices  # (k,) indices of the outline's nodes in a section of the row
    space: Floats  # (levels, n, 3) x, y, z


def gap_ends(row: Row, places: SpanPlaces, zone: Zone, first: float, growth: float) -> GapEnds:
    """Return nodes on the two surfaces that bound a gap: the blade's end, and hub or casing opposite to it.

    Parameters
    ----------
    places : places around the blade at which its nodes lie.
    zone : the gap.
    first, growth : height of cells at the outline, normal to it, and largest ratio of neighbouring cells.

    Raises NoValidGridError if cells stay folded.
    """
    tip = zone.high == 1.0  # the blade is below this gap, otherwise above it
    heights = (zone.low, zone.high) if tip else (zone.high, zone.low)
    maps = [row.channel.meridional(height) for height in heights]
    lead = int(np.abs(wrapped(places.at(float(tip)))).argmin())
    outlines: list[Floats] = []
    for to, height in zip(maps, heights, strict=True):
        nodes = row.surface.section(height, places.at(height))
        outlines.append(np.stack([to.forward(nodes[:, 0]), nodes[:, 1]], axis=1))
        if height == zone.low:
            radius = float(row.channel.at(nodes[:, 0], np.full(len(nodes), height))[:, 1].mean())
    fill = filled_outline(outlines[0], lead, first / radius, growth)
    planes = [fill.layout.mesh.nodes, _carried(fill, outlines[1])]
    ends = [
        np.stack([to.back(nodes[:, 0]), nodes[:, 1]], axis=1) for to, nodes in zip(maps, planes, strict=True)
    ]
    return GapEnds(fill, *(ends if tip else ends[::-1]))


def gap_blocks(
    row: Row, ends: GapEnds, around: Indices, outline: Floats, zone: Zone, growth: float
) -> GapBlocks:
    """Return the blocks in a gap between blade and hub or casing, from the nodes `ends` on these surfaces.

    `around` (k,) are the indices of the blade's nodes in a section, clockwise. `outline` (levels, k, 3) has
    these nodes on levels along the span: s along the channel, theta around the axis, h from hub to casing.
    """
    fill = ends.fill
    between = _between(row, ends.low, ends.high, zone, outline[:, fill.outline], fill, growth)
    return GapBlocks(fill, around[fill.outline], between)


def _carried(fill: GapFill, outline: Floats) -> Floats:
    """Return nodes (n, 2) inside another outline, by the nearest affine map and harmonic moves."""
    mesh, wanted = fill.layout.mesh, outline[fill.outline]
    k = len(wanted)
    centre = mesh.nodes[:k].mean(axis=0)
    local = np.concatenate([mesh.nodes - centre, np.ones((len(mesh.nodes), 1))], axis=1)
    nodes = product(local, least_squares(local[:k], wanted))
    moves = np.zeros_like(nodes)
    moves[:k] = wanted - nodes[:k]
    return np.asarray(nodes + HarmonicMoves(mesh, np.arange(len(moves)) < k).of(mesh, moves))


def _between(
    row: Row, low: Floats, high: Floats, zone: Zone, outline: Floats, fill: GapFill, growth: float
) -> Floats:
    """Return nodes (levels, n, 3) in space between both ends; `outline` (levels, k, 3) is in s, theta, h."""
    channel, k = row.channel, outline.shape[1]

    def at(part: Floats) -> Floats:
        s_theta = low + part[..., None] * (high - low)
        heights = zone.low + part * (zone.high - zone.low)
        heights[-1] = zone.high
        return np.concatenate([s_theta, heights[..., None]], axis=-1)

    samples = channel.in_space(at(np.repeat(key_heights(SAMPLES)[:, None], len(low), axis=1)))
    nodes = at(line_parts(samples, zone.ends, growth, zone.cells))
    move = outline - nodes[:, :k]
    for block in fill.layout.blocks[:4]:
        rows = block.shape[1] - 1
        for j in range(1, rows):
            nodes[:, block[:-1, j]] += (1.0 - j / rows) ** 2 * move[:, block[:-1, 0]]
    nodes[:, :k] = outline
    space = channel.in_space(nodes)
    for end, own, size in ((0, 1, zone.ends[0]), (-1, -2, zone.ends[1])):
        for _ in range(_ROUNDS):
            step = space[own, k:] - space[end, k:]
            space[own, k:] = space[end, k:] + step * (size / norms(step))[:, None]
    return space
