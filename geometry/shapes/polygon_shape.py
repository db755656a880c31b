"""Closed curves and polygons with holes as shapes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from meshonet.geometry.arrays import Floats, Topology, ends_meet
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.domain.periodic import with_periodic_sides
from meshonet.geometry.domain.ring import ring_loop
from meshonet.geometry.elementary import product
from meshonet.geometry.errors import InputError, in_place
from meshonet.geometry.polygon.area import polygon_area
from meshonet.geometry.polygon.corners import find_corners, turning
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.domain_shape import (
    DomainShape,
    convex_corners,
    four_sided,
    in_far_field,
    itself,
)
from meshonet.geometry.shapes.far_field import straight
from meshonet.geometry.shapes.named_edges import Labelled
from meshonet.geometry.shapes.outline import Outline
from meshonet.geometry.shapes.shape import Shape
from meshonet.geometry.spacing.along_curve import stretch_arcs
from meshonet.geometry.spacing.sampling import Sampling


@dataclass(frozen=True)
class PolygonRing:
    """A closed polygon of a file: points (n, 2), corners, names, and positions of the points in the file.

    If `corners` is None, they are detected; if `names` is empty, the polygon gets the default names.
    """

    points: Floats
    corners: Sequence[int] | None = None
    names: Sequence[str] = ()
    places: Sequence[str] = ()


def polygon_shape(
    rings: Sequence[PolygonRing], name: str = "", notes: tuple[str, ...] = (),
    periodic: Sequence[tuple[str, str]] = (),
) -> DomainShape:  # fmt: skip
    """Return the domain inside the first of the `rings` and outside of the others.

    `periodic` are pairs of names of periodic sides.

    Raises InputError: the errors of `ring_loop`, with the number of the ring if there are several; the errors
    of `with_periodic_sides`.
    """
    loops = []
    for number, ring in enumerate(rings):
        names = ring.names or (default_name(number),)
        with in_place(f"ring {number + 1}" if len(rings) > 1 else ""):
            loops.append(
                ring_loop(ring.points, hole=number > 0, corners=ring.corners, names=names, places=ring.places)
            )
    domain = with_periodic_sides(Domain(tuple(loops), name, notes), periodic)
    if periodic:
        return DomainShape(domain)
    named = any(ring.names for ring in rings)
    if len(loops) == 1:
        given = rings[0].corners is not None
        return DomainShape(
            domain, not four_sided(domain), partial(_outline, domain, named=named, given=given)
        )
    if len(loops) == 2:
        return DomainShape(domain, not in_far_field(domain), partial(_annulus, domain, named=named))
    return DomainShape(domain)


def domain_or_body(shape: Outline | Airfoil) -> Shape:
    """Return a closed curve unchanged; if it has corners, but not four, the domain inside it."""
    if isinstance(shape, Airfoil) or shape.topology != "quad":
        return shape
    points = shape.curve.points
    domain = Domain((ring_loop(points, hole=False),), shape.name, shape.notes)
    return shape if four_sided(domain) else DomainShape(domain, one=partial(itself, shape))


def default_name(number: int) -> str:
    """Return the default name of a loop.

    >>> [default_name(number) for number in range(3)]
    ['outer', 'body', 'body2']
    """
    return "outer" if number == 0 else "body" if number == 1 else f"body{number}"


def _outline(domain: Domain, *, named: bool, given: bool) -> Shape:
    loop, corners = domain.loops[0], None
    if given and four_sided(domain):
        a, b, c, d = convex_corners(loop)
        corners = (a, b, c, d)
    outline = Outline(loop.curve.points, domain.name, corners, loop.places)
    return _labelled(outline, domain.loops) if named else outline


def _annulus(domain: Domain, *, named: bool) -> Shape:
    outer, hole = (loop.curve.points for loop in domain.loops)
    body = closed_curve(hole, domain.name, domain.loops[1].places)
    shape = Annulus(body, Outline(outer[::-1], domain.name).curve, domain.name)
    return _labelled(shape, domain.loops) if named else shape


def _labelled(shape: Shape, loops: Sequence[Loop]) -> Shape:
    """Return a shape whose patches have the names of the loops that it follows."""
    ends, names = [], []
    for loop in loops:
        points = loop.curve.points
        ends.append(np.stack([points, np.roll(points, -1, axis=0)], axis=1))
        knots = np.append(loop.curve.knots, loop.length)
        names += [loop.name_at(float(middle)) for middle in 0.5 * (knots[1:] + knots[:-1])]
    return Labelled(shape, np.concatenate(ends), names)


def closed_curve(points: Floats, name: str, places: Sequence[str] = ()) -> Outline | Airfoil:
    """Return the airfoil or the outline through `points` (n, 2), without repeated neighbours.

    `places` are the places of the points in their source, for messages.
    """
    keep = np.concatenate([[True], (np.diff(points, axis=0) != 0).any(axis=1)])
    if ends_meet(points):
        keep[-1] = len(points) < 3
    points, places = points[keep], [place for place, kept in zip(places, keep, strict=False) if kept]
    if len(points) < 3:
        raise InputError(f"{len(points)} points", "a closed curve needs at least 3")
    if _ends_in_one_edge(points):
        return Airfoil(points, name, places)
    return Outline(points, name, places=places)


def _ends_in_one_edge(points: Floats) -> bool:
    """Return whether a curve (n, 2) is slender, with one corner, or the two of a base, at one end."""
    if len(points) < 10:
        return False
    turn = np.abs(turning(points, closed=True))
    corners = find_corners(points, closed=True, few=0)
    sharp = corners[turn[corners] > np.radians(60.0)]
    if not 1 <= len(sharp) <= 2 or turn[sharp].sum() < np.radians(120.0):
        return False
    edge = points[sharp].mean(axis=0)
    length = float(np.hypot(*(points - edge).T).max())
    base = float(np.hypot(*np.ptp(points[sharp], axis=0)))
    area = abs(polygon_area(points))
    return base < 0.25 * length and area < 0.5 * length**2


class Annulus:
    """A body and the closed, clockwise curve of its far field."""

    topology: Topology = "o"

    def __init__(self, body: Shape, outer: Curve, name: str = "") -> None:
        self.body, self.outer, self.name = body, outer, name

    def boundary(self, sampling: Sampling) -> Boundary:
        """Return the O boundary: the body sampled as usual, with the given far field in place of a circle.

        Raises InputError: another topology, or a setting that does not apply to the body.
        """
        if sampling.topology not in ("auto", "o"):
            raise InputError("a body in a far field makes an O grid", "use {topology} o", source=self.name)
        boundary = self.body.boundary(replace(sampling, topology="o"))
        north = self._around(boundary.north)
        cut = straight(boundary.south[0], north[0], boundary.nj)
        return replace(boundary, north=north, west=cut, east=cut)

    def _around(self, circle: Floats) -> Floats:
        """Return nodes (n, 2) of the outer curve in nearly equal steps, from where the circle begins."""
        middle = 0.5 * (circle.max(axis=0) + circle.min(axis=0))
        wanted = (circle[0] - middle) / np.hypot(*(circle[0] - middle))
        arcs = np.linspace(0.0, self.outer.length, 2049)[:-1]
        off = self.outer.at(arcs) - middle
        first = float(arcs[int(np.argmax(product(off, wanted) / np.hypot(*off.T)))])
        steps = stretch_arcs(self.outer, first, first, len(circle) - 1, "uniform")
        nodes = self.outer.at(steps % self.outer.length)
        nodes[-1] = nodes[0]
        return nodes
