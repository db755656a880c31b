r"""The cap of a wing tip: a ring along the edge of the last section, and a core inside it.

::

      upper side               m cells on each side of the trailing and of the leading edge end at the two
     .-------------------.     short sides of the core, all others at its long sides, which keeps angles
    /|   ring            |\    small. A core that fills the whole section would have angles of 160 degrees
    ||  .-------------.  ||    at both edges. A surface without core would end in a line of nodes, where
   LE|  |    core     |  |TE   cells of the volume have angles of 180 degrees.
    ||  '-------------'  ||
    \|                   |/    The core covers the middle half of the thickness. The height of a round cap at
     '-------------------'     each point is half the local thickness of the section: half an ellipse.
      lower side
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.elementary import cos, product, sin
from meshonet.solvers.sweeping.ring_steps import ring_steps

CORE = 0.5
"""Fraction of the thickness that the core covers."""
ROWS = 6
"""Number of rows of the ring."""
_EVEN = 1.12  # ratio of the last cells of the ring and those of the core, which needs not be 1
_RATIO = 1.5  # of neighbouring rows of the ring, at the most
_FINE = 65  # places on each line of the ring by which its length is measured
_CLEAR = 1.3  # by which the core stays farther from nose and edge than the nodes that face its ends
_NOSE, _EDGE = 0.35, 0.3  # and at least so many thicknesses of the section there


@dataclass(frozen=True)
class Cap:
    """How a tip is closed.

    Parameters
    ----------
    short : number of cells on each side of an edge that end at a short side of the core.
    rows : number of cells of the ring from the section's edge to the core; they grow by a constant ratio.
    bulge : height relative to that of a half circle over the section; 0 is flat.
    """

    short: int = 4
    rows: int = ROWS
    bulge: float = 1.0

    def patches(self, loop: Floats) -> tuple[Floats, Floats]:
        """Return nodes of the ring (n, rows + 1, 3) and of the core (n // 2 - 2 short + 1, 2 short + 1, 3).

        The closed `loop` (n, 3) is in a plane of constant z and runs from the trailing edge along the upper
        side first. The cap is above it; the normals of both patches point to +z.
        """
        plane, m = loop[:, :2], self.short
        upper, lower, half = self._inner(plane)
        b = np.linspace(0.0, 1.0, 2 * m + 1)[None, :]
        across = (1.0 - b[..., None]) * upper[:, None] + b[..., None] * lower[:, None]
        height = self.bulge * half[:, None] * np.sqrt(1.0 - (CORE * (1.0 - 2.0 * b)) ** 2)
        core = np.concatenate([across, loop[0, 2] + height[..., None]], axis=-1)
        return self._ring(loop, core), core

    def _ring(self, loop: Floats, core: Floats) -> Floats:
        """Return the nodes (n, rows + 1, 3) between the edges of section and core."""
        inner = _edge(core)
        sizes = norms(_edge(core, 1) - inner)
        m, half = self.short, (len(loop) - 1) // 2
        corners = np.array([m, half - m, half + m, len(loop) - 1 - m])  # no line runs on from these
        sizes[corners] = 0.5 * (sizes[corners - 1] + sizes[corners + 1])
        part = np.linspace(0.0, 1.0, _FINE)
        fine = norms(np.diff(self._lines(loop, inner, np.broadcast_to(part, (len(loop), _FINE))), axis=1))
        away = np.concatenate([np.zeros((len(loop), 1)), np.cumsum(fine, axis=1)], axis=1)
        length = away[:, -1]
        ends = np.clip(length / self.rows, sizes / _EVEN, sizes * _EVEN)
        shares = [1.0 / sum(math.pow(ratio, k) for k in range(self.rows)) for ratio in (_RATIO, 1.0 / _RATIO)]
        ends = np.clip(ends, shares[0] * length, shares[1] * length)
        places = np.cumsum(ring_steps(length, ends, self.rows, None), axis=1)
        parts = [np.interp(places[k, :-1], away[k], part) for k in range(len(loop))]
        ring = np.empty((len(loop), self.rows + 1, 3))
        ring[:, 1:-1] = self._lines(loop, inner, np.stack(parts))
        ring[:, 0], ring[:, -1] = loop, inner
        ring[-1] = ring[0]
        return ring

    def _lines(self, loop: Floats, inner: Floats, part: Floats) -> Floats:
        """Return the points (n, k, 3) at the fraction `part` (n, k) of the angle from edge to core."""
        inwards, rise = part, np.zeros(part.shape)
        if self.bulge:
            phi = part * math.acos(CORE)
            inwards, rise = (1.0 - cos(phi)) / (1.0 - CORE), sin(phi) / math.sin(math.acos(CORE))
        away = (inner - loop)[:, None]
        along = np.stack([inwards, inwards, rise], axis=-1)
        return np.asarray(loop[:, None] + along * away)

    def _inner(self, plane: Floats) -> tuple[Floats, Floats, Floats]:
        """Return the long sides (k, 2) of the core from the trailing edge on, and half the thickness (k,)."""
        m = self.short
        camber, half = _sides(plane)
        nose, edge = camber[-1], camber[0]
        axis = edge - nose
        length = float(np.hypot(*axis))
        along = np.maximum.accumulate((product(camber - nose, axis) / length**2)[::-1])[::-1]
        front, back = along[-1 - m], along[m]
        thick = 2.0 * np.hypot(*half.T) / length
        first = _CLEAR * max(front, _NOSE * thick[-1 - m])
        last = 1.0 - max(_CLEAR * (1.0 - back), _EDGE * thick[m])
        places = first + (last - first) * (along[m : len(along) - m] - front) / (back - front)
        rising = along[::-1]

        def at(values: Floats) -> Floats:
            return np.stack([np.interp(places, rising, column[::-1]) for column in values.T], axis=1)

        middle, across = at(camber), at(half)
        return middle + CORE * across, middle - CORE * across, np.hypot(*across.T)

    def connections(self, n: int, ring: int, core: int) -> tuple[Connection, ...]:
        """Return the connections of the blocks `ring`, with `n` nodes around, and `core`."""
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


def _sides(plane: Floats) -> tuple[Floats, Floats]:
    """Return the camber line (k, 2) from trailing edge to nose, and vectors from it to the upper side."""
    k = len(plane) // 2 + 1
    upper, lower = plane[:k], plane[::-1][:k]
    return 0.5 * (upper + lower), 0.5 * (upper - lower)


def _edge(core: Floats, k: int = 0) -> Floats:
    """Return the nodes around a core (., ., 3) in the order of its ring, from the middle of its west side.

    With `k`, they are the nodes k layers further inside.
    """
    m, last = core.shape[1] // 2, -1 - k
    west, east = core[k], core[last]
    return np.concatenate([west[m::-1], core[1:, k], east[1:], core[-2::-1, last], west[-2 : m - 1 : -1]])
