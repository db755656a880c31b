"""Target edge lengths of a triangulation: short at narrow gaps, curved walls and short sides."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, turned_left
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.polygon.corners import angle_between
from meshonet.kernels._native import wall_gaps, wall_growth

GROWTH = 0.35  # largest change of the size per length; 0.15 and 0.7 give 22 domains 450, 455 blocks, not 431
PER_GAP = 3.5  # edges across a gap; half and twice as many give 22 domains 459 and 423 blocks, not 431
PER_RADIUS = 0.45
"""Edge length over the radius of curvature; half and twice as much give 446 and 428 blocks, not 431."""
PER_PIECE = 4.0  # smallest number of edges between two corners
FLOOR = 1.0 / 25.0  # smallest size at walls, relative to the largest size, or to `OF_LOOP` times the loop
OF_LOOP = 1.0 / 16.0  # of its length, the largest edge on a loop: 16 make a circle round
MOST = 2.0  # largest ratio of nodes on walls to requested nodes; long narrow gaps then get fewer
CONE = 0.6  # cosine of the angle to the normal within which another wall counts as being opposite


@dataclass(frozen=True, eq=False)
class WallSizes:
    """Target edge lengths at points on all boundary loops."""

    largest: float  # largest size
    smallest: Floats  # (loops,) smallest size due to the walls of a loop; `finer` points may have smaller
    loop: Indices  # (n,) number of the loop
    piece: Indices  # (n,) number of the piece between two corners, counted through all loops
    arc: Floats  # (n,) arc length on the loop
    length: Floats  # (n,) length of the interval around the sample
    size: Floats  # (n,) size at the sample


class _Samples(NamedTuple):
    """Samples of a loop: pieces (n,), those before and behind (n, 2) or -1, distances (n, 2) to their starts.

    `length` (n,) is that of a sample's interval, `of_piece` (n,) that of its piece.
    """

    piece: Indices
    beside: Indices
    corner: Floats
    arc: Floats
    length: Floats
    of_piece: Floats
    points: Floats
    tangents: Floats


def usual_size(area: float, count: int) -> float:
    """Return the edge length of equilateral triangles that fill an `area`, with `count` vertices in all."""
    return float(np.sqrt(2.0 / np.sqrt(3.0) * area / count))


def wall_sizes(domain: Domain, count: int, finer: tuple[Floats, Floats] | None = None) -> WallSizes:
    """Return target edge lengths along the walls for about `count` nodes, in the domain's unit.

    ::

        h = max(min(h0, piece / 4, gap / 3.5, 0.45 radius), min(h0 / 25, loop / 400))

    Here h0 is the edge length if `count` nodes are spread evenly, piece the length of a wall between two
    corners, gap the distance to the wall in front, radius the radius of curvature, and loop the length of the
    loop. `finer` has further points (m, 2), and the greatest lengths (m,) there. Lengths at two points differ
    by at most 0.35 of their distance.
    """
    largest = usual_size(domain.area, count)
    samples = [_sample(loop, largest) for loop in domain.loops]
    loop = np.repeat(np.arange(len(samples)), [len(s.arc) for s in samples])
    first = np.cumsum([0] + [s.piece[-1] + 1 for s in samples])[loop]
    every = _Samples(*map(np.concatenate, zip(*samples, strict=True)))
    piece, points, arc, length = every.piece + first, every.points, every.arc, every.length
    beside = np.where(every.beside >= 0, every.beside + first[:, None], -1)
    size = _own_size(every._replace(piece=piece), largest)
    normals = turned_left(every.tangents)
    wall_gaps(points, normals, piece, beside, every.corner, 1.0 / PER_GAP, CONE, size)
    smallest = FLOOR * np.minimum(largest, OF_LOOP * domain.lengths)
    np.maximum(size, smallest[loop], out=size)
    affordable = _affordable(length, size, MOST * count)
    np.maximum(size, affordable, out=size)
    if finer is not None:
        for point, wanted in zip(*finer, strict=True):
            np.minimum(size, wanted + GROWTH * np.hypot(*(points - point).T), out=size)
    wall_growth(points, GROWTH, size)
    smallest = np.maximum(smallest, affordable)
    return WallSizes(max(largest, affordable), smallest, loop, piece, arc, length, size)


def _affordable(length: Floats, size: Floats, most: float) -> float:
    """Return the smallest size for which ∫ ds / h is at most a number of edges; 0 if it already is."""
    floor = 0.0
    while (length / np.maximum(size, floor)).sum() > most:
        floor = 1.1 * max(floor, float(size.min()))
    return floor


def _sample(loop: Loop, largest: float) -> _Samples:
    start, long = loop.pieces
    usual = min(largest, OF_LOOP * loop.length)
    least = np.where(long < 4.0 * FLOOR * usual, 4.0, 12.0)
    n = np.clip(5.0 * long / usual + 1e-9, least, 2000.0).astype(np.intp)
    piece = np.repeat(np.arange(len(n)), n)
    k = np.arange(len(piece)) - np.repeat(np.cumsum(n) - n, n)
    length = (long / n)[piece]
    along = (k + 0.5) * length
    if len(loop.corners):
        beside = (piece[:, None] + np.array([-1, 1])) % len(n)
        corner = np.stack([along, long[piece] - along], axis=1)
    else:
        beside, corner = np.full((len(piece), 2), -1), np.full((len(piece), 2), np.inf)
    arc = start[piece] + along
    return _Samples(piece, beside, corner, arc, length, long[piece], loop.at(arc), loop.tangent(arc))


def _own_size(samples: _Samples, largest: float) -> Floats:
    """Return the size (n,) due to a loop itself: a quarter of its pieces, a fraction of its radius."""
    same = samples.piece[1:] == samples.piece[:-1]
    turn = np.where(same, np.abs(angle_between(samples.tangents[:-1], samples.tangents[1:])), 0.0)
    beside = np.append(turn, 0.0) + np.insert(turn, 0, 0.0)
    smooth = beside.copy()
    smooth[1:] += np.where(same, beside[:-1], 0.0)
    smooth[:-1] += np.where(same, beside[1:], 0.0)
    curvature = smooth / 3.0 / (2.0 * samples.length)
    size = np.minimum(largest, samples.of_piece / PER_PIECE)
    return np.minimum(size, PER_RADIUS / np.maximum(curvature, PER_RADIUS / (2.0 * largest)))


def place_nodes(domain: Domain, sizes: WallSizes) -> tuple[Indices, Floats]:
    """Return the loop indices and arc lengths (b,) of b wall nodes, spaced by target edge lengths `sizes`.

    Corners are nodes. A wall between two corners has at least 2 edges, a loop without corners at least 8.
    """
    loops, arcs = [], []
    for number, loop in enumerate(domain.loops):
        mine = sizes.loop == number
        start, _ = loop.pieces
        piece = sizes.piece[mine] - sizes.piece[mine][0]
        steps = sizes.length[mine] / sizes.size[mine]
        many = np.bincount(piece, steps)
        least = 2 if len(start) > 1 else 8
        n = np.maximum(np.ceil(many - 1e-9).astype(np.intp), least)
        of = np.repeat(np.arange(len(n)), n)
        k = np.arange(len(of)) - np.repeat(np.cumsum(n) - n, n)
        before = np.cumsum(many) - many
        edges = np.append(start[0], start[0] + np.cumsum(sizes.length[mine]))
        arc = np.interp(before[of] + many[of] * k / n[of], np.append(0.0, np.cumsum(steps)), edges)
        arc[k == 0] = start
        arcs.append(np.where(arc >= loop.length, arc - loop.length, arc))
        loops.append(np.full(len(arc), number))
    return np.concatenate(loops), np.concatenate(arcs)
