"""Several shapes as one domain: bodies in a far field, or within the shape that encloses the others."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from itertools import chain

import numpy as np

from meshonet.geometry.arrays import SIDES, Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop, turns_sharply
from meshonet.geometry.domain.nesting import nested
from meshonet.geometry.domain.ring import ring_loop
from meshonet.geometry.elementary import cos, sin
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import polygon_area
from meshonet.geometry.polygon.corners import turning
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.airfoil.section_curve import DEPARTURE, edge_notes, wall_departure
from meshonet.geometry.shapes.annulus import Annulus
from meshonet.geometry.shapes.domain_shape import DomainShape, itself, loops_extent
from meshonet.geometry.shapes.named_edges import Labelled
from meshonet.geometry.shapes.outline import Outline
from meshonet.geometry.shapes.shape import Shape
from meshonet.geometry.spacing.sampling import Sampling

CIRCLE = 256  # number of points of the spline of a far field
FARFIELD = "farfield"


def assembled(
    shapes: Sequence[Shape], names: Sequence[str], sampling: Sampling, name: str = ""
) -> DomainShape:
    """Return the domain that `shapes` form together; `names` has a name for each.

    Airfoils keep their smooth curves; other shapes become polygons. The outer boundary is the shape that
    encloses all others, or else a circle with the radius `sampling.radius` times the extent of all shapes.
    Raises InputError: shapes that are not closed curves; a far field although a shape encloses all others.
    """
    _check_airfoils(shapes, sampling)
    as_asked = [_as_asked(shape, sampling) for shape in shapes]
    bodies = list(chain(*(_bodies(shape, label) for (shape, _), label in zip(as_asked, names, strict=True))))
    groups = nested([body.curve.points for body in bodies])
    several = len(shapes) > 1
    texts = [
        type(note)(f"{label}: {note}") if several else note
        for (_, own), label in zip(as_asked, names, strict=True)
        for note in own
    ]
    notes = tuple(dict.fromkeys(texts))
    if len(groups) == 1 and len(bodies) > 1:
        outer, holes = groups[0]
        if len(holes) < len(bodies) - 1:
            raise InputError("bodies lie within bodies", "give one loop that encloses the others, or none")
        if sampling.far_field is not None:
            raise InputError(f"{bodies[outer].names[0]} encloses the others", "leave {far_field} out")
        others = (_facing(body, hole=True) for k, body in enumerate(bodies) if k != outer)
        loops = (_facing(bodies[outer], hole=False), *others)
        return DomainShape(Domain(loops, name, notes), unit=loops_extent(loops[1:]), assembled=True)
    if any(holes for _, holes in groups):
        raise InputError("some bodies lie within others", "give one loop that encloses the others, or none")
    loops = tuple(_facing(body, hole=True) for body in bodies)
    unit = shapes[0].unit if len(shapes) == 1 and isinstance(shapes[0], Airfoil) else loops_extent(loops)
    points = np.concatenate([loop.curve.points for loop in loops])
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    circle = far_loop(middle, sampling.radius * loops_extent(loops))
    return DomainShape(Domain((circle, *loops), name, notes), unit=unit, far_field=True, assembled=True)


def _check_airfoils(shapes: Sequence[Shape], sampling: Sampling) -> None:
    """Raise InputError for fields that only airfoils use, if none of the shapes is one."""
    bodies = [shape.body if isinstance(shape, Annulus) else shape for shape in shapes]
    bodies = [body.shape if isinstance(body, Labelled) else body for body in bodies]
    if not any(isinstance(body, Airfoil) for body in bodies):
        sampling.check_airfoil("")


def domain_of(shape: Shape, sampling: Sampling) -> DomainShape:
    """Return the domain inside a shape, or in the far field around it. Raises InputError: no closed curve."""
    if isinstance(shape, DomainShape):
        if not shape.assembled:
            _check_airfoils([shape], sampling)
        return shape
    _check_airfoils([shape], sampling)
    if isinstance(shape, Boundary) and shape.topology == "quad":
        loop = _edges_loop(shape)
    elif isinstance(shape, Outline) and sampling.topology.replace("auto", shape.topology) == "quad":
        loop = ring_loop(shape.curve.points, hole=False, corners=shape.corners)
    else:
        return assembled([shape], ["body"], sampling, shape.name)
    notes = tuple(getattr(shape, "notes", ()))
    return DomainShape(Domain((loop,), shape.name, notes), one=partial(itself, shape))


def far_loop(middle: Floats, radius: float) -> Loop:
    """Return the circle around the point `middle` (2,), as a loop with the domain inside."""
    angle = np.linspace(0.0, 2.0 * np.pi, CIRCLE, endpoint=False)
    points = middle + radius * np.stack([cos(angle), sin(angle)], axis=1)
    return Loop(Curve(points, closed=True, corners=()), names=(FARFIELD,))


def _as_asked(shape: Shape, sampling: Sampling) -> tuple[Shape, tuple[str, ...]]:
    """Return the shape with airfoils as `sampling` has them, and its notes."""
    if isinstance(shape, Annulus):
        body, notes = _as_asked(shape.body, sampling)
        return Annulus(body, shape.outer, shape.name), notes
    if isinstance(shape, Labelled):
        return _as_asked(shape.shape, sampling)
    if not isinstance(shape, Airfoil):
        return shape, tuple(getattr(shape, "notes", ()))
    airfoil = shape.prepared(sampling)
    te, off = sampling.te, airfoil.curve.departure() / airfoil.chord
    body = airfoil.rounded() if te == "round" else airfoil.wedged() if te == "wedge" else airfoil
    departure = (wall_departure(off),) if off > DEPARTURE else ()
    return body, (*airfoil.notes, *departure, *edge_notes(airfoil, body, te, te))


def _bodies(shape: Shape, name: str) -> list[Loop]:
    """Return the loops of a shape, called `name` if it has no names."""
    if isinstance(shape, Airfoil):
        return [_section_loop(shape, name)]
    if isinstance(shape, Outline):
        return [ring_loop(shape.curve.points, hole=True, corners=shape.corners, names=(name,))]
    if isinstance(shape, DomainShape):
        loops = list(shape.domain.loops)
        unnamed = len(loops) == 1 and loops[0].names == ("outer",)
        return [replace(loops[0], names=(name,))] if unnamed else loops
    if isinstance(shape, Annulus):
        return [ring_loop(shape.outer.points, hole=False), *_bodies(shape.body, name)]
    if isinstance(shape, Boundary) and shape.topology == "quad":
        return [_edges_loop(shape)]
    if isinstance(shape, Boundary) and shape.topology == "o":
        return [
            ring_loop(shape.north, hole=False, names=(FARFIELD,)),
            ring_loop(shape.south, hole=True, names=("wall",)),
        ]
    raise InputError(f"{shape.name or 'a shape'} is no closed curve", "give outlines, airfoils or polygons")


def _section_loop(airfoil: Airfoil, name: str) -> Loop:
    curve = airfoil.curve
    turn = turning(curve.points, closed=True)[curve.corner_index]
    corners = curve.corner_index[turns_sharply(turn)]
    return Loop(curve, tuple(int(k) for k in corners), (name,))


def _edges_loop(boundary: Boundary) -> Loop:
    """Return the loop of a four-sided boundary's nodes, with corners of block and patches."""
    ni, nj = boundary.ni - 1, boundary.nj - 1
    names: list[str] = []
    for side in SIDES:
        cells = ni if side in ("south", "north") else nj
        own: list[str] = [side] * cells
        for patch in boundary.patches:
            if patch.side == side:
                own[patch.start : patch.stop] = [patch.name] * (patch.stop - patch.start)
        names += own if side in ("south", "east") else own[::-1]
    begin = (0, ni, ni + nj, 2 * ni + nj)
    corners = sorted({*begin, *(k for k in range(len(names)) if names[k] != names[k - 1])})
    return ring_loop(boundary.outline(), hole=False, corners=corners, names=[names[k] for k in corners])


def _facing(loop: Loop, *, hole: bool) -> Loop:
    """Return the loop with the domain on its left."""
    if (polygon_area(loop.curve.points) > 0) != hole:
        return loop
    return ring_loop(loop.curve.points, hole=hole, corners=loop.corners, names=loop.names)
