"""Edges of profiles that end in a point: opened to 1 % of the chord and rounded, for layers around them.

Points move in proportion to their distance from the other edge.
"""

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.notes import Change
from meshonet.geometry.rows.profile import BladeProfile
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.airfoil.trailing_edge import opened_base

_CAP = np.linspace(0.0, 1.0, 33)[1:-1, None]  # fractions of the rounded end at which it has points
_BEFORE = 0.02  # length before the edge, in chords, over which the directions of the two sides are measured
_POINTED = 2.7  # smallest turn in radians at a pointed edge, a wedge of 25 degrees; a base has two corners
_SAME = 1e-9
_SIGNS = 1.0, -1.0  # of the sides' distances from the chord: profiles are clockwise


def pointed(profile: BladeProfile, trailing: bool) -> bool:
    """Return whether the leading or `trailing` edge of a profile is a point."""
    return profile.corner_counts[trailing] == 1 and profile.sharpness(trailing)[0] > _POINTED


def thick_edged(profile: BladeProfile, trailing: bool) -> BladeProfile:
    """Return a profile whose pointed leading or `trailing` edge is made round, 0.01 chords thick."""
    curve, length = profile.curve, profile.curve.length
    begin, edge = profile.leading, profile.trailing
    if not trailing:
        begin, edge = edge, begin
    other, tip = curve.at(np.mod([begin, edge], length))
    chord = tip - other
    size = float(norms(chord))
    normal = np.array([-chord[1], chord[0]])

    def moved(points: Floats, sign: float) -> Floats:
        along = np.clip(((points - other) * chord).sum(axis=1) / size**2, 0.0, None)
        return points + sign * 0.5 * LEAST_EDGE * along[:, None] * normal

    way = np.mod(curve.knots - begin, length)
    end = float(np.mod(edge - begin, length))
    order = np.argsort(way, kind="stable")
    way, points, heights = way[order], curve.points[order], profile.heights[order]
    masks = way < end - _SAME * length, way > end + _SAME * length
    sides = [moved(points[mask], sign) for mask, sign in zip(masks, _SIGNS, strict=True)]
    corners = [moved(tip[None], sign) for sign in _SIGNS]
    back = np.mod(edge + _BEFORE * size * np.array([-1.0, 1.0]), length)
    before = [moved(point[None], sign) for point, sign in zip(curve.at(back), _SIGNS, strict=True)]
    cap = _round_end(*corners, *before)
    half = len(_CAP) // 2
    level = np.full(len(_CAP) + 2, np.interp(end, way, heights))
    plane = cap[half:], corners[1], sides[1], sides[0], corners[0], cap[:half]
    levels = level[half + 1 :], heights[masks[1]], heights[masks[0]], level[: half + 1]
    return profile.reshaped(np.concatenate(plane), np.concatenate(levels))


def _round_end(one: Floats, other: Floats, before: Floats, beside: Floats) -> Floats:
    """Return points (n, 2) of a cubic cap between the ends of two sides (1, 2), in their directions."""
    reach = 2.0 / 3.0 * float(norms(other - one)[0])
    first = one + reach * (one - before) / norms(one - before)
    last = other + reach * (other - beside) / norms(other - beside)
    t, back = _CAP, 1.0 - _CAP
    ends, inner = back * back * back * one + t * t * t * other, back * first + t * last
    return np.asarray(ends + 3.0 * back * t * inner)


LEAST_EDGE = 0.01  # thickness in chords to which thinner trailing edges are opened


def round_edged(airfoil: Airfoil) -> tuple[Airfoil, tuple[str, ...]]:
    """Return the airfoil with a round trailing edge at least `LEAST_EDGE` chords thick, and notes."""
    notes: tuple[str, ...] = ()
    body, height = airfoil, airfoil.gap / airfoil.chord
    name = airfoil.name or "a section"
    if height < LEAST_EDGE * (1.0 - 1e-9):
        body = Airfoil(opened_base(airfoil, LEAST_EDGE * airfoil.chord), airfoil.name, notes=airfoil.notes)
        change = (
            f"{name} is changed: its trailing edge, {height:.2g} chords thick, is opened to {LEAST_EDGE:g}"
        )
        notes = (Change(f"{change} and rounded"),)
    elif body.blunt:
        notes = (Change(f"{name} is changed: its base, {height:.2g} chords thick, is rounded"),)
    return body.rounded(), notes
