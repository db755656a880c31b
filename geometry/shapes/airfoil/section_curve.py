"""The smooth curve through the points of an airfoil, its point farthest from the trailing edge, and notes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from operator import attrgetter
from typing import TYPE_CHECKING

import numpy as np

from meshonet.geometry.arrays import Floats, along_and_across, norms
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.elementary import product
from meshonet.geometry.errors import InputError
from meshonet.geometry.notes import Change, departure_note
from meshonet.geometry.polygon.corners import turning
from meshonet.geometry.polygon.self_intersection import Crossing, find_crossing, find_crossings
from meshonet.geometry.shapes.airfoil.clean import SHARP_GAP, CleanSection

if TYPE_CHECKING:
    from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
    from meshonet.geometry.spacing.sampling import TrailingEdge

_CUTS = np.array([0, 1 / 32, 1 / 8, 1 / 4, 3 / 8, 1 / 2, 5 / 8, 3 / 4, 7 / 8, 31 / 32])
"""Parameters at which an interval of the curve is divided into straight pieces, to search for crossings."""
DEPARTURE, FAR_OFF = 1e-3, 5e-3
"""Distance in chords beyond which the curve counts as another wall than the lines between its points."""
RIPPLES = 10  # fewest sign changes of the curvature that are ripples; designed sections have at most six
_FLAT = 0.1  # curvature times chord below which its sign is ignored
OBLIQUE = 30.0  # least angle in degrees between a base and the normal of the chord to be called oblique
BESIDE = 0.01  # chords along the surfaces that count as next to the base
MOST_BASE = 0.25  # chords; a longer last segment of a surface is no base
UNLIKE = 1.5  # largest ratio of the two wall cells at a corner of the base without a note
_PARTS = 128  # parts of a stretch in the search for the point farthest from the trailing edge


def swapped_note(section: CleanSection, places: Sequence[str]) -> tuple[str, ...]:
    """Return a note on neighbouring points that were swapped; `places` has a name for each given point."""
    named = ", ".join(places[k] if places else f"point {k}" for k in section.swapped[:6])
    more = ", ..." if len(section.swapped) > 6 else ""
    return (Change(f"the outline is changed: points in the wrong order are swapped ({named}{more})"),)


def section_curve(
    section: CleanSection, places: Sequence[str]
) -> tuple[Curve, tuple[str, ...], InputError | None]:
    """Return the curve through a section's points, notes, and an error if its two sides cross, else None.

    Sides that cross only by rounding are moved apart (see `shapes.airfoil.separate_surfaces`). Intervals in
    which the curve would cross itself are made straight.
    """
    notes: list[str] = []
    crossed = None
    crossing = find_crossing(section.points)
    if crossing is not None:
        apart = section.moved_apart()
        if find_crossing(apart.points) is not None:
            crossed = _crossed(section, crossing, places)
        else:
            notes.append(moved_note(section, apart))
            section = apart
    points, corners = section.points, section.corners
    if section.blunt:  # point 0 is the middle of the base
        points, corners = np.concatenate([[0.5 * (points[0] + points[-1])], points]), corners + 1
    straight = np.zeros(len(points), dtype=bool)
    for left in reversed(range(8)):
        curve = Curve(points, closed=True, corners=corners, straight=straight)
        crossings = find_crossings(curve.polyline(_CUTS), limit=4096)
        pieces = [*map(attrgetter("first"), crossings), *map(attrgetter("second"), crossings)]
        where = np.array(pieces, dtype=np.intp) // len(_CUTS)
        if straight[where].all():
            break
        straight[where if left > 1 else slice(None)] = True
    if straight.any():
        pairs = f"{straight.sum()} of its {len(points)} pairs of points"
        why = "where a smooth curve would cross itself"
        notes.append(Change(f"the outline follows straight lines between {pairs}, {why}"))
    return curve, tuple(notes), crossed


def moved_note(before: CleanSection, section: CleanSection) -> str:
    """Return a note on how far the surfaces of `section` were moved apart."""
    off = section.points - before.points
    edge = before.points[0]
    chord = float(np.hypot(*(before.points - edge).T).max())
    most = float(np.hypot(*off.T).max()) / chord
    k = int(np.argmax(np.hypot(*off.T)))
    x, y = before.points[k]
    return Change(
        f"the outline is changed: its surfaces touch near ({x:.6g}, {y:.6g}) and are moved apart, by at most "
        f"{most:.2g} chords"
    )


def sign_changes(curve: Curve, chord: float) -> int:
    """Return how often the curvature of a section changes its sign, corners left out."""
    points = curve.points
    steps = norms(np.concatenate([points[1:], points[:1]]) - points)
    bend = turning(points, closed=True) * (2.0 * chord) / (steps + np.concatenate([steps[-1:], steps[:-1]]))
    bend[curve.corner_index] = 0.0
    signs = bend[np.abs(bend) > _FLAT] > 0.0
    return int((signs[1:] != signs[:-1]).sum())


def nose_radius(curve: Curve, middle: float, edge: Floats, chord: float) -> float:
    """Return the nose radius; `middle` is the nose's arc length on `curve`, `edge` the trailing edge."""
    nose = curve.at(np.array([middle]))[0]
    axis = (edge - nose) / chord
    step = np.linspace(0.0, 0.2 * chord, 81)
    sides = []
    for sign in (-1.0, 1.0):
        along, across = along_and_across(curve.at(middle + sign * step) - nose, axis)
        sides.append(float(np.interp(0.02 * chord, np.maximum.accumulate(along), across)))
    return (0.5 * (sides[1] - sides[0])) ** 2 / (0.04 * chord)


