r"""The cap on the end of a wing: a ring along the edge of the last section, and a core inside it.

::

      upper side               m cells on each side of the trailing and of the leading edge end at the two
     .-------------------.     short sides of the core, the others at its long ones: no corner of a cell is
    /|   ring            |\    wider than it must be. A core that fills the whole section has corners of
    ||  .-------------.  ||    160 degrees at both edges, and a surface without one ends in a line of nodes
   LE|  |    core     |  |TE   where cells of the volume have corners of 180.
    ||  '-------------'  ||
    \|                   |/    The core reaches across the middle half of the thickness. A round cap stands
     '-------------------'     as high over every place as the section is thick there: half an ellipse.
      lower side
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.elementary import cos, product, sin

CORE = 0.5
"""Part of the thickness that the core reaches across."""
_CLEAR = 1.3  # by which the core stays farther from nose and edge than the nodes that face its ends
_NOSE, _EDGE = 0.35, 0.4  # and at least so many thicknesses of the section there


@dataclass(frozen=True)
class Cap:
    """How a tip is closed.

    Parameters
    ----------
    short : cells on each side of an edge that end at a short side of the core.
    rows : cells of the ring, from the section's edge to the core.
    bulge : height over the height of a half circle on the section; 0 is flat.
    """

    short: int = 4
    rows: int = 6
    bulge: float = 1.0

    def first_row(self, loop: Floats) -> float:
        """Return the width of the outermost cells where the section `loop` (n, 2) is thickest."""
        half = 0.5 * float(norms(_sides(loop)[1]).max()) * 2.0
        return half * (math.acos(CORE) * max(self.bulge, 0.3) if self.bulge else 1.0 - CORE) / self.rows

    def patches(self, loop: Floats) -> tuple[Floats, Floats]:
        """Return nodes of the ring (n, rows + 1, 3) and of the core (n // 2 - 2 short + 1, 2 short + 1, 3).

        The `loop` (n, 3), closed, lies in a plane of constant z and runs from the trailing edge over the
        upper side; the cap stands above it. Both patches turn their outer side to +z.
        """
        plane, m = loop[:, :2], self.short
        upper, lower, half = self._inner(plane)
        b = np.linspace(0.0, 1.0, 2 * m + 1)[None, :]
        across = (1.0 - b[..., None]) * upper[:, None] + b[..., None] * lower[:, None]
        height = self.bulge * half[:, None] * np.sqrt(1.0 - (CORE * (1.0 - 2.0 * b)) ** 2)
        core = np.concatenate([across, loop[0, 2] + height[..., None]], axis=-1)
        inner = _edge(core)
        phi = np.linspace(0.0, math.acos(CORE), self.rows + 1)
        if self.bulge:
            inwards, rise = (1.0 - cos(phi)) / (1.0 - CORE), sin(phi) / sin(phi[-1])
        else:
            inwards, rise = np.linspace(0.0, 1.0, self.rows + 1), np.zeros(self.rows + 1)
        ring = np.empty((len(loop), self.rows + 1, 3))
        ring[..., :2] = plane[:, None] + inwards[:, None] * (inner[:, None, :2] - plane[:, None])
        ring[..., 2] = loop[:, None, 2] + rise * (inner[:, None, 2] - loop[:, None, 2])
        ring[:, 0], ring[:, -1] = loop, inner
        return ring, core

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
        """Return where the numbered blocks of a ring of `n` nodes around and of its core touch themselves."""
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


def _edge(core: Floats) -> Floats:
    """Return the nodes around a core (k, l, 3) in the order of its ring, from the middle of its west side."""
    m = core.shape[1] // 2
    return np.concatenate(
        [core[0, m::-1], core[1:, 0], core[-1, 1:], core[-2::-1, -1], core[0, -2 : m - 1 : -1]]
    )
