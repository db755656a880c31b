"""What is right and how good a mesh of quads is, by means of its own, from nodes, quads and polygons."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats

Numbers = NDArray[np.intp]
ON_OUTLINE = 1e-8
"""Most distance of wall nodes from the outline, by the domain's extent."""
AREA = 1e-3
"""Most relative difference of areas."""


@dataclass(frozen=True)
class Judged:
    """A mesh of quads, and what is wrong with it, in words; no word where nothing is."""

    cells: int
    irregular: int
    mean: float
    p99: float
    folded: int
    wrong: str


def judged(nodes: Floats, quads: Numbers, loops: list[Floats], *, strict: bool = True) -> Judged:
    """Judge quads (m, 4) of `nodes` (n, 2), counter-clockwise, in the domain bounded by polygons.

    `strict` asks for conformity, wall nodes on the outline and the area; else these are not looked at.
    """
    z = nodes[:, 0] + 1j * nodes[:, 1]
    corner = z[quads]
    ahead, behind = np.roll(corner, -1, axis=1) - corner, np.roll(corner, 1, axis=1) - corner
    jacobian = (np.conj(ahead) * behind).imag
    folded = int((jacobian <= 0).any(axis=1).sum())
    with np.errstate(invalid="ignore", divide="ignore"):
        off = np.abs(np.degrees(np.angle(behind / ahead)) % 360.0 - 90.0)
    edges, counts = edges_of(quads, len(nodes))
    valence = np.bincount(quads.ravel(), minlength=len(nodes))
    wall = np.zeros(len(nodes), dtype=bool)
    wall[edges[counts == 1].ravel()] = True
    irregular = int(np.count_nonzero(~wall & (valence > 0) & (valence != 4)))
    wrong = [f"{folded} folded"] if folded else []
    if strict:
        wrong += faults(nodes, quads, edges, counts, wall, loops)
    worst = np.nan_to_num(off.max(axis=1), nan=180.0)
    mean = float(np.nanmean(off))
    return Judged(len(quads), irregular, mean, float(np.percentile(worst, 99)), folded, "; ".join(wrong))


def faults(
    nodes: Floats,
    quads: Numbers,
    edges: Numbers,
    counts: Numbers,
    wall: NDArray[np.bool_],
    loops: list[Floats],
) -> list[str]:
    """Return what is wrong with a mesh beside folds."""
    extent = float(np.ptp(loops[0], axis=0).max())
    wrong = []
    used = np.unique(quads)
    if counts.max() > 2 or len(used) - len(edges) + len(quads) != 2 - len(loops):
        wrong.append("not conforming")
    away = min_distance(nodes[wall], loops).max() / extent
    if away > ON_OUTLINE:
        wrong.append(f"wall nodes {away:.1e} off the outline")
    area = abs(shoelace(loops[0])) - sum(abs(shoelace(loop)) for loop in loops[1:])
    x, y = (nodes - loops[0][0])[quads].transpose(2, 0, 1)
    covered = 0.5 * float((x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum())
    if abs(covered - area) > AREA * area:
        wrong.append(f"area wrong by {covered / area - 1.0:.1e}")
    return wrong


def edges_of(quads: Numbers, count: int) -> tuple[Numbers, Numbers]:
    """Return the edges (e, 2), each once, and how many quads have each."""
    pairs = np.sort(np.stack([quads, np.roll(quads, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    keys, counts = np.unique(pairs[:, 0] * count + pairs[:, 1], return_counts=True)
    return np.stack([keys // count, keys % count], axis=1), counts


def merged(blocks: list[Floats]) -> tuple[Floats, Numbers]:
    """Return nodes and quads of blocks (ni, nj, 2), of which nodes are one where they are bitwise equal."""
    every = np.concatenate([block.reshape(-1, 2) for block in blocks])
    nodes, number = np.unique(every, axis=0, return_inverse=True)
    quads, start = [], 0
    for block in blocks:
        ni, nj = block.shape[:2]
        own = number.reshape(-1)[start : start + ni * nj].reshape(ni, nj)
        start += ni * nj
        corners = own[:-1, :-1], own[1:, :-1], own[1:, 1:], own[:-1, 1:]
        quads.append(np.stack(corners, axis=-1).reshape(-1, 4))
    return nodes, np.concatenate(quads)


def min_distance(points: Floats, loops: list[Floats]) -> Floats:
    """Return the distance (n,) of each point from the nearest polygon."""
    nearest = np.full(len(points), np.inf)
    for loop in loops:
        for a, b in zip(loop, np.roll(loop, -1, axis=0), strict=True):
            along = b - a
            t = np.clip((points - a) @ along / max(along @ along, 1e-300), 0.0, 1.0)
            nearest = np.minimum(nearest, np.hypot(*(points - a - t[:, None] * along).T))
    return nearest


def shoelace(loop: Floats) -> float:
    """Return the signed area of a polygon (n, 2)."""
    (x, y), (u, v) = (loop - loop[0]).T, np.roll(loop - loop[0], -1, axis=0).T
    return 0.5 * float((x * v - u * y).sum())
