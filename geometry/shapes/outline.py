"""A closed curve that is not an airfoil: the outline of a four-sided domain, or a body in a far field.

A quad has the lowest edge as south, or that from the first given corner, then counter-clockwise. O nodes run
clockwise from the rightmost point, in a circle around the middle of the bounding box.
"""

from collections.abc import Callable, Sequence

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, Topology, distinct, extent_of
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.loop import turns_sharply
from meshonet.geometry.elementary import product
from meshonet.geometry.errors import InputError
from meshonet.geometry.notes import departure_note
from meshonet.geometry.polygon.area import check_extent, polygon_area
from meshonet.geometry.polygon.corners import find_corners, turning
from meshonet.geometry.polygon.self_intersection import check_outline
from meshonet.geometry.polygon.straights import find_kinks, straight_intervals
from meshonet.geometry.shapes.far_field import o_boundary
from meshonet.geometry.spacing.along_curve import stretch_arcs
from meshonet.geometry.spacing.sampling import DEFAULT_NI, DEFAULT_NJ, Sampling

_DEPARTURE = 5e-3  # largest distance of a smooth side from lines between points, in extents, without a note


class Outline:
    """A closed curve through `points` (n, 2), at least 3, in any unit and direction.

    `corners` are the indices of the points that are corners of a quad domain, south-west first. `places` (n,)
    are texts for messages: where in the input a point is. Raises InputError: too few points; a point that
    repeats its neighbour; an outline that crosses itself or has no area.
    """

    far_field_unit = "extents of the body"  # unit of the far-field distance
    notes: tuple[str, ...] = ()  # notes on parts of the file that the reader left out

    def __init__(
        self,
        points: Floats,
        name: str = "",
        corners: tuple[int, int, int, int] | None = None,
        places: Sequence[str] = (),
    ) -> None:
        self.name, self.corners = name, corners
        check_extent(extent_of(points) if len(points) else 0.0)
        self.curve = _with_sides(Curve(points, closed=True), corners or ())
        p = self.curve.points
        area, extent = polygon_area(p), extent_of(p)
        if not _on_a_line(p, extent):  # such points run back on themselves, a less helpful message
            check_outline(p, places)
        if abs(area) < 1e-9 * extent**2:
            raise InputError("the outline has no area", "give the points around a domain or a body")
        self._left = area > 0  # counter-clockwise

    @property
    def topology(self) -> Topology:
        """Topology for ``auto``: ``quad`` if there are four or more convex corners, otherwise ``o``."""
        return "quad" if self.corners is not None or len(self._sharp()) >= 4 else "o"

    def boundary(self, sampling: Sampling) -> Boundary:
        """Return the four edges of the domain, or the O boundary around the body.

        The spacing applies to each edge, or to the whole body. ``auto`` is ``conformal`` around a smooth body
        (`geometry.conformal.spacing`), otherwise ``uniform``. With ``tanh``, end cells have a quarter of the
        mean length. Corners are nodes. Raises InputError: a topology or spacing that does not apply; corner
        indices out of range.
        """
        topology = self.topology if sampling.topology == "auto" else sampling.topology
        if sampling.corners is not None and sampling.topology == "auto":
            topology = "quad"
        sampling.check_airfoil(self.name)
        quad = topology == "quad"
        for wrong, problem, remedy in (
            (topology == "c", "{topology} c needs the trailing edge of an airfoil", "use o or quad"),
            (
                sampling.corners is not None and not quad,
                "an O grid has no corners",
                "leave {corners} out, or use {topology} quad",
            ),
            (
                sampling.far_field is not None and quad,
                "a four-sided domain has no far field",
                "leave {far_field} out, or use {topology} o",
            ),
            (
                sampling.spacing == "conformal" and quad,
                "conformal spacing needs a body in a far field",
                "use another",
            ),
        ):
            if wrong:
                raise InputError(problem, remedy, source=self.name)
        return self._quad(sampling) if quad else self._body(sampling)

    def _sharp(self) -> Indices:
        """Return the convex corners, in order along the curve."""
        turn = turning(self.curve.points, closed=True) * (1.0 if self._left else -1.0)
        index = self.curve.corner_index
        return np.asarray(index[turns_sharply(turn[index]) & (turn[index] > 0.0)])

    def _quad(self, sampling: Sampling) -> Boundary:
        ni, nj = sampling.ni or DEFAULT_NI, sampling.nj or DEFAULT_NJ
        chosen = sampling.corners or self.corners
        corners = self._ordered_corners(chosen) if chosen is not None else self._sharpest_corners()
        points, curve = self.curve.points, _with_sides(self.curve, corners)
        edges = []
        for a, b, n in zip(corners, (*corners[1:], corners[0]), (ni, nj, ni, nj), strict=True):
            begin, end = float(curve.knots[a]), float(curve.knots[b])
            law, step = sampling.spacing, sampling.refined
            edge = curve.at(stretch_arcs(curve, begin, end, n - 1, law, forward=self._left, step=step))
            edge[0], edge[-1] = points[a], points[b]
            edges.append(edge)
        south, east, north, west = edges
        sides = south, north[::-1], west[::-1], east
        return Boundary(*sides, topology="quad", name=self.name, sampled=True, notes=sides_departure(curve))

    def _ordered_corners(self, chosen: tuple[int, int, int, int]) -> tuple[int, ...]:
        n = len(self.curve.points)
        for corner in chosen:
            if not 0 <= corner < n:
                what = f"corner {corner} of {n} points does not exist"
                raise InputError(what, f"use 0 to {n - 1}", source=self.name)
        ahead = [(corner - chosen[0]) % n for corner in chosen]
        if ahead != sorted(ahead) and ahead[1:] != sorted(ahead[1:], reverse=True):
            what = f"corners {','.join(map(str, chosen))} are not in order along the outline"
            raise InputError(what, "sort them", source=self.name)
        ordered = [(chosen[0] + step) % n for step in sorted(ahead)]
        return tuple(ordered if self._left else [ordered[0], *ordered[:0:-1]])

    def _sharpest_corners(self) -> tuple[int, ...]:
        """Return the four sharpest corners, counter-clockwise; the lowest edge is between the first two.

        Among corners equally sharp to a degree, those nearest to corners of the bounding box are taken. If
        there are fewer than four, the points closest to the corners of the box are taken.
        """
        p = self.curve.points
        middle, half = 0.5 * (p.max(axis=0) + p.min(axis=0)), 0.5 * np.maximum(np.ptp(p, axis=0), 1e-300)
        unit = (p - middle) / half
        sharp = self._sharp()
        if len(sharp) >= 4:
            turn = np.round(np.degrees(np.abs(turning(p, closed=True)[sharp])))
            inward = np.hypot(1.0 - np.abs(unit[sharp, 0]), 1.0 - np.abs(unit[sharp, 1]))
            best = np.sort(sharp[np.lexsort((inward, -turn))[:4]])
        else:
            reach = [int(np.argmax(product(unit, d))) for d in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
            if len(set(reach)) < 4:
                raise InputError("no four corners stand out", "name them with {corners}", source=self.name)
            best = np.sort(np.array(reach))
        order = best if self._left else best[::-1]
        knots, length = self.curve.knots, self.curve.length
        heights = []
        for k in range(4):
            begin, end = (knots[order[k]], knots[order[(k + 1) % 4]])[:: 1 if self._left else -1]
            places = begin + ((end - begin) % length) * np.linspace(0.0, 1.0, 33)
            heights.append(self.curve.at(places)[:, 1].mean())
        first = int(np.argmin(np.round(np.array(heights) / half[1], 9)))
        return tuple(int(k) for k in np.roll(order, -first))

    def _body(self, sampling: Sampling) -> Boundary:
        ni, nj = sampling.ni or DEFAULT_NI, sampling.nj or DEFAULT_NJ
        curve = self.clockwise()
        arcs, notes = self._around(curve, ni, sampling)
        wall = curve.at(arcs)
        wall[-1] = wall[0]
        box = np.stack([curve.points.min(axis=0), curve.points.max(axis=0)])
        extent = extent_of(box)
        radius = sampling.radius * extent
        return o_boundary(wall, nj, box.mean(axis=0), radius, curve, self.name, extent, notes=notes)

    def clockwise(self) -> Curve:
        """Return the curve, clockwise from its rightmost point or the middle of a vertical right side."""
        curve = self.curve.reversed() if self._left else self.curve
        p, n = curve.points, len(curve.points)
        corner = np.isin(np.arange(n), curve.corner_index)
        straight = np.zeros(n, dtype=bool) if curve.straight is None else curve.straight
        right = p[:, 0] >= p[:, 0].max() - 1e-9 * np.ptp(p[:, 0])
        start = int(np.flatnonzero(right & ~np.roll(right, 1))[0]) if not right.all() else 0
        p, right = np.roll(p, -start, axis=0), np.roll(right, -start)
        corner, straight = np.roll(corner, -start), np.roll(straight, -start)
        if right[1]:  # from the topmost point of the right side down to its last
            last = int(np.argmin(right)) - 1
            middle = 0.5 * (p[0] + p[last])
            inside = int(np.searchsorted(-p[: last + 1, 1], -middle[1]))
            if p[inside, 1] != middle[1]:
                p, corner = np.insert(p, inside, middle, axis=0), np.insert(corner, inside, False)
                straight = np.insert(straight, inside, straight[inside - 1])
            p = np.roll(p, -inside, axis=0)
            corner, straight = np.roll(corner, -inside), np.roll(straight, -inside)
        return Curve(p, closed=True, corners=np.flatnonzero(corner), straight=straight)

    def _around(self, curve: Curve, ni: int, sampling: Sampling) -> tuple[Floats, tuple[str, ...]]:
        """Return the arc lengths (ni,) of nodes around a body, and a note on changed spacing."""
        notes: tuple[str, ...] = ()
        step = sampling.refined
        if sampling.spacing == "conformal" or (sampling.spacing == "auto" and curve.corners.size == 0):
            try:
                from meshonet.geometry.conformal.spacing import conformal_knots

                return conformal_knots(curve, curve.corners[curve.corners > 0], ni, steps=(step,)), ()
            except InputError as error:
                if sampling.spacing == "conformal":
                    raise
                notes = (f"spacing uniform is used instead of conformal: {error.problem}",)
        return stretch_arcs(curve, 0.0, 0.0, ni - 1, sampling.spacing, step=step), notes


def _on_a_line(points: Floats, extent: float) -> bool:
    away = points - points[0]
    u, v = away[int(np.argmax(np.abs(away).sum(axis=1)))]
    return bool(np.abs(away[:, 0] * v - away[:, 1] * u).max() < 1e-12 * extent**2)


def _with_sides(curve: Curve, ends: Sequence[int]) -> Curve:
    """Return the closed curve with corners, kinks and straight lines of its points and sides."""
    points, corners = curve.points, distinct(np.append(curve.corner_index, np.array(ends, dtype=np.intp)))
    corners = _with_those_within(find_corners, points, corners, sorted(ends))
    corners = _with_those_within(find_kinks, points, corners, corners.tolist())
    straight = straight_intervals(points, corners)
    return Curve(points, closed=True, corners=corners, straight=straight if straight.any() else None)


def _with_those_within(
    search: Callable[[Floats], Indices], points: Floats, corners: Indices, ends: Sequence[int]
) -> Indices:
    """Return the corners, and those that `search` finds in stretches between `ends`."""
    more = [side[search(points[side])] for side in _stretches(ends, len(points))]
    return distinct(np.concatenate([corners, *more]))


def _stretches(ends: Sequence[int], n: int) -> list[Indices]:
    """Return the indices of each stretch of a closed curve of `n` points between `ends`."""
    pairs = zip(ends, (*ends[1:], *(first + n for first in ends[:1])), strict=True)
    return [np.arange(first, last + 1) % n for first, last in pairs]


def sides_departure(curve: Curve) -> tuple[str, ...]:
    """Return a note if the smooth curve through the points deviates visibly from their polygon."""
    off = curve.departure()
    visible = off > _DEPARTURE * extent_of(curve.points)
    return (departure_note("the sides are smooth curves", off),) if visible else ()
