"""From the points of an airfoil file to a clean closed polygon that starts at the trailing edge.

Points do not move, except that both ends of a negligible gap become their mean.
"""

import math
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, along_and_across, distinct, norms
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import check_extent, polygon_area
from meshonet.geometry.polygon.corners import find_corners, turning

SHARP_GAP = 2e-4  # gap in chords below which a trailing edge is sharp; a smaller limit folds more real grids
SAME_POINT = 1e-5  # nearer points, relative to the extent, are one: their direction is noise of a last digit
ON_BASE = 5e-5  # distance, in chords, from the straight base up to which a point is dropped as lying on it
MOST_CORNERS = 12  # if there are more corners, with those of the trailing edge, they are noise: none is kept
_CORNER = np.radians(35.0)  # least turn of a corner of the trailing edge
_STRAIGHT = np.radians(5.0)  # largest turn of the middle of a base
_SHORT = 5.0  # least length of half a base over the pieces that round its corners
_EDGE = np.radians(120.0)  # least turn of a single corner that is a sharp edge
_REACH = 8  # number of first and of last points among which the corners of a base are sought


@dataclass(frozen=True, eq=False)
class CleanSection:
    """A clean closed polygon (n, 2), clockwise from a sharp trailing edge or from the lower corner of a base.

    The base (blunt trailing edge) is the segment from the last point, its upper corner, to the first.
    """

    points: Floats
    index: Indices  # (n,) index of each point among the given ones
    blunt: bool
    gap: float  # distance between the two ends of the surfaces, before a sharp edge was closed
    corners: Indices  # indices of the points at which the tangent jumps, including those of the trailing edge
    swapped: tuple[int, ...] = ()  # indices of given points that were in the wrong order

    def moved_apart(self) -> Self:
        """Return the section; surfaces that nearly touch are moved apart (see `separate_surfaces`)."""
        from meshonet.geometry.shapes.airfoil.separate_surfaces import moved_apart

        edge = 0.5 * (self.points[0] + self.points[-1]) if self.blunt else self.points[0]
        return replace(self, points=moved_apart(self.points, int(np.argmax(norms(self.points - edge)))))


def clean_section(points: Floats) -> CleanSection:
    """Return the section through `points` (n, 2), which are in clockwise or anticlockwise order.

    The first point is taken as the trailing edge unless the opposite end is clearly sharper. Repeated points
    and points on a straight, blunt edge are removed. Neighbours in the wrong order are swapped. Raises
    InputError: fewer than 4 distinct points; no area; ends too far apart for a trailing edge.
    """
    raw = np.asarray(points, dtype=np.float64)
    extent = float(np.hypot(*np.ptp(raw, axis=0))) if len(raw) else 0.0
    check_extent(extent)
    distinct_points = _distinct(raw, SAME_POINT * extent)
    index = _in_order(raw, distinct_points)
    swapped = tuple(sorted(index[index != distinct_points].tolist()))
    ring = raw[index]
    open_gap = np.hypot(*(ring[0] - ring[-1])) > SAME_POINT * extent
    if not open_gap:
        ring, index = ring[:-1], index[:-1]
    if open_gap and (middle := _middle_of_base(ring, SAME_POINT * extent)) >= 0:
        ring, index = np.roll(ring, -middle, axis=0)[1:], np.roll(index, -middle)[1:]
    if len(ring) < 4:
        remedy = "an airfoil needs at least 4, and many more to be smooth"
        raise InputError(f"{len(ring)} distinct points", remedy)
    area = polygon_area(ring)
    if abs(area) < 1e-5 * extent**2:
        raise InputError("the points enclose no area", "give both surfaces of an airfoil")
    if area > 0:
        order = np.arange(len(ring))[::-1] if open_gap else np.roll(np.arange(len(ring))[::-1], 1)
        ring, index = ring[order], index[order]
    return replace(_opened_at_edge(ring, index, bool(open_gap)), swapped=swapped)


def _middle_of_base(ring: Floats, tolerance: float) -> int:
    """Return the index of the first or last point if it is within a straight base, or -1."""
    if len(ring) <= 5:
        return -1
    turn = np.abs(turning(ring, closed=True))
    for k in (0, len(ring) - 1):
        near = np.arange(k - 2, k + 3) % len(ring)
        pieces = norms(np.diff(ring[near], axis=0))
        off = float(norms(ring[k] - 0.5 * (ring[near[1]] + ring[near[3]])))
        corner = turn[near[[1, 3]]].max() > _CORNER or pieces[1] > _SHORT * pieces[[0, 3]].max()
        if off <= tolerance and turn[k] < _STRAIGHT and corner:
            return k
    return -1


