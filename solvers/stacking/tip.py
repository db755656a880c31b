"""The cap of a wing tip: a ring along the edge of the last section, and a core inside it.

m cells on each side of trailing edge and nose face the short sides of the core, all others its long sides.
Without a core, cells would have angles near 180 degrees. A round cap is as high as half the local thickness.
"""

import math
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, norms, rolled
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.elementary import cos, power, product, sin
from meshonet.solvers.sweeping.ring_steps import ring_steps

CORE = 0.5  # fraction of the thickness that the core covers
ROWS = 6  # number of rows of the ring
_EVEN = 1.17  # ratio of the last cells of the ring and those of the core, which needs not be 1
_RATIO = 1.7  # of neighbouring rows of the ring, at the most
_SWEEPS = 50  # of smoothing around the ring
_FINE = 65  # places on each line of the ring by which its length is measured
_ENDS = tuple(0.5 + 0.1 * k for k in range(10))  # tried factors on the core's distances from both edges
_CELL = 1.5  # length of the cells of the core at the nose, in cells of its short side there
_SHORTER = 0.4  # and in those of the section at the least: where nodes are few, angles would be larger
_REACH = 4.0  # fewest cells over which they become as long as the cells of the section
_MANY = 17  # nodes along the core above which cells at the nose are shorter
_HALVINGS = 40  # of the range of this number
_CLEAR = 1.3  # by which the core stays farther from nose and edge than the nodes that face its ends
_NOSE, _EDGE = 0.35, 0.3  # and at least so many thicknesses of the section there


