"""Cross-sections of a body that is given as a surface."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.aircraft.axes import FLAT
from meshonet.geometry.arrays import Floats, Indices, extent_of, norms
from meshonet.geometry.elementary import arctan2, cos, sin
from meshonet.geometry.errors import InputError, place_of
from meshonet.geometry.layout.lattice import lattice_quads
from meshonet.geometry.notes import Change
from meshonet.geometry.surface.merge import merged

_CLOSE = 1e-4  # smallest distance between cuts, relative to the length of a body
_SAME = 1e-6  # largest distance, relative to the height of a body, of points of a cut that are merged
_CAP = 9  # number of cuts through a cap
_CORNER, _CORNER_STEP = math.radians(10.0), 2e-5  # smallest turn; distance to cuts, in body lengths
_ALONE = 3.0  # smallest ratio of the turn at a corner to the turns beside it; at coarse noses all are large
_CAP_STEP = math.sin(0.5 * math.pi / _CAP) / 2.0  # first step of a cap, relative to its height
_MOST = 30  # largest number of cuts on one side of a corner
_ROUND = 1e-6  # largest difference of the radii of a cut through a body of revolution, in body lengths


@dataclass(frozen=True, eq=False)
class BodyCuts:
    """Cross-sections, in planes of constant x, of the half z >= 0 of a body."""

    x: Floats  # (n,) ascending positions of the planes, without nose and tail
    points: tuple[Floats, ...]  # (k, 2) y and z of each cut, from keel to crown
    # nose, tail: x and y of the two ends
    nose: tuple[float, float]
    tail: tuple[float, float]
    notes: tuple[str, ...]  # sentences about caps at ends that are not points

    @property
    def meridian(self) -> Floats | None:
        """Points (n + 2, 2) of x and radius from nose to tail; None unless the body is one of revolution."""
        y, size = self.nose[1], _ROUND * (self.tail[0] - self.nose[0])
        radii = [np.hypot(cut[:, 0] - y, cut[:, 1]) for cut in self.points]
        if abs(self.tail[1] - y) > size or max(float(np.ptp(each)) for each in radii) > size:
            return None
        r = [0.0, *(float(each.mean()) for each in radii), 0.0]
        return np.stack([[self.nose[0], *self.x, self.tail[0]], r], axis=1)


def body_cuts(patches: Sequence[Floats], name: str) -> BodyCuts:
    """Return cross-sections of the half z >= 0 of a body whose surface consists of `patches` (ni, nj, 3).

    The cuts are at the x of nodes in the plane of symmetry. More cuts are added close to corners of the keel
    and of the crown. An end that is not a point gets a cap: half an ellipsoid whose length is half the height
    of the end. `name` is used in messages.

    Raises InputError: a surface with holes, or with fewer than 4 nodes in the plane of symmetry.
    """
    nodes, lattices = merged(patches)
    length = extent_of(nodes)
    flat = FLAT * length
    nodes[np.abs(nodes[:, 2]) <= flat, 2] = 0.0
    low, high = float(nodes[:, 0].min()), float(nodes[:, 0].max())
    _refuse_holes(nodes, lattices, (low + flat, high - flat), name)
    middle = nodes[nodes[:, 2] == 0.0]
    x = np.sort(middle[:, 0])
    x = x[(x > low + flat) & (x < high - flat)]
    x = x[np.append(True, np.diff(x) > _CLOSE * length)] if len(x) else x
    if len(x) < 4:
        problem = f"the {name} has {len(x)} nodes in its plane of symmetry"
        raise InputError(problem, "give its half from keel to crown")
    edges = np.concatenate([_edges(lattice) for lattice in lattices])
    heights = np.array([float(np.ptp(_cut(nodes, edges, at, name)[[0, -1], 0])) for at in x.tolist()])
    x = _with_others(np.array([low, *x, high]), _corners(x, heights), _CORNER_STEP * length)
    for at in (low, high):
        height = float(np.ptp(middle[np.abs(middle[:, 0] - at) <= flat, 1]))
        if height > 2.0 * flat:
            x = _with_others(x, np.array([at]), _CAP_STEP * height)
    x = x[1:-1]
    ends: list[tuple[float, float]] = []
    caps: list[tuple[list[float], list[Floats]]] = []
    notes: list[str] = []
    for at, way in ((low, -1.0), (high, 1.0)):
        there = nodes[np.abs(nodes[:, 0] - at) <= flat]
        radius = 0.5 * float(np.ptp(there[:, 1]))
        if radius <= flat:
            ends.append((at, float(there[:, 1].mean())))
            caps.append(([], []))
            continue
        cut = _cut(nodes, edges, at, name)
        ends.append((at + way * radius, 0.5 * float(cut[0, 0] + cut[-1, 0])))
        caps.append(_cap(cut, at, way * radius))
        where = f"{'nose' if way < 0.0 else 'tail'}, x={at:.6g}"
        notes.append(Change(f"the {name} has no point at its {where}: a cap {radius:.3g} long closes it"))
    (before, first), (behind, last) = caps
    points = [*first[::-1], *(_cut(nodes, edges, float(each), name) for each in x), *last]
    return BodyCuts(np.array([*before[::-1], *x, *behind]), tuple(points), ends[0], ends[1], tuple(notes))


def _corners(x: Floats, heights: Floats) -> Floats:
    """Return the positions of corners in heights (n,) at x (n,)."""
    turns = np.abs(np.diff(arctan2(0.5 * np.diff(heights), np.diff(x))))
    beside = np.pad(turns, 1, constant_values=np.inf)
    return x[1:-1][(turns > _CORNER) & (turns > _ALONE * np.maximum(beside[:-2], beside[2:]))]


def _with_others(x: Floats, at: Floats, step: float) -> Floats:
    """Return positions `x` and new ones beside those `at`, at 1, 2, 4… times `step` from them."""
    own = x.tolist()
    for k in np.searchsorted(x, at).tolist():
        for other in (k - 1, k + 1):
            if 0 <= other < len(x):
                way = float(x[other] - x[k])
                doubled = np.ldexp(step, np.arange(_MOST))
                own += (x[k] + math.copysign(1.0, way) * doubled[doubled < 0.5 * abs(way)]).tolist()
    return np.sort(np.array(own))


def _cap(cut: Floats, at: float, length: float) -> tuple[list[float], list[Floats]]:
    """Return x and points of the cuts through a cap that begins at a cut (k, 2), without its tip."""
    turns = np.linspace(0.0, 0.5 * np.pi, _CAP + 1)[:-1]
    middle = np.array([0.5 * (cut[0, 0] + cut[-1, 0]), 0.0])
    return (at + length * sin(turns)).tolist(), [middle + float(c) * (cut - middle) for c in cos(turns)]


def _edges(lattice: Indices) -> Indices:
    """Return the edges (m, 2) of a lattice of nodes, without those of no length."""
    along = [np.stack([lattice[:-1].ravel(), lattice[1:].ravel()], axis=1)]
    along.append(np.stack([lattice[:, :-1].ravel(), lattice[:, 1:].ravel()], axis=1))
    edges = np.concatenate(along)
    return edges[edges[:, 0] != edges[:, 1]]


def _cut(nodes: Floats, edges: Indices, x: float, name: str) -> Floats:
    """Return y and z (k, 2), from keel to crown, where edges cross the plane x."""
    begin, end = nodes[edges[:, 0]], nodes[edges[:, 1]]
    cross = ((begin[:, 0] <= x) != (end[:, 0] <= x)) | ((begin[:, 0] >= x) != (end[:, 0] >= x))
    begin, end = begin[cross], end[cross]
    part = ((x - begin[:, 0]) / (end[:, 0] - begin[:, 0]))[:, None]
    points = ((1.0 - part) * begin + part * end)[:, 1:]
    middle = points[points[:, 1] == 0.0]
    if not len(middle) or np.ptp(middle[:, 0]) == 0.0:
        problem = f"the {name} has no points in the plane of symmetry at x={x:.6g}"
        raise InputError(problem, "give its half from keel to crown")
    centre = np.array([0.5 * (middle[:, 0].min() + middle[:, 0].max()), 0.0])
    angles = arctan2(points[:, 1], -(points - centre)[:, 0])
    order = np.argsort(angles, kind="stable")
    points = points[order]
    apart = norms(np.diff(points, axis=0)) > _SAME * float(np.ptp(middle[:, 0]))
    return points[np.append(True, apart)]


def _refuse_holes(nodes: Floats, lattices: Sequence[Indices], within: tuple[float, float], name: str) -> None:
    """Raise InputError for open edges between nose and tail outside the plane of symmetry."""
    quads = lattice_quads(lattices)
    edges = np.sort(np.stack([quads, np.roll(quads, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    edges = edges[edges[:, 0] != edges[:, 1]]
    keys = edges[:, 0] * len(nodes) + edges[:, 1]
    _, first, count = np.unique(keys, return_index=True, return_counts=True)
    ends = nodes[edges[first[count == 1]]]
    middle = ends.mean(axis=1)
    inner = (middle[:, 0] > within[0]) & (middle[:, 0] < within[1]) & (np.abs(ends[..., 2]).max(axis=1) > 0.0)
    if inner.any():
        where = place_of(middle[int(inner.argmax())])
        problem = f"the {name} has a hole or a side without a neighbour at {where}"
        remedy = "give the whole body, also where wings begin; for a surface with holes use solve-pde"
        raise InputError(problem, remedy)
