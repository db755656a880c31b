"""Names of edges in a file, transferred to the patches of the boundary that is sampled from them."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import groupby

import numpy as np

from meshonet.geometry.arrays import SIDES, Floats, Side
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.patches import Patch, kind_of
from meshonet.geometry.shapes.shape import Shape
from meshonet.geometry.spacing.sampling import Sampling

_BLOCK = 1 << 22  # distances computed at a time


class Labelled:
    """A shape with names of its straight `edges` (n, 2, 2); `names` (n,) other than "" become patch names.

    Edges with names in `walls` are walls unless the name implies another kind.
    """

    def __init__(self, shape: Shape, edges: Floats, names: Sequence[str], walls: Sequence[str] = ()) -> None:
        self.shape, self._edges, self._names, self._walls = shape, edges, tuple(names), walls

    @property
    def name(self) -> str:
        """Name of the shape in the input."""
        return self.shape.name

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes on the shape."""
        return getattr(self.shape, "notes", ())

    def boundary(self, sampling: Sampling) -> Boundary:
        """Return the boundary; pieces between two nodes get the name of the nearest edge, if one is near."""
        boundary = self.shape.boundary(sampling)
        sides: tuple[Side, ...] = ("south", "north") if boundary.around_body else SIDES
        patches = []
        for side in sides:
            nodes = getattr(boundary, side)
            near = self._nearest(0.5 * (nodes[1:] + nodes[:-1]))
            reach = float(np.hypot(*np.ptp(self._edges.reshape(-1, 2), axis=0)))
            names = [self._names[k] if gap < 0.01 * reach else "" for k, gap in near]
            patches += runs(side, names, self._walls)
        return replace(boundary, patches=tuple(patches))

    def _nearest(self, points: Floats) -> list[tuple[int, float]]:
        """Return index and distance of the edge nearest to each of `points` (m, 2)."""
        nearest: list[tuple[int, float]] = []
        start, along = self._edges[:, 0], self._edges[:, 1] - self._edges[:, 0]
        square = np.maximum((along**2).sum(axis=1), 1e-300)
        step = max(1, _BLOCK // len(self._edges))
        for first in range(0, len(points), step):
            off = points[first : first + step, None] - start
            t = np.clip((off * along).sum(axis=-1) / square, 0.0, 1.0)
            gap = np.hypot(*np.moveaxis(off - t[..., None] * along, -1, 0))
            k = gap.argmin(axis=1)
            nearest += zip(k.tolist(), gap[np.arange(len(k)), k].tolist(), strict=True)
        return nearest


def runs(side: Side, names: Sequence[str], walls: Sequence[str] = ()) -> list[Patch]:
    """Return the patches of a side from the `names` of its cells; cells named "" get the side's name.

    Patches with names in `walls` are walls unless the name implies another kind.

    >>> runs("south", ["wall", "wall", "slot"])
    [Patch(name='wall', side='south', start=0, stop=2), Patch(name='slot', side='south', start=2, stop=3)]
    """
    patches, start = [], 0
    for name, cells in groupby(names):
        stop = start + len(list(cells))
        kind = kind_of(name or side, "wall" if name in walls else "other")
        patches.append(Patch(name or side, side, start, stop, kind=kind))
        start = stop
    return patches
