"""Five blocks inside the outline of a blade, in a gap: a ring of four, and a core.

Ring blocks count i along the outline and j inwards, the core i along side 0 and j from side 0 to side 2.
Sides 1 and 3 go around the edges of the blade.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, arc_lengths, norms
from meshonet.geometry.curves.cubic import cubic_spline
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.elementary import exp, log, power
from meshonet.geometry.errors import NoValidGridError
from meshonet.geometry.layout.lattice import lattice_quads
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.geometry.polygon.normals import left_normals
from meshonet.geometry.spacing.growth import cells_for_growth
from meshonet.kernels._native import line_neighbours
from meshonet.solvers.energy.quads import optimise

_ITERATIONS = 200
_FEWEST_ROWS = 4
_POWER = 6.0  # how fast the core's lines gather towards its ends
_BISECTIONS = 50
_ROUND = 0.4  # of the width of an edge behind it, at which it ends
_FEWER = 0.8
FLAT, SMOOTH, MARGIN = 0.95, 1e-3, 0.93
"""Weights w and beta of the functional; fraction of the limit of growth from which on growth counts."""
STEEP, STEEPEST = 0.7, 6.0  # smallest and largest weight of the growth of cells
UNEVEN = 3.3, 3.9
"""Logarithms of growth, over that of its limit, at which the weight begins to rise and is largest."""


@dataclass(frozen=True, eq=False)
class GapFill:
    """Five blocks that fill the outline of a blade in the gap to the hub or the casing."""

    outline: Indices  # (k,) indices in the given outline, clockwise from side 0; first nodes of `layout`
    layout: Layout  # the five blocks, the core last


def outline_sides(count: int, lead: int, aside: int) -> list[Indices]:
    """Return the node indices of the four sides into which a blade's outline of `count` nodes is divided.

    Side 1 has the trailing edge in its middle, side 3 the leading edge, which is node `lead`. These sides
    have 2 * `aside` cells each. Sides 0 and 2 are between them.
    """
    m, half = aside, count // 2
    cuts = [m, half - m, half + m, count - m, count + m]
    return [(lead + np.arange(a, b + 1)) % count for a, b in pairwise(cuts)]


def _counts(outline: Floats, lead: int, first: float, growth: float) -> tuple[int, int]:
    """Return how many nodes sides 1 and 3 reach from the edges, about half circles, and the ring's rows."""
    count = len(outline)
    m = np.arange(1, max(count // 8, 2))
    asides, widest = [], 0.0
    for edge in (lead, lead + count // 2):
        one, other = outline[(edge + m) % count], outline[(edge - m) % count]
        behind, width = norms(0.5 * (one + other) - outline[edge % count]), norms(one - other)
        round_off = np.flatnonzero(behind >= _ROUND * width)
        asides.append(int(m[round_off[0]]) if len(round_off) else int(m[-1]))
        half = np.arange(1, count // 2)
        across = norms(outline[(edge + half) % count] - outline[(edge - half) % count])
        widest = max(widest, float(across.max()))
    aside = sum(asides) // 2
    cells = round(_FEWER * (cells_for_growth(first, 0.5 * widest, growth) + 1))
    return aside, max(_FEWEST_ROWS, cells - aside)


def filled_outline(outline: Floats, lead: int, first: float, growth: float) -> GapFill:
    """Return the five blocks inside a clockwise outline (k, 2), with outer cells about `first` high.

    `lead` is the index of the node at the leading edge. `growth` limits the size ratio of neighbouring
    cells, and that of outer cells to `first`. Raises NoValidGridError if cells are folded.
    """
    aside, rows = _counts(outline, lead, first, growth)
    sides = outline_sides(len(outline), lead, aside)
    order = np.concatenate([side[:-1] for side in sides])
    start, blocks = _first_guess([outline[side] for side in sides], outline, lead, rows, first, growth)
    loop = Loop.of_polygon(outline[order][::-1], (), ("blade",))
    count, k = len(start), len(order)
    places = Places.inside(count + k)
    around = np.arange(k)
    places.loop[around], places.arc[around] = 0, loop.curve.knots[::-1]
    held = np.zeros(count + k, dtype=bool)
    held[:k] = held[count:] = True
    closed = np.append(around, 0)
    beyond = np.stack([count + closed, closed], axis=1)  # with them growth is limited across the outline
    mesh = QuadMesh(
        Domain((loop,), "gap"), np.concatenate([start, (outline + first * left_normals(outline))[order]]),
        lattice_quads([block[::-1] for block in (*blocks, beyond)]), places,
    )  # fmt: skip
    nodes = _optimum(mesh, held, growth).nodes
    inside = QuadMesh(
        mesh.domain, nodes[:count], lattice_quads([block[::-1] for block in blocks]),
        places.take(np.arange(count)),
    )  # fmt: skip
    return GapFill(order, Layout(inside, tuple(blocks)))


def _optimum(mesh: QuadMesh, held: Bools, growth: float) -> QuadMesh:
    """Return the mesh with all but `held` (n,) nodes at the optimum."""
    aspects = mesh.aspects(mesh.edge_lengths)

    def optimum(start: QuadMesh, weight: float) -> QuadMesh:
        made = optimise(
            start, iterations=_ITERATIONS, held=held, aspects=aspects, weights=(FLAT, SMOOTH),
            growth=(weight, MARGIN * math.log(growth)),
        )  # fmt: skip
        if not made.valid:
            raise NoValidGridError("cells in the gap stay folded")
        return made.mesh

    mesh = optimum(mesh, STEEP)
    excess = _largest_growth(mesh, held) / math.log(growth)
    part = (excess - UNEVEN[0]) / (UNEVEN[1] - UNEVEN[0])
    return mesh if part <= 0.0 else optimum(mesh, STEEP + min(part, 1.0) * (STEEPEST - STEEP))


def _largest_growth(mesh: QuadMesh, held: Bools) -> float:
    """Return the largest log ratio of consecutive edges that are not both between `held` nodes."""
    edges, lengths = mesh.edges, mesh.edge_lengths
    quads = np.ascontiguousarray(mesh.quads)
    line, _ = line_neighbours(quads, mesh.edge_of, np.arange(len(mesh.nodes)), np.arange(len(edges)))
    still = np.asarray(held[edges].all(axis=1))
    ratios = np.where(still[:, None] & still[line], 1.0, lengths[line] / lengths[:, None])
    return float(log(ratios).max())


def _first_guess(
    sides: Sequence[Floats], outline: Floats, lead: int, rows: int, first: float, growth: float
) -> tuple[Floats, list[Indices]]:
    """Return nodes (n, 2), the outline's first, and the blocks of their numbers."""
    low, high = sides[0], sides[2][::-1]
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    width = norms(half)
    along = arc_lengths(middle)
    part = along / along[-1]
    m = (len(sides[1]) - 1) // 2
    depths = _grown(width, first, rows + m)
    inset = depths[:, rows] / width  # part of half the thickness that the ring fills
    shifts = []
    for k, edge in ((0, lead), (-1, lead + len(outline) // 2)):
        step = float(norms(low[k] - low[1 if k == 0 else -2]))
        deep = float(np.minimum(first * power(growth, np.arange(float(rows))), step).sum())
        behind = float(norms(outline[edge % len(outline)] - middle[k]))
        shifts.append(min(max(deep - behind, inset[k] * width[k]), 0.2 * float(along[-1])))
    at = along + shifts[0] * power(1.0 - part, _POWER) - shifts[1] * power(part, _POWER)
    centre, reach = cubic_spline(middle, along, at), cubic_spline(half, along, at)
    depths = _grown(norms(reach), first, rows + m) / norms(reach)[:, None]
    across = np.concatenate([depths[:, rows:] - 1.0, 1.0 - depths[:, -2 : rows - 1 : -1]], axis=1)
    core = centre[:, None] + across[..., None] * reach[:, None]
    inner = [core[:, 0], core[-1], core[::-1, -1], core[0, ::-1]]
    ring = []
    for a, b in zip(sides, inner, strict=True):
        length = norms(b - a)
        t = _grown(length, first, rows) / length[:, None]
        ring.append(a[:, None] + t[..., None] * (b - a)[:, None])
    return _numbered(ring, core)


def _grown(lengths: Floats, first: float, cells: int) -> Floats:
    """Return distances (n, cells + 1) of cells that grow from `first`, or are equal, over `lengths` (n,)."""
    k = np.arange(float(cells))
    low, high = np.zeros(len(lengths)), np.full(len(lengths), 3.0)
    for _ in range(_BISECTIONS):
        slope = 0.5 * (low + high)
        less = first * exp(slope[:, None] * k).sum(axis=1) < lengths
        low, high = np.where(less, slope, low), np.where(less, high, slope)
    sizes = exp(low[:, None] * k)
    sizes *= (lengths / sizes.sum(axis=1))[:, None]
    return np.concatenate([np.zeros((len(lengths), 1)), np.cumsum(sizes, axis=1)], axis=1)


def _numbered(ring: Sequence[Floats], core: Floats) -> tuple[Floats, list[Indices]]:
    """Return the nodes (n, 2) of ring and core, shared ones once, and the blocks of their numbers."""
    counts = np.cumsum([0, *(len(block) - 1 for block in ring)])
    rows = ring[0].shape[1]
    points, number = [np.concatenate([block[:-1, 0] for block in ring]), core.reshape(-1, 2)], int(counts[-1])
    own = number + np.arange(core[..., 0].size).reshape(core.shape[:2])
    number += own.size
    inner = [own[:, 0], own[-1], own[::-1, -1], own[0, ::-1]]
    diagonals = []
    for block in ring:
        diagonals.append(number + np.arange(rows - 2))
        points.append(block[0, 1:-1])
        number += rows - 2
    blocks = []
    for k, block in enumerate(ring):
        ids = np.empty(block.shape[:2], dtype=np.intp)
        ids[:, 0] = np.append(np.arange(counts[k], counts[k + 1]), counts[(k + 1) % 4 if k < 3 else 0])
        ids[:, -1] = inner[k]
        ids[0, 1:-1], ids[-1, 1:-1] = diagonals[k], diagonals[(k + 1) % 4]
        inside = ids[1:-1, 1:-1].shape
        ids[1:-1, 1:-1] = number + np.arange(inside[0] * inside[1]).reshape(inside)
        number += inside[0] * inside[1]
        points.append(block[1:-1, 1:-1].reshape(-1, 2))
        blocks.append(ids)
    return np.concatenate(points), [*blocks, own]