def shape_notes(section: CleanSection, curve: Curve, chord: float) -> tuple[str, ...]:
    """Return notes on an oblique blunt trailing edge, on ripples, and on a curve far from its polygon."""
    notes = _oblique_base(section, chord)
    count = sign_changes(curve, chord)
    if count >= RIPPLES:
        notes += (f"the outline ripples: its curvature changes sign {count} times; see {{smooth}}",)
    off = curve.departure() / chord
    return (*notes, wall_departure(off)) if off > DEPARTURE else notes


def wall_departure(off: float) -> str:
    """Return the note on an airfoil's smooth curve that departs from its polygon by `off` chord lengths."""
    note = departure_note("the wall is a smooth curve", off, " chords")
    return Change(note) if off > FAR_OFF else note


def _oblique_base(section: CleanSection, chord: float) -> tuple[str, ...]:
    """Return a note on a base, or a last piece of a surface, far from normal to the chord."""
    points, last = section.points, len(section.points) - 1
    others = [(last, "")] if section.blunt else [(1, "lower"), (last, "upper")]
    for other, side in others:
        base = points[other] - points[0]
        width = float(np.hypot(*base))
        if not {0, other} <= set(section.corners.tolist()) or not SHARP_GAP < width / chord < MOST_BASE:
            continue
        edge = 0.5 * (points[0] + points[other])
        axis = edge - points[np.argmax(np.hypot(*(points - edge).T))]
        slant = math.degrees(math.asin(min(abs(product(base, axis)) / (width * np.hypot(*axis)), 1.0)))
        kept = f", as the last piece of the {side} surface, and the edge counts as sharp" if side else ""
        if side or slant > OBLIQUE:
            return (
                f"the base of the trailing edge, {width / chord:.3g} chords wide, is oblique, {slant:.0f} "
                f"degrees off the normal of the chord: both its corners are kept{kept}",
            )
    return ()


