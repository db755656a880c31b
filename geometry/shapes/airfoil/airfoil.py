"""An airfoil: the curve through its points, its leading and trailing edge, and nodes along its wall."""

from __future__ import annotations

import math
from collections.abc import Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property

import numpy as np

from meshonet.geometry.arrays import Floats, along_and_across
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.self_intersection import find_crossing
from meshonet.geometry.shapes.airfoil.clean import SHARP_GAP, CleanSection, clean_section
from meshonet.geometry.shapes.airfoil.section_curve import (
    base_note,
    edge_notes,
    farthest_arc,
    moved_note,
    nose_radius,
    opened_note,
    section_curve,
    shape_notes,
    swapped_note,
)
from meshonet.geometry.shapes.far_field import o_boundary
from meshonet.geometry.spacing.laws import LAWS
from meshonet.geometry.spacing.sampling import DEFAULT_NI, DEFAULT_NJ, Sampling

__all__ = ["SHARP_GAP", "Airfoil"]
_WIDEST_WEDGE = 50.0  # degrees; a C grid by default needs surfaces that meet at a smaller angle


class CrossingError(InputError):
    """Error: there are too few wall nodes, and the polygon through them crosses itself in a thin part."""


class Airfoil:
    """A closed section with a trailing edge and a leading edge.

    ::

                  upper  ---->              The curve runs clockwise from the trailing edge (the middle of
               .-----------------.___       a straight base) along the lower side; the leading edge is the
        LE    (                      --- TE point farthest from the trailing edge.
               '-------------------'''
                  lower  <----

    The `points` (n, 2), in any unit and direction, are cleaned (see `clean_section`) unless they are a
    `CleanSection`. `places` (n,) say where the input has the points, such as ``line 12``. `notes` say how the
    caller changed the points. Raises InputError, with the place: the points are no airfoil.
    """

    chord: float  # distance from the leading to the trailing edge
    leading_edge: Floats  # (2,) the point farthest from the trailing edge
    trailing_edge: Floats  # (2,) the trailing edge; if it is blunt, the middle of the base
    crossing: InputError | None  # why there is no `curve`: surfaces cross, perhaps by noise (`smoothed`)
    gap: float  # distance between the ends of the upper and the lower surface
    nose_radius: float  # radius of the parabola that is as thick as the section at 2 % of the chord
    half_base: float  # arc length at which the lower side begins; 0 when the trailing edge is sharp
    nose_arc: float  # arc length of the leading edge
    upper_end: float  # arc length at which the upper side ends
    base_is_round: bool  # whether the base is rounded, without corners
    blunt: bool  # whether the trailing edge is a base; a gap below 2e-4 chords is closed at its middle

    far_field_unit = "chords"  # unit of the far-field distance

    notes: tuple[str, ...]  # sentences on changes of the given points

    def __init__(
        self,
        points: Floats | CleanSection,
        name: str = "",
        places: Sequence[str] = (),
        notes: tuple[str, ...] = (),
    ) -> None:
        self.name, self.base_is_round = name, False
        self._section = section = points if isinstance(points, CleanSection) else clean_section(points)
        self.gap, self.blunt = section.gap, section.blunt
        curve, changes, self.crossing = section_curve(section, places)
        self.points_curve = curve
        self._file_notes = (*notes, *(swapped_note(section, places) if section.swapped else ()))
        self.notes = tuple(dict.fromkeys((*self._file_notes, *changes)))
        self.trailing_edge = curve.points[0]
        arc = farthest_arc(curve, self.trailing_edge)
        self.leading_edge = curve.at(np.array([arc]))[0]
        self.chord = float(np.hypot(*(self.leading_edge - self.trailing_edge)))
        first, last = (curve.knots[1], curve.knots[-1]) if self.blunt else (0.0, curve.length)
        self.half_base, self.nose_arc, self.upper_end = float(first), arc, float(last)
        self.nose_radius = nose_radius(curve, arc, self.trailing_edge, self.chord)

    def __repr__(self) -> str:
        edge = f"blunt trailing edge {self.gap:.6g}" if self.blunt else "sharp or round trailing edge"
        count = len(self.points_curve.points)
        return f"<Airfoil {self.name!r}: chord {self.chord:.6g}, {edge}, {count} points>"

    @property
    def curve(self) -> Curve:
        """The curve through the points. Raises InputError, which says where, if the two surfaces cross."""
        if self.crossing:
            raise self.crossing
        return self.points_curve

    @property
    def unit(self) -> float:
        """Unit of cell sizes at the wall: the chord, or 1 if the chord differs from 1 by less than 1 %."""
        return 1.0 if abs(self.chord - 1.0) < 0.01 else self.chord

    @cached_property
    def wedge(self) -> float:
        """Angle in degrees between upper and lower surface over the last 1 % of the chord."""
        first, last = self.half_base, self.upper_end
        step = 0.01 * self.chord
        lower, a, b, upper = self.curve.at(np.array([first + step, first, last, last - step]))
        u, v = upper - b, lower - a
        return math.degrees(math.atan2(u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1]))

    @property
    def outline_notes(self) -> tuple[str, ...]:
        """Notes on an oblique blunt trailing edge, on ripples, and on a curve far from the given polygon."""
        return self.notes + shape_notes(self._section, self.curve, self.chord)

    @cached_property
    def inner_corners(self) -> Floats:
        """Arc lengths of all corners that are not at the trailing edge."""
        corners = self.curve.corners
        return corners[(corners > self.half_base) & (corners < self.upper_end)]

    def normalised(self) -> Airfoil:
        """Return the airfoil moved, rotated and scaled: leading edge at (0, 0), trailing edge at (1, 0)."""
        axis = (self.trailing_edge - self.leading_edge) / self.chord**2
        points = self.curve.points  # the first is the middle of a blunt edge, or the sharp edge
        ring = points[1:] if self.blunt else np.concatenate([points, points[:1]])
        off = along_and_across(ring - self.leading_edge, axis)
        return Airfoil(np.stack(off, axis=1), self.name, notes=self.notes)

    def smoothed(self, tolerance: float) -> Airfoil:
        """Return the airfoil smoothed by splines within `tolerance` chords of its points; corners stay."""
        from meshonet.geometry.shapes.airfoil.smooth import smooth_ring, smoothing_notes

        ring, most = smooth_ring(self._section, self.nose_radius, tolerance * self.chord)
        body = Airfoil(ring, self.name, notes=self._file_notes)
        body.notes += smoothing_notes(self, body, most)
        return body

    def prepared(self, sampling: Sampling) -> Airfoil:
        """Return the airfoil smoothed, normalised and with a thicker trailing edge, as `sampling` says."""
        body = self.smoothed(sampling.smooth) if sampling.smooth else self
        body = body.normalised() if sampling.normalise else body
        return body.opened(sampling.base) if sampling.base else body

    def rounded(self) -> Airfoil:
        """Return the airfoil with rounded corners of its blunt base."""
        if not self.blunt:
            return self
        from meshonet.geometry.shapes.airfoil.trailing_edge import rounded_base

        body = copy(self)
        for name in ("wedge", "inner_corners"):
            body.__dict__.pop(name, None)
        body.points_curve, end = rounded_base(self.curve, self.chord)
        arc = farthest_arc(body.points_curve, body.trailing_edge)
        body.blunt, body.base_is_round = False, True
        body.half_base, body.nose_arc, body.upper_end = end, arc, body.points_curve.length - end
        return body

    def moved_apart(self) -> Airfoil:
        """Return the airfoil with both surfaces moved apart to 9e-5 chords wherever they are closer."""
        section = self._section.moved_apart()
        return Airfoil(section.points, self.name, notes=(*self.notes, moved_note(self._section, section)))

    def wall(self, ni: int, sampling: Sampling) -> Floats:
        """Return nodes (ni, 2) on the curve, clockwise from the trailing edge back to it."""
        return self._wall(ni, sampling)[0]

    def _wall(self, ni: int, sampling: Sampling) -> tuple[Floats, tuple[str, ...]]:
        """Return the nodes of `wall`, and a note on unusual ``auto`` spacing."""
        if sampling.spacing != "auto":
            return self._nodes(ni, sampling), ()
        notes: tuple[str, ...] = ()
        if sampling.le_spacing is None and sampling.te_spacing is None:
            try:
                return self._nodes(ni, replace(sampling, spacing="conformal")), ()
            except InputError as error:
                notes = (f"spacing tanh is used instead of conformal: {error.problem}",)
        return self._nodes(ni, replace(sampling, spacing="tanh")), notes

    def _nodes(self, ni: int, sampling: Sampling) -> Floats:
        from meshonet.geometry.shapes.airfoil.wall_nodes import wall_arcs  # which not every domain needs

        nodes = self.curve.at(wall_arcs(self, ni, sampling))
        nodes[-1] = nodes[0]
        crossing = find_crossing(nodes[:-1])
        if crossing is not None:
            raise CrossingError(
                f"the wall of {ni} nodes crosses itself at ({crossing.x:.6g}, {crossing.y:.6g})",
                "use more nodes where the section is thin",
            )
        return nodes

    def boundary(self, sampling: Sampling) -> Boundary:
        """Return the boundary: the wall, and a circle (O grid) or a half circle and a wake (C grid).

        The topology ``auto`` is ``c`` if cells at the wall will be thin and the trailing edge is sharp (at
        most 50 degrees, after its treatment by `Sampling.te`). Otherwise it is ``o``. Raises InputError:
        topology ``quad``; ``c`` with a blunt trailing edge; too few nodes.
        """
        if sampling.topology == "quad":
            raise InputError("topology quad is not made from an airfoil", "use o or c")
        if sampling.corners is not None:
            raise InputError("an airfoil has no corners to choose", "leave {corners} out")
        body = self.prepared(sampling)
        try:
            return body._around(sampling)
        except CrossingError:
            return body.moved_apart()._around(sampling)

    def wedged(self) -> Airfoil:
        """Return the airfoil with its blunt base closed by a wedge."""
        if not self.blunt:
            return self
        from meshonet.geometry.shapes.airfoil.trailing_edge import wedged_base

        first, last = self.half_base, self.upper_end
        step = 0.01 * self.chord
        a, b, c, d = self.curve.at(np.array([first, first + step, last - step, last]))
        ways = (a - b) / np.hypot(*(a - b)), (d - c) / np.hypot(*(d - c))
        section = wedged_base(replace(self._section, points=self.curve.points[1:]), ways)
        return Airfoil(section, self.name, notes=self.notes)

    def opened(self, thickness: float) -> Airfoil:
        """Return the airfoil with a trailing edge at least `thickness` chords thick."""
        height = self.gap / self.chord
        if height >= thickness * (1.0 - 1e-3):  # opened before, in chords a little longer
            return self
        from meshonet.geometry.shapes.airfoil.trailing_edge import opened_base

        notes = (*self.notes, opened_note(height, thickness))
        return Airfoil(opened_base(self, thickness * self.chord), self.name, notes=notes)

    def _around(self, sampling: Sampling) -> Boundary:
        topology, te = sampling.topology, sampling.te
        if te == "auto":
            te = "wedge" if topology == "c" else "exact"
        body = self.rounded() if te == "round" else self.wedged() if te == "wedge" else self
        if sampling.base_nodes and not body.blunt:
            remedy = "leave {base_nodes} out"
            raise InputError("the trailing edge has no base", remedy, parameter="base_nodes")
        if topology == "auto":
            sharp = (
                sampling.viscous and not (body.blunt or body.base_is_round) and body.wedge <= _WIDEST_WEDGE
            )
            topology = "c" if sharp else "o"
        for name in ("wake", "wake_nodes"):
            if topology == "o" and getattr(sampling, name):
                remedy = f"leave {{{name}}} out, or use {{topology}} c"
                raise InputError("an O grid has no wake", remedy, source=self.name)
        notes = body.notes + shape_notes(self._section, self.curve, self.chord)
        if te != "exact" or sampling.te == "exact":
            notes += edge_notes(self, body, te, sampling.te)
        if topology == "c":
            if sampling.topology == "auto":
                notes += ("c grid, as the trailing edge is sharp; {topology} o makes an O grid",)
            return body._c_boundary(sampling, self, notes)
        centre = 0.5 * (body.leading_edge + body.trailing_edge)
        wall, replaced = body._wall(sampling.ni or DEFAULT_NI, sampling)
        radius, nj = sampling.radius * body.chord, sampling.nj or DEFAULT_NJ
        notes += replaced
        if body.blunt:
            first = body.half_base
            corner, fixed = body.curve.at(np.array([first]))[0], sampling.base_nodes is not None
            notes += base_note(wall, corner, 2.0 * first, body.chord, fixed=fixed)
        turned = not sampling.viscous
        return o_boundary(wall, nj, centre, radius, body.curve, self.name, self.unit, turned, notes)

    def _c_boundary(self, sampling: Sampling, original: Airfoil, notes: tuple[str, ...]) -> Boundary:
        """Return the C boundary around this body, in the units of the `original` airfoil."""
        from meshonet.geometry.shapes.wake import C_EDGE, c_boundary, cells_of_wake, wake_axis, wake_line

        if self.base_is_round:
            remedy = "leave {te} out, close it with {te} wedge, or use {topology} o"
            raise InputError("a C grid has no rounded trailing edge", remedy)
        if self.blunt:
            remedy = "give {first_cell} or {y_plus}, close it with {te} wedge, or use {topology} o"
            raise InputError("a C grid needs a sharp trailing edge", remedy)
        chord, ni = original.chord, sampling.ni or DEFAULT_NI
        length = (sampling.wake or sampling.radius) * chord
        step = (sampling.te_spacing or C_EDGE / ni) * chord
        cells = cells_of_wake(ni, sampling.wake_nodes, step, length, sampling.corner_steps(ni - 1))
        law = "curvature" if sampling.spacing == "auto" else sampling.spacing
        te = sampling.te_spacing if LAWS[law].place or law == "conformal" else step / self.chord
        wall = self.wall(ni - 2 * cells, replace(sampling, spacing=law, te_spacing=te))
        axis = wake_axis(original.leading_edge, original.trailing_edge)
        first = 0.5 * float(np.hypot(*(wall[[1, -2]] - wall[0]).T).sum())
        wake = wake_line(wall, axis, chord, length, first, cells)
        centre = 0.5 * (original.leading_edge + original.trailing_edge)
        return c_boundary(
            wall,
            sampling.nj or DEFAULT_NJ,
            wake,
            centre,
            sampling.radius * self.chord,
            axis=axis,
            curve=self.curve,
            name=original.name,
            chord=original.unit,
            notes=notes,
        )