def _distinct(points: Floats, tolerance: float) -> Indices:
    """Return indices of points that differ from their neighbours, and of both ends."""
    n = len(points)
    if (np.hypot(*np.diff(points, axis=0).T) > tolerance).all():
        return np.arange(n)
    half = n // 2
    first = _thinned(points[: half + 1], tolerance)
    second = n - 1 - _thinned(points[half:][::-1], tolerance)[::-1]
    keep = distinct(np.concatenate([first, second]))
    # the two halves meet in the middle, where both kept their last point
    close = np.flatnonzero(np.hypot(*np.diff(points[keep], axis=0).T) <= tolerance)
    inner = close[(close > 0) & (close < len(keep) - 2)] + 1
    return np.delete(keep, inner)


def _in_order(points: Floats, index: Indices) -> Indices:
    """Return indices, with neighbours swapped where this shortens the polygon by more than their distance.

    Swapping the two sides of a thin edge hardly changes the length.
    """
    order = index.copy()
    for _ in range(50):
        p = points[order]
        gain = norms(p[:-3] - p[1:-2]) + norms(p[2:-1] - p[3:])
        gain -= norms(p[:-3] - p[2:-1]) + norms(p[1:-2] - p[3:]) + norms(p[1:-2] - p[2:-1])
        if len(gain) == 0 or gain.max() <= 0:
            break
        k = int(np.argmax(gain))
        order[k + 1], order[k + 2] = order[k + 2], order[k + 1]
    return order


def _thinned(points: Floats, tolerance: float) -> Indices:
    """Return indices of points farther than `tolerance` from the last point that was kept."""
    step = np.hypot(*np.diff(points, axis=0).T)
    if (step > tolerance).all():
        return np.arange(len(points))
    keep = [0]
    for k in range(1, len(points)):
        if np.hypot(*(points[k] - points[keep[-1]])) > tolerance:
            keep.append(k)
    return np.array(keep, dtype=np.intp)


def _opened_at_edge(ring: Floats, index: Indices, open_gap: bool) -> CleanSection:
    """Return the section of a clockwise polygon that starts, or has its gap, where the file starts."""
    seam = 0.5 * (ring[0] + ring[-1]) if open_gap else ring[0]
    nose = int(np.argmax(norms(ring - seam)))
    chord = float(norms(ring[nose] - seam))
    gap = float(norms(ring[0] - ring[-1])) if open_gap else 0.0
    if gap > 0.5 * chord and gap > 3 * np.median(norms(ring[1:] - ring[:-1])):
        apart = f"the first and the last point lie {gap / chord:.2g} chords apart"
        raise InputError(apart, "give both surfaces of an airfoil")
    tail = int(np.argmax(norms(ring - ring[nose])))
    start = tail if open_gap else 0
    turn = -turning(ring, closed=True)
    if norms(ring[tail] - seam) > max(0.15 * chord, gap):
        edge = max((nose, tail), key=lambda k: _sharpness(ring, k, tail if k == nose else nose)[0])
    elif _starts_at_nose(ring, start, nose, open_gap):
        edge = nose
    elif not open_gap and turn[0] < _CORNER < turn[tail]:
        edge = tail  # the points start next to their edge, or on its base
    else:
        edge = -1
    if edge >= 0:
        ring, index, open_gap = np.roll(ring, -edge, axis=0), np.roll(index, -edge), False
        chord = float(norms(ring - ring[0]).max())
    return _based(ring, index, open_gap, chord)


def _starts_at_nose(ring: Floats, start: int, far_end: int, open_gap: bool) -> bool:
    """Return whether the points start at a round end, and the other end is clearly the trailing edge."""
    here, there = _sharpness(ring, start, far_end), _sharpness(ring, far_end, start)
    if here[0] >= 0.6:
        return False
    if there[0] > 0.7 and there[1] < 0.7 * here[1]:
        return True
    return not open_gap and _has_base(ring, far_end) and not _has_base(ring, start)


def _has_base(ring: Floats, k: int) -> bool:
    """Return whether two adjacent points near point k turn by 50 degrees each, 130 in total."""
    n = len(ring)
    turn = -turning(ring, closed=True)
    near = np.arange(k - 3, k + 4) % n
    here, after = turn[near], turn[(near + 1) % n]
    return bool(((np.minimum(here, after) > np.radians(50.0)) & (here + after > np.radians(130.0))).any())


