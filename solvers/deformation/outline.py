"""Positions of wall nodes on a new outline, at equal fractions of arc length between corners or edges."""

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.errors import InputError
from meshonet.geometry.notes import Change
from meshonet.geometry.polygon.area import polygon_area
from meshonet.geometry.polygon.corners import find_corners, turning
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.airfoil.section_curve import farthest_arc
from meshonet.geometry.shapes.outline import Outline

Notes = tuple[str, ...]
_SHARP = np.radians(60.0)  # smallest turn of a wall at a trailing edge that is not rounded
_WIDEST_BASE = 0.2  # widest base, in perimeters of the section; flatbacks have up to .13


def on_outline(wall: Floats, outline: Airfoil | Outline) -> tuple[Floats, Notes]:
    """Move the nodes of a closed `wall` (n, 2), whose first node is repeated, to `outline`; return notes too.

    Raises InputError if the wall has a blunt trailing edge and the outline a sharp one.
    """
    if isinstance(outline, Airfoil):
        try:
            old = Airfoil(_without_base(wall[:-1]))
        except InputError:  # a wall that is no airfoil
            return _on_curve(wall, outline.curve)
        return _on_curve(wall, outline.curve) if old.crossing else _on_airfoil(wall, old, outline)
    return _on_curve(wall, outline.curve)


def _without_base(ring: Floats) -> Floats:
    """Return a ring (n, 2) without the nodes inside its base, the short way between two sharp corners."""
    corners = np.flatnonzero(np.abs(turning(ring, closed=True)) > _SHARP)
    if len(corners) < 2:
        return ring
    curve = Curve(ring, closed=True)
    ways = np.diff(curve.knots[corners], append=curve.knots[corners[0]] + curve.length)
    way = int(np.argmin(ways))
    if ways[way] > _WIDEST_BASE * curve.length:
        return ring
    first, last = np.append(corners, corners[0] + len(ring))[way : way + 2]
    return np.roll(ring, -last, axis=0)[: len(ring) - (last - first) + 1]


def _on_airfoil(wall: Floats, old: Airfoil, new: Airfoil) -> tuple[Floats, Notes]:
    ring = wall[:-1]
    rounded = float(np.abs(turning(ring, closed=True)).max()) < _SHARP
    blunt = old.blunt and not rounded
    new, notes = _with_edge(new, old.gap, blunt=blunt, rounded=rounded)
    edge = old.curve.points[1] if blunt else old.trailing_edge
    first = int(np.argmax(norms(ring - old.leading_edge))) if rounded else _nearest(ring, edge)
    ring = np.roll(ring, -first, axis=0)
    last = _nearest(ring, old.curve.points[-1]) if blunt else 0
    curve = Curve(ring, closed=True, corners=None if rounded else sorted({0, last}))
    middle = farthest_arc(curve, old.trailing_edge)
    begin, end = (0.0, new.curve.length) if rounded else (new.half_base, new.upper_end)
    before = [0.0, middle, curve.knots[last] if blunt else curve.length, curve.length]
    after = [begin, new.nose_arc, end, new.curve.length + begin]
    arcs = np.interp(curve.knots, before, after)
    return _closed(new.curve.at(arcs % new.curve.length), first), notes


def _with_edge(new: Airfoil, gap: float, *, blunt: bool, rounded: bool) -> tuple[Airfoil, Notes]:
    """Return the new outline with a trailing edge like the wall's (base, rounded or sharp), and notes."""
    if blunt and not new.blunt:
        problem = f"the wall has a blunt trailing edge, {gap:.3g} wide, and its new outline a sharp one"
        raise InputError(problem, "give an outline with a base, or make the grid anew", parameter="wall")
    if blunt or not new.blunt:
        return new, new.notes
    how = "rounded, as the wall's is" if rounded else "closed by a wedge, as the wall ends in an edge"
    notes = (*new.notes, Change(f"the base of the new outline is {how}"))
    return new.rounded() if rounded else new.wedged(), notes


def _nearest(points: Floats, place: Floats) -> int:
    return int(np.argmin(norms(points - place)))


def _closed(ring: Floats, first: int) -> Floats:
    """Return `ring` (n, 2), which begins at wall node `first`, in the wall's order and closed."""
    ring = np.roll(ring, first, axis=0)
    return np.concatenate([ring, ring[:1]])


def _on_curve(wall: Floats, new: Curve) -> tuple[Floats, Notes]:
    """Return the nodes of a closed wall on a new closed curve, matched by corners or by the nearest point."""
    ring = wall[:-1]
    corners = find_corners(ring, closed=True)
    way = 1.0 if (polygon_area(ring) > 0) == (polygon_area(new.points) > 0) else -1.0
    ends = np.sort((way * new.corners) % new.length)
    notes: Notes = ()
    if len(corners) and len(corners) == len(ends):
        start, there = corners[0], new.at((way * ends) % new.length)
        away = [((np.roll(there, -k, axis=0) - ring[corners]) ** 2).sum() for k in range(len(ends))]
        shift = int(np.argmin(away))
    else:
        corners, start, shift = np.zeros(1, dtype=np.intp), 0, 0
        every = np.linspace(0.0, new.length, 64 * len(new.points) + 1)
        ends = np.array([(way * float(every[_nearest(new.at(every), ring[0])])) % new.length])
        notes = (
            "old and new outline have no corners that match: the place of the first wall node, "
            f"({ring[0, 0]:.6g}, {ring[0, 1]:.6g}), on the new one is guessed, the nearest",
        )
    curve = Curve(np.roll(ring, -start, axis=0), closed=True)
    ends = np.roll(ends, -shift)
    ends = np.concatenate([ends, ends[:1]])
    ends[1:] += new.length * np.cumsum(np.diff(ends) <= 0.0)
    arcs = np.interp(curve.knots, [*curve.knots[corners - start], curve.length], ends)
    return _closed(new.at((way * arcs) % new.length), int(start)), notes


def on_line(wall: Floats, points: Floats) -> tuple[Floats, Notes]:
    """Move the nodes of an open `wall` (n, 2) to the curve through `points` (m, 2); also return notes."""
    ends = points[[0, -1]]
    if norms(wall[[0, -1]] - ends).sum() > norms(wall[[0, -1]] - ends[::-1]).sum():
        points = points[::-1]
    old, new = Curve(wall), Curve(points)
    before, after = (_stations(curve) for curve in (old, new))
    notes: Notes = ()
    if len(before) != len(after):
        notes = (
            f"the wall has {len(before) - 2} corners and the new one {len(after) - 2}: "
            "nodes keep their share of the whole length",
        )
        before, after = before[[0, -1]], after[[0, -1]]
    nodes = new.at(np.interp(old.knots, before, after))
    nodes[[0, -1]] = points[[0, -1]]
    return nodes, notes


def _stations(curve: Curve) -> Floats:
    inner = curve.corners[(curve.corners > 0) & (curve.corners < curve.length)]
    return np.concatenate([[0.0], inner, [curve.length]])
