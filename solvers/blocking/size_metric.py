"""How long edges should be: at each place and in each direction, from what walls and fronts ask for."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats

GRADING = 0.13
"""How fast edges may grow with the distance from a wall."""
_ROWS = 2048


@dataclass(frozen=True, eq=False)
class SizeMetric:
    """Lengths of edges, across and along walls; between these the axes of an ellipse.

    Parameters
    ----------
    points : (n, 2) places on walls and fronts.
    normals : (n, 2) unit normals there.
    across, along : (n,) lengths of edges in their direction and in the other.
    largest : the length of edges far from all of them.
    grading : by how much lengths grow with the distance.
    scale : of a conformal map, how much longer (n,) edges at places (n, 2) of its plane are; lengths and
        distances above are those before the map, places, points and directions those behind it.
    """

    points: Floats
    normals: Floats
    across: Floats
    along: Floats
    largest: float
    grading: float = GRADING
    scale: Callable[[Floats], Floats] | None = None

    @classmethod
    def joined(cls, metrics: Sequence[SizeMetric]) -> SizeMetric:
        """Return what several ask for together."""
        fields = ("points", "normals", "across", "along")
        arrays = (np.concatenate([getattr(each, name) for each in metrics]) for name in fields)
        first = metrics[0]
        return cls(*arrays, min(each.largest for each in metrics), first.grading, first.scale)

    def length(self, places: Floats, directions: Floats) -> Floats:
        """Return the lengths (m,) of edges at `places` (m, 2) in `directions` (m, 2) of any length."""
        out = np.empty(len(places))
        for start in range(0, len(places), _ROWS):
            rows = slice(start, start + _ROWS)
            out[rows] = self._length(places[rows], directions[rows])
        return out

    def _length(self, places: Floats, directions: Floats) -> Floats:
        dx = places[:, :1] - self.points[:, 0]
        dy = places[:, 1:] - self.points[:, 1]
        squares = dx * dx + dy * dy
        k = np.argmin(squares, axis=1)
        distance = np.sqrt(squares[np.arange(len(k)), k])
        scale = np.ones(len(k)) if self.scale is None else self.scale(places)
        if self.scale is not None:
            distance = distance / np.sqrt(scale * self.scale(self.points)[k])
        normal = self.normals[k]
        size = np.hypot(directions[:, 0], directions[:, 1])
        cosine = np.abs((directions * normal).sum(axis=1)) / np.maximum(size, 1e-300)
        across = np.minimum(self.across[k] + self.grading * distance, self.largest)
        along = np.minimum(self.along[k] + self.grading * distance, self.largest)
        return np.asarray(scale / np.sqrt((cosine / across) ** 2 + (1.0 - cosine**2) / along**2))
