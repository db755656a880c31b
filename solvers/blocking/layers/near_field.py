"""A distant outer loop, and the smaller circle that replaces it during the decomposition."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.elementary import arctan2, cos, exp, log, sin
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.geometry.spacing.growth import growing_steps
from meshonet.solvers.blocking.decomposition.symmetry.mirrors import mirrors_of
from meshonet.solvers.blocking.layers.attach import Rows
from meshonet.solvers.layers.even_line import evened_steps
from meshonet.solvers.layers.layer_settings import LayerSettings

FAR = 4.0  # distance of an outer loop, in radii of the circle around all bodies, from which on it is distant
NEAR = 2.2  # radius of the circle that replaces it, relative to the circle around all bodies
_POINTS = 240  # of the circle, a spline through them
_EVEN = 1.1  # largest ratio of the first cells of neighbouring rows
_UNLIKE = 1.2  # largest ratio of the first cell of a row to the mean
_OWN = 0.5  # part of a row beyond which its cells are like those of the other rows
GROWTH = 1.18  # of cells in rows to the far field


@dataclass(frozen=True, eq=False)
class NearField:
    """A circle around the bodies, and the outer loop in polar coordinates about the circle's centre.

    `angles` (n,) ascend over one turn. `radii` (n,) are the distances of the outer loop at these angles,
    `arcs` (n,) its arc lengths there.
    """

    circle: Loop
    centre: Floats
    radius: float
    outer: Loop
    angles: Floats
    radii: Floats
    arcs: Floats

    @classmethod
    def of(cls, domain: Domain) -> Self | None:
        """Return the region near bodies; None unless the outer loop is distant, smooth and star-shaped."""
        outer = domain.loops[0]
        if len(domain.loops) < 2 or outer.corners:
            return None
        bodies = np.concatenate([loop.curve.points for loop in domain.loops[1:]])
        centre, mirrors = 0.5 * (bodies.min(axis=0) + bodies.max(axis=0)), mirrors_of(domain)
        if mirrors:
            centre = mirrors[0].centre if mirrors[1:] else 0.5 * (centre + mirrors[0].images(centre))
        reach = float(np.hypot(*(bodies - centre).T).max())
        arcs = np.linspace(0.0, outer.length, 8 * _POINTS, endpoint=False)
        away = outer.at(arcs) - centre
        radii = np.hypot(*away.T)
        if radii.min() < FAR * reach:
            return None
        angles = np.unwrap(arctan2(away[:, 1], away[:, 0]))
        if (np.diff(angles) <= 0).any():
            return None
        turn = 2.0 * math.pi * np.arange(_POINTS) / _POINTS
        if mirrors:  # from a mirror on
            turn += math.atan2(mirrors[0].along[1], mirrors[0].along[0])
        points = centre + NEAR * reach * np.stack([cos(turn), sin(turn)], axis=1)
        curve = Curve(points, closed=True, corners=())
        circle = Loop(curve, (), outer.names[:1])
        return cls(circle, centre, NEAR * reach, outer, angles, radii, arcs)

    def cells(self, first: float, settings: LayerSettings) -> int:
        """Return the number of cells on a line from the circle around the bodies to the outer boundary.

        `first` is the height of the cells just inside the circle.
        """
        growth, multiple = settings.below(GROWTH), settings.multiple
        distance = float(self.radii.mean()) - self.radius
        cells = max(2, math.ceil(math.log1p(distance / first * (growth - 1.0)) / math.log(growth)))
        return -(-cells // multiple) * multiple

    def rows(self, mesh: QuadMesh, heights: Floats, settings: LayerSettings) -> Rows:
        """Return nodes on straight lines from the circle around the bodies to the outer boundary.

        The circle is loop 0 of `mesh`. `heights` (k,) are those of the k cells that touch it from inside.
        """
        order = mesh.places.along(0)
        start = mesh.nodes[order]
        away = start - self.centre
        angle = arctan2(away[:, 1], away[:, 0])
        angle = self.angles[0] + np.mod(angle - self.angles[0], 2.0 * math.pi)
        closed = np.append(self.angles, self.angles[0] + 2.0 * math.pi)
        arcs = np.interp(angle, closed, np.append(self.arcs, self.arcs[0] + self.outer.length))
        end = self.outer.at(arcs)
        length = np.hypot(*(end - start).T)
        wanted = evened_steps(heights, math.log(_EVEN)) * math.sqrt(settings.below(GROWTH))
        mean = math.exp(log(wanted).mean())
        wanted = np.clip(wanted, mean / _UNLIKE, _UNLIKE * mean)
        cells = self.cells(mean, settings)
        whole = np.stack([_shares(first, cells) for first in (mean / length).tolist()])
        # each row begins with its own cell and becomes like the others, so that angles stay right
        own = np.clip(1.0 - np.arange(cells) / (_OWN * cells), 0.0, 1.0) ** 2
        step = np.diff(whole, axis=1) * exp(log(wanted / mean)[:, None] * own)
        rest = 1.0 - step[:, own > 0.0].sum(axis=1)
        step[:, own == 0.0] *= (rest / step[:, own == 0.0].sum(axis=1))[:, None]
        share = np.concatenate([np.zeros((len(step), 1)), np.cumsum(step, axis=1)], axis=1)
        nodes = start[:, None] + share[..., None] * (end - start)[:, None]
        nodes[:, -1] = end
        return Rows(0, nodes, np.mod(arcs, self.outer.length), False)


def _shares(first: float, cells: int) -> Floats:
    """Return fractions (cells + 1,) of a length, in cells that grow from `first` by one ratio."""
    equal = first * cells >= 1.0
    steps = np.full(cells, 1.0 / cells) if equal else growing_steps(first, 1.0, cells)
    return np.concatenate([[0.0], np.cumsum(steps) / steps.sum()])
