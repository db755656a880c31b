"""A body within a far-field curve that is part of the input."""

from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Floats, Topology
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.elementary import product
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.far_field import straight
from meshonet.geometry.shapes.shape import Shape
from meshonet.geometry.spacing.along_curve import stretch_arcs
from meshonet.geometry.spacing.sampling import Sampling


class Annulus:
    """A body, and the closed, clockwise curve of its far field."""

    topology: Topology = "o"

    def __init__(self, body: Shape, outer: Curve, name: str = "") -> None:
        self.body, self.outer, self.name = body, outer, name

    def boundary(self, sampling: Sampling) -> Boundary:
        """Return the boundary of an O grid from the body to the outer curve.

        Raises InputError for a far-field distance, a topology except "o", or settings for other bodies.
        """
        if sampling.far_field is not None:
            problem = "a domain with a boundary of its own has no far field"
            raise InputError(problem, "leave {far_field} out", source=self.name)
        if sampling.topology not in ("auto", "o"):
            raise InputError("a body in a far field makes an O grid", "use {topology} o", source=self.name)
        boundary = self.body.boundary(replace(sampling, topology="o"))
        north = self._around(boundary.north)
        cut = straight(boundary.south[0], north[0], boundary.nj)
        return replace(boundary, north=north, west=cut, east=cut)

    def _around(self, circle: Floats) -> Floats:
        """Return nodes (n, 2) of the outer curve in nearly equal steps, from the circle's start."""
        middle = 0.5 * (circle.max(axis=0) + circle.min(axis=0))
        wanted = (circle[0] - middle) / np.hypot(*(circle[0] - middle))
        arcs = np.linspace(0.0, self.outer.length, 2049)[:-1]
        off = self.outer.at(arcs) - middle
        first = float(arcs[int(np.argmax(product(off, wanted) / np.hypot(*off.T)))])
        steps = stretch_arcs(self.outer, first, first, len(circle) - 1, "uniform")
        nodes = self.outer.at(steps % self.outer.length)
        nodes[-1] = nodes[0]
        return nodes