def _sharpness(ring: Floats, end: int, far_end: int) -> tuple[float, float]:
    """Return (p, t): behind ring[end] thickness grows like distance to the power p; t at 5 % chord.

    p is about 0.35 at a round leading edge, 0.85 at a wedge, 1.5 at a cusp, measured between 5 % and 20 %.
    """
    n = len(ring)
    axis = ring[far_end] - ring[end]
    chord = np.hypot(*axis)
    along, across = along_and_across(ring - ring[end], axis / chord)
    thick = []
    for part in (0.05, 0.2):
        sides = []
        for arc in (_stretch(end, far_end, n), _stretch(far_end, end, n)):
            order = np.argsort(along[arc], kind="stable")
            sides.append(float(np.interp(part * chord, along[arc][order], across[arc][order])))
        thick.append(max(abs(sides[1] - sides[0]), 1e-9 * chord))
    return math.log(thick[1] / thick[0]) / math.log(4.0), thick[0]


def _based(ring: Floats, index: Indices, open_gap: bool, chord: float) -> CleanSection:
    """Return the section of a polygon from its trailing edge, with or without a base."""
    gap = float(norms(ring[0] - ring[-1])) if open_gap else 0.0
    if open_gap and gap < SHARP_GAP * chord:
        ring = ring.copy()
        ring[0] = 0.5 * (ring[0] + ring[-1])
        return _section(ring[:-1], index[:-1], False, gap)
    turn = -turning(ring, closed=True)
    last, reach = len(ring) - 1, min(_REACH, len(ring) // 3)
    ahead = np.flatnonzero(turn[: reach + 1] > _CORNER).tolist()
    behind = (last - np.flatnonzero(turn[: last - reach : -1] > _CORNER)).tolist()
    pairs, edges = [(behind[0], ahead[0])] if behind and ahead else [], [0]
    if open_gap:
        edges = [k for k in (*ahead[:1], *behind[:1]) if turn[k] > _EDGE and k in (0, last)]
    elif turn[0] > _CORNER:
        pairs = [] if turn[0] > _EDGE else [(0, k) for k in ahead[1:2]] + [(k, 0) for k in behind[:1]]
    for upper, lower in pairs:
        base = ring[_stretch(upper, lower, len(ring))]
        if turn[upper] + turn[lower] > np.radians(100.0) and _off_line(base) <= ON_BASE * chord:
            keep = _stretch(lower, upper, len(ring))
            gap = float(norms(ring[upper] - ring[lower]))
            ring, index = ring[keep], index[keep]
            if gap >= SHARP_GAP * chord:
                return _section(ring, index, True, gap)
            ring[0] = 0.5 * (ring[0] + ring[-1])
            return _section(ring[:-1], index[:-1], False, gap)
    if edges:
        return _section(np.roll(ring, -edges[0], axis=0), np.roll(index, -edges[0]), False, 0.0)
    return _section(ring, index, open_gap, gap)


def _section(ring: Floats, index: Indices, blunt: bool, gap: float) -> CleanSection:
    """Return the section with its corners; a round leading edge of few points is none."""
    edge = 0.5 * (ring[0] + ring[-1]) if blunt else ring[0]
    distance = norms(ring - edge)
    nose = int(np.argmax(distance))
    turn = np.abs(turning(ring, closed=True))
    n = len(ring)
    if blunt and nose in (0, n - 1):
        raise InputError("the base is wider than the section is long", "give both surfaces of an airfoil")
    candidates = find_corners(ring, closed=True, few=0)
    apart = np.minimum((candidates - nose) % n, (nose - candidates) % n)
    near_nose = (apart <= 1) | (norms(ring[candidates] - ring[nose]) < 0.03 * distance[nose])
    far = candidates[~near_nose]
    corners = set(far.tolist() if len(far) <= MOST_CORNERS else [])
    if turn[nose] > np.radians(60.0) and _sharpness(ring, nose, 0)[0] > 0.7:
        corners.add(nose)
    for k in (nose - 1, nose):  # a flat nose: two adjacent corners, with straight lines from both
        around = turn[np.arange(k - 1, k + 3) % n]
        if around[1:3].min() > np.radians(70.0) and around[[0, 3]].max() < np.radians(15.0):
            corners |= {k, (k + 1) % n}
    if blunt:
        corners |= {0, n - 1}
    elif turn[0] > np.radians(60.0):
        corners.add(0)
    return CleanSection(ring, index, blunt, gap, np.array(sorted(corners), dtype=np.intp))


def _stretch(start: int, stop: int, n: int) -> Indices:
    """Return the indices from `start` to `stop`, both included, in a closed polygon of n points."""
    return np.arange(start, start + (stop - start) % n + 1) % n


def _off_line(points: Floats) -> float:
    """Return the largest distance of points (n, 2) from the straight line between the first and the last."""
    along = points[-1] - points[0]
    length = np.hypot(*along)
    if len(points) < 3 or length == 0:
        return 0.0
    off = points[1:-1] - points[0]
    return float(np.abs(along[0] * off[:, 1] - along[1] * off[:, 0]).max() / length)