def base_note(wall: Floats, corner: Floats, base: float, chord: float, *, fixed: bool) -> tuple[str, ...]:
    """Return a note if a base (blunt trailing edge) uses most nodes, or if cell sizes jump at its corner.

    `wall` (n, 2) are the wall nodes, which begin in the middle of the base. `base` is the length of the base,
    `corner` (2,) its lower corner. `fixed` says that the user gave the number of nodes on the base.
    """
    steps = norms(np.diff(wall, axis=0))
    arcs = np.cumsum(steps)
    beside = 0.5 * base + BESIDE * chord
    crowd = int(((arcs < beside) | (arcs > arcs[-1] - beside)).sum())
    if 2 * crowd > len(arcs):
        usual = 0.25 * arcs[-1] / len(arcs) / chord
        return (
            f"{crowd} of {len(wall)} wall nodes lie on the base or within {BESIDE:g} chords of it, and the "
            f"longest cell elsewhere has {steps.max() / chord:.2g} chords: use "
            + ("fewer {base_nodes}" if fixed else f"{{te_spacing}} {usual:.1g} or more nodes"),
        )
    k = int(np.argmin(np.hypot(*(wall[: len(wall) // 2] - corner).T)))
    if k == 0:
        return ()
    on, off = steps[k - 1 : k + 1].tolist()
    ratio = off / on
    if 1.0 / UNLIKE <= ratio <= UNLIKE:
        return ()
    times, word = (ratio, "smaller") if ratio > 1.0 else (1.0 / ratio, "larger")
    return (
        f"cells on the base are {times:.2g} times {word} than those beside it: use {{te_spacing}} near "
        f"{base / (2 * k) / chord:.2g}, the base over its {2 * k} cells, or {{te}} round",
    )


def opened_note(height: float, thickness: float) -> str:
    """Return the note on a trailing edge that was thickened from `height` to `thickness`, in chords."""
    was = f"its trailing edge, {height:.2g} chords thick,"
    return Change(f"the outline is changed: {was} is opened to {thickness:g}")


def edge_notes(before: Airfoil, after: Airfoil, te: TrailingEdge, option: TrailingEdge) -> tuple[str, ...]:
    """Return a note on what `te` did to the trailing edge; `option` is what the user chose, or ``auto``."""
    base = f"the outline is changed: its base, {before.gap / before.chord:.3g} chords wide,"
    if before.blunt and te == "wedge":
        length = float(np.hypot(*(after.trailing_edge - before.trailing_edge))) / before.chord
        return (Change(f"{base} is closed by a wedge {length:.3g} chords long"),)
    if before.blunt and te == "round":
        return (Change(f"{base} is rounded at its corners"),)
    if not before.blunt and option != "auto":
        return (f"{{te}} {te} changes nothing, as the trailing edge is not blunt",)
    return ()


def _crossed(section: CleanSection, crossing: Crossing, places: Sequence[str]) -> InputError:
    n = len(section.points)
    ends = [section.index[k % n] for c in (crossing.first, crossing.second) for k in (c, c + 1)]
    a, b, c, d = (places[k] if places else f"point {k}" for k in ends)
    return InputError(
        f"the surface crosses itself at ({crossing.x:.6g}, {crossing.y:.6g}), "
        f"between {a} and {b} and between {c} and {d}",
        "correct these points, or give {smooth} about 3 times the noise of the points: no grid can be made "
        "around crossing surfaces",
    )


def farthest_arc(curve: Curve, point: Floats) -> float:
    """Return the arc length of the point of the curve that is farthest from `point`.

    If several points are equally far (a flat nose), the middle one counts, so that symmetry is kept.
    """
    s = np.concatenate([curve.knots, 0.5 * (curve.knots + np.append(curve.knots[1:], curve.length))])
    s = np.sort(s)
    off = curve.at(s) - point
    distance = np.hypot(off[:, 0], off[:, 1])
    best = np.flatnonzero(distance >= distance.max() * (1 - 1e-12))
    if best[-1] - best[0] > 1:
        return float(0.5 * (s[best[0]] + s[best[-1]]))
    low, high = float(s[best[0] - 1]), float(s[min(best[-1] + 1, len(s) - 1)])

    slopes = _slopes(curve, point, arcs := np.array([low, high]))
    if slopes[0] <= 0 or slopes[1] >= 0:
        return float(s[best[0]])
    for _ in range(2):  # subdivision, all parts at once: a call costs more than a point
        arcs = np.linspace(low, high, _PARTS + 1)
        slopes = _slopes(curve, point, arcs)
        k = max(int(np.argmax(slopes <= 0)), 1)
        low, high = float(arcs[k - 1]), float(arcs[k])
    fall = float(slopes[k - 1] - slopes[k])
    return low + (high - low) * float(slopes[k - 1]) / fall if fall > 0 else low


def _slopes(curve: Curve, point: Floats, arcs: Floats) -> Floats:
    """Return half the derivatives (m,) of the squared distance along the curve at `arcs` (m,)."""
    points, ways = curve.at(arcs) - point, curve.tangent(arcs)
    return np.asarray(points[:, 0] * ways[:, 0] + points[:, 1] * ways[:, 1])