@dataclass(frozen=True)
class Cap:
    """Settings of the cap that closes the tip of a wing."""

    short: int = 4  # cells on each side of trailing edge and nose that face a short side of the core
    rows: int = ROWS  # number of rows of the ring; they grow by one ratio
    bulge: float = 1.0  # height of the cap in local half thicknesses; 0 is flat

    def cells(self, nodes: int) -> int:
        """Return the number of cells of a cap; the last of the section's `nodes` nodes repeats the first."""
        return (nodes - 1) * self.rows + (nodes // 2 - 2 * self.short) * 2 * self.short

    def patches(self, loop: Floats) -> tuple[Floats, Floats]:
        """Return the nodes (ni, nj, 3) of two patches that close the tip: a ring and the core inside.

        The closed `loop` (n, 3) is in a plane of constant z. It starts at the trailing edge and runs along
        the upper side first. Normals of both patches point to +z.
        """
        made = {(1.0, 1.0): self._placed(loop, 1.0, 1.0)}
        best = 1.0, 1.0
        for axis in (0, 1, 0):
            tried = [(end, best[1]) if axis == 0 else (best[0], end) for end in _ENDS]
            made |= {ends: self._placed(loop, *ends) for ends in tried if ends not in made}
            best = max(tried, key=lambda ends: self._worth(*made[ends]))
        return made[best]

    def _placed(self, loop: Floats, nose: float, edge: float) -> tuple[Floats, Floats]:
        """Return ring and core for these factors on the core's distances from nose and trailing edge."""
        upper, lower, half = self._inner(loop[:, :2], nose, edge)
        b = np.linspace(0.0, 1.0, 2 * self.short + 1)[None, :]
        across = (1.0 - b[..., None]) * upper[:, None] + b[..., None] * lower[:, None]
        height = self.bulge * half[:, None] * np.sqrt(1.0 - (CORE * (1.0 - 2.0 * b)) ** 2)
        core = np.concatenate([across, loop[0, 2] + height[..., None]], axis=-1)
        return self._ring(loop, core), core

    def _worth(self, ring: Floats, core: Floats) -> float:
        """Return the smallest sine of corners of cells, less where ring and core differ too much."""
        ratio = norms(_edge(core, 1) - _edge(core)) / norms(ring[:, -1] - ring[:, -2])
        ratio[self._corners(len(ring))] = 1.0
        uneven = float(np.maximum(ratio, 1.0 / ratio).max())
        return min(least_sine(ring), least_sine(core)) / math.pow(max(1.0, uneven / (_EVEN + 0.01)), 4)

    def _corners(self, n: int) -> Indices:
        """Return which of n lines of a ring end at corners of the core."""
        m, half = self.short, (n - 1) // 2
        return np.array([m, half - m, half + m, n - 1 - m])

    def _ring(self, loop: Floats, core: Floats) -> Floats:
        inner = _edge(core)
        sizes = norms(_edge(core, 1) - inner)
        corners = self._corners(len(loop))
        sizes[corners] = 0.5 * (sizes[corners - 1] + sizes[corners + 1])
        part = np.linspace(0.0, 1.0, _FINE)
        fine = norms(np.diff(self._lines(loop, inner, np.broadcast_to(part, (len(loop), _FINE))), axis=1))
        away = np.concatenate([np.zeros((len(loop), 1)), np.cumsum(fine, axis=1)], axis=1)
        length = away[:, -1]
        ends = self._ends(length, sizes, corners)
        places = np.cumsum(ring_steps(length, ends, self.rows, None), axis=1)
        parts = [np.interp(places[k, :-1], away[k], part) for k in range(len(loop))]
        ring = np.empty((len(loop), self.rows + 1, 3))
        ring[:, 1:-1] = self._lines(loop, inner, np.stack(parts))
        ring[:, 0], ring[:, -1] = loop, inner
        ring[-1] = ring[0]
        return ring

    def _ends(self, length: Floats, sizes: Floats, corners: Indices) -> Floats:
        """Return the last cells (n,) of lines of this `length` before cells of these `sizes`."""
        least, most = (
            1.0 / sum(math.pow(ratio, k) for k in range(self.rows)) for ratio in (_RATIO, 1.0 / _RATIO)
        )
        free = np.full(len(length), 1.0)
        free[corners] = np.inf
        low, high = (
            np.clip(sizes * factor / length, least, most) for factor in (1.0 / (_EVEN * free), _EVEN * free)
        )
        share = np.clip(1.0 / self.rows, low, high)
        for _ in range(_SWEEPS):
            around = share[:-1]
            smooth = 0.5 * around + 0.25 * (rolled(around, 1) + rolled(around, -1))
            share = np.minimum(np.maximum(np.concatenate([smooth, smooth[:1]]), low), high)
        return share * length

    def _lines(self, loop: Floats, inner: Floats, part: Floats) -> Floats:
        """Return points (n, k, 3) at fractions `part` (n, k) of the angle from edge to core."""
        inwards, rise = part, np.zeros(part.shape)
        if self.bulge:
            phi = part * math.acos(CORE)
            inwards, rise = (1.0 - cos(phi)) / (1.0 - CORE), sin(phi) / math.sin(math.acos(CORE))
        away = (inner - loop)[:, None]
        along = np.stack([inwards, inwards, rise], axis=-1)
        return np.asarray(loop[:, None] + along * away)

    def _inner(self, plane: Floats, nose_factor: float, edge_factor: float) -> tuple[Floats, Floats, Floats]:
        """Return the long sides (k, 2) of the core from the trailing edge on, and half the thickness (k,)."""
        m = self.short
        k = len(plane) // 2 + 1
        upper, lower = plane[:k], plane[::-1][:k]
        camber, half = 0.5 * (upper + lower), 0.5 * (upper - lower)
        nose, edge = camber[-1], camber[0]
        axis = edge - nose
        length = float(np.hypot(*axis))
        along = np.maximum.accumulate((product(camber - nose, axis) / length**2)[::-1])[::-1]
        front, back = along[-1 - m], along[m]
        thick = 2.0 * np.hypot(*half.T) / length
        first = nose_factor * _CLEAR * max(front, _NOSE * thick[-1 - m])
        last = 1.0 - edge_factor * max(_CLEAR * (1.0 - back), _EDGE * thick[m])
        rising = along[::-1]
        places = first + (last - first) * (along[m : len(along) - m] - front) / (back - front)
        if len(places) > _MANY:
            cell = _CELL * CORE / (2 * m) * float(np.interp(first, rising, thick[::-1]))
            shifted = _shifted(rising[m : len(rising) - m], first, cell)
            places = last - (last - first) * ((back - shifted) / (back - first))[::-1]

        def at(values: Floats) -> Floats:
            return np.stack([np.interp(places, rising, column[::-1]) for column in values.T], axis=1)

        middle, across = at(camber), at(half)
        return middle + CORE * across, middle - CORE * across, np.hypot(*across.T)

    def connections(self, n: int, ring: int, core: int) -> tuple[Connection, ...]:
        """Return the connections that close a wing tip: of the ring to itself, and of the ring to the core.

        `ring` and `core` are the indices of these blocks; `n` is the number of nodes around the ring.
        """
        m, half = self.short, (n - 1) // 2
        whole = ((0, self.rows),)
        parts = (
            ((m, half - m), "south", (0, half - 2 * m), 1),
            ((half - m, half + m), "east", (0, 2 * m), 1),
            ((half + m, n - 1 - m), "north", (0, half - 2 * m), -1),
            ((n - 1 - m, n - 1), "west", (m, 2 * m), -1),
            ((0, m), "west", (0, m), -1),
        )
        seam = Connection(ring, "west", whole, ring, "east", whole, (1,))
        joined = (
            Connection(ring, "north", (own,), core, side, (donor,), (way,))  # type: ignore[arg-type]
            for own, side, donor, way in parts
        )
        return seam, *joined


def _shifted(places: Floats, first: float, cell: float) -> Floats:
    """Return increasing `places` (k,) from `first`, with a first step of about `cell`.

    Steps are shortened by a factor that decays over as many steps as make up for the later start.
    """
    steps = np.diff(places)
    off, ratio = first - places[0], min(max(cell / steps[0], _SHORTER), 1.0)
    if off <= 0.0 or ratio == 1.0:
        return np.asarray(first + (places[-1] - first) * (places - places[0]) / (places[-1] - places[0]))
    number = np.arange(len(steps))
    low, high = 0.0, 0.5 * len(steps)
    for _ in range(_HALVINGS):
        reach = 0.5 * (low + high)
        gained = (steps * (1.0 - power(ratio, np.clip(1.0 - number / reach, 0.0, None)))).sum()
        low, high = (reach, high) if gained < off else (low, reach)
    reach = max(low, _REACH)
    made = steps * power(ratio, np.clip(1.0 - number / reach, 0.0, None))
    weight = steps * np.clip(number / reach, 0.0, 1.0)
    made += (steps.sum() - off - made.sum()) * weight / weight.sum()
    return first + np.concatenate([[0.0], np.cumsum(made)])


def least_sine(nodes: Floats) -> float:
    """Return the smallest sine of a cell's corner angles in a patch (n, m, 3); negative: a cell faces -z."""
    least = 1.0
    along, across = np.diff(nodes, axis=0), np.diff(nodes, axis=1)
    for a in (along[:, :-1], along[:, 1:]):
        for b in (across[:-1], across[1:]):
            normal = np.cross(a, b)
            sine = np.copysign(norms(normal), normal[..., 2]) / (norms(a) * norms(b))
            least = min(least, float(sine.min()))
    return least


def _edge(core: Floats, k: int = 0) -> Floats:
    """Return the nodes around a core (., ., 3), or k layers inside, in the order of its ring."""
    m, last = core.shape[1] // 2, -1 - k
    west, east = core[k], core[last]
    return np.concatenate([west[m::-1], core[1:, k], east[1:], core[-2::-1, last], west[-2 : m - 1 : -1]])
