"""Closed curves and polygons with holes as shapes."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.domain.periodic import with_periodic_sides
from meshonet.geometry.domain.ring import ring_loop
from meshonet.geometry.errors import in_place
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.annulus import Annulus
from meshonet.geometry.shapes.closed_curve import closed_curve
from meshonet.geometry.shapes.domain_shape import (
    DomainShape,
    convex_corners,
    four_sided,
    in_far_field,
    itself,
)
from meshonet.geometry.shapes.named_edges import Labelled
from meshonet.geometry.shapes.outline import Outline
from meshonet.geometry.shapes.shape import Shape


@dataclass(frozen=True)
class PolygonRing:
    """A closed polygon (n, 2)."""

    points: Floats
    corners: Sequence[int] | None = None  # indices of points; None: detected by the turning angle
    names: Sequence[str] = ()  # one name, or one for each part between corners; none: `default_name`
    places: Sequence[str] = ()  # line of each point in the file, for messages


def polygon_shape(
    rings: Sequence[PolygonRing], name: str = "", notes: tuple[str, ...] = (),
    periodic: Sequence[tuple[str, str]] = (),
) -> DomainShape:  # fmt: skip
    """Return the domain inside the first ring of `rings` and outside all other rings.

    `periodic` names pairs of periodic sides. Raises InputError: as `ring_loop` and `with_periodic_sides`.
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
        with_corners = rings[0].corners is not None
        return DomainShape(
            domain, not four_sided(domain), partial(_outline, domain, named=named, with_corners=with_corners)
        )
    if len(loops) == 2:
        return DomainShape(domain, not in_far_field(domain), partial(_annulus, domain, named=named))
    return DomainShape(domain)


def domain_or_body(shape: Outline | Airfoil) -> Shape:
    """Return the domain inside `shape` if it has over four corners, at least four convex; else `shape`."""
    if isinstance(shape, Airfoil) or shape.topology != "quad":
        return shape
    points = shape.curve.points
    domain = Domain((ring_loop(points, hole=False),), shape.name, shape.notes)
    return shape if four_sided(domain) else DomainShape(domain, one=partial(itself, shape))


def default_name(number: int) -> str:
    """Return the default name of the loop with index `number`.

    >>> [default_name(number) for number in range(3)]
    ['outer', 'body', 'body2']
    """
    return "outer" if number == 0 else "body" if number == 1 else f"body{number}"


def _outline(domain: Domain, *, named: bool, with_corners: bool) -> Shape:
    loop, corners = domain.loops[0], None
    if with_corners and four_sided(domain):
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
