"""Periodic sides of a domain: translated copies of each other, checked and matched by their names."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from meshonet.geometry.arrays import Floats, shortest_ways
from meshonet.geometry.errors import InputError

if TYPE_CHECKING:
    from meshonet.geometry.domain.domain import Domain
    from meshonet.geometry.domain.loop import Loop

SAME = 1e-6
"""Largest distance between the moved first side and the second side, divided by the extent of the domain."""
_SAMPLES = 129  # points at which two sides are compared
_NOTHING = 1e-9  # part of a shift below which a coordinate of it is rounding of the input
_BITS = 50  # of coordinates that are kept where sums of them have to be exact


@dataclass(frozen=True)
class Periodic:
    """Two periodic parts of the outer loop; `shift` moves the first onto the second."""

    first: tuple[float, float]
    """Arc lengths where the first stretch starts and ends, in the direction of the loop."""
    second: tuple[float, float]
    shift: tuple[float, float]
    names: tuple[str, str] = ("periodic1", "periodic2")


def rounded(values: Floats, domain: Domain) -> Floats:
    """Return coordinates (..., 2), rounded so that shifts can be added in any order with the same result.

    If the periodic shifts of the domain are along different axes, nothing is rounded.
    """
    shifts = np.unique(np.abs([each.shift for each in domain.periodic]), axis=0)
    if (np.count_nonzero(shifts, axis=0) < 2).all():
        return values
    most = float(np.abs(domain.loops[0].curve.points).max())
    unit = math.ldexp(1.0, math.ceil(math.log2(most)) - _BITS)
    return np.asarray(np.round(values / unit) * unit)


def with_periodic_sides(domain: Domain, pairs: Sequence[tuple[str, str]]) -> Domain:
    """Return the domain with periodic sides of its outer loop; `pairs` gives the two names of each pair.

    Points at which a periodic side turns by less than 45 degrees are no longer corners: nodes there may
    move. Raises InputError: no part of the outer loop has one of the names; a name is given twice; the
    sides of a pair are not translated copies of each other (the message gives the distance).
    """
    if not pairs:
        return domain
    _check_names(domain, pairs)
    loop = _without_kinks(domain.loops[0], {name for pair in pairs for name in pair})
    matches = tuple(each for pair in pairs for each in _matched(loop, pair, domain.extent))
    loop = _with_cells(loop, matches)
    made = replace(domain, loops=(loop, *domain.loops[1:]), periodic=(*domain.periodic, *matches))
    shifts = rounded(np.array([each.shift for each in made.periodic]), made).tolist()
    exact = (replace(each, shift=(x, y)) for each, (x, y) in zip(made.periodic, shifts, strict=True))
    return replace(made, periodic=tuple(exact))


def _check_names(domain: Domain, pairs: Sequence[tuple[str, str]]) -> None:
    known = list(dict.fromkeys(domain.loops[0].names))
    taken = [name for name in known for each in domain.periodic if name in each.names]
    named = [*dict.fromkeys(taken), *(name for pair in pairs for name in pair)]
    for name in named:
        if name not in known:
            remedy = f"use sides of the outer boundary: {', '.join(known)}"
            raise InputError(f"there is no side {name!r} to be periodic", remedy, parameter="periodic")
        if named.count(name) > 1:
            remedy = "name each side once, with the one that it is a copy of"
            raise InputError(f"side {name!r} is periodic twice", remedy, parameter="periodic")


def _without_kinks(loop: Loop, names: set[str]) -> Loop:
    """Return the loop without corners of two cells between stretches of the same periodic side."""
    labels = loop.names
    kept = [
        k
        for k in range(len(loop.corners))
        if labels[k] != labels[k - 1] or labels[k] not in names or loop.corner_cells[k] != 2
    ]
    corners = tuple(loop.corners[k] for k in kept)
    cells = tuple(loop.cells[k] for k in kept if loop.cells)
    return replace(loop, corners=corners, names=tuple(labels[k] for k in kept), cells=cells)


def _matched(loop: Loop, names: tuple[str, str], extent: float) -> list[Periodic]:
    """Return the stretches of two sides in pairs, each with the same shift."""
    first, second = (_stretches(loop, name) for name in names)
    sides = f"sides {names[0]!r} and {names[1]!r}"
    if len(first) != len(second):
        parts = f"{sides} have {len(first)} and {len(second)} parts between corners"
        raise InputError(parts, "make one a translated copy of the other", parameter="periodic")
    starts, stops = (loop.at(np.array(arcs)) for arcs in ([a for a, _ in first], [b for _, b in second]))
    best, distance, order = np.zeros(2), math.inf, list(range(len(second)))
    for stop in stops:
        shift = stop - starts[0]
        nearest = [int(np.argmin(np.hypot(*(stops - start - shift).T))) for start in starts]
        if len(set(nearest)) < len(nearest):
            continue
        off = max(_distance(loop, own, second[k], shift) for own, k in zip(first, nearest, strict=True))
        if off < distance:
            best, distance, order = shift, off, nearest
    if not distance <= SAME * extent:
        off_by = f"by {distance:.3g}, {distance / extent:.2g} of the extent" if distance < math.inf else ""
        remedy = "make one a translated copy of the other"
        raise InputError(f"{sides} differ {off_by}".rstrip(), remedy, parameter="periodic")
    size = float(np.hypot(*best))
    moved = [0.0 if abs(value) < _NOTHING * size else value for value in best.tolist()]
    return [
        Periodic(own, second[k], (moved[0], moved[1]), names) for own, k in zip(first, order, strict=True)
    ]


def _stretches(loop: Loop, name: str) -> list[tuple[float, float]]:
    """Return the arc lengths at which the stretches of a name start and end, the end after the start."""
    arcs, count = loop.corner_arcs.tolist(), len(loop.corners)
    stretches = []
    for k in range(count):
        if loop.names[k] != name:
            continue
        stop = arcs[(k + 1) % count]
        stretches.append((arcs[k], stop if stop > arcs[k] else stop + loop.length))
    return stretches


def _with_cells(loop: Loop, pairs: Sequence[Periodic]) -> Loop:
    """Return the loop with numbers of cells at the ends of periodic sides for which both together have room.

    A side that cuts a smooth wall has 180 degrees at both ends together, for one cell each.
    """
    cells, arcs, length = loop.corner_cells.copy(), loop.corner_arcs, loop.length
    for each in pairs:
        for ends in zip(each.first, each.second[::-1], strict=True):
            both = [int(np.abs(shortest_ways(arcs - arc, length)).argmin()) for arc in ends]
            room = max(2, round(float(loop.corner_angles[both].sum()) / 90.0))
            for k in both:
                if cells[k] == 2 and cells[both].sum() > room:
                    cells[k] = 1
                if cells[k] == 2:
                    x, y = loop.at(arcs[k : k + 1])[0]
                    problem = (
                        f"a periodic side ends at ({x:.6g}, {y:.6g}), where the boundary goes straight on"
                    )
                    raise InputError(problem, "end it at a corner", parameter="periodic")
    return replace(loop, cells=tuple(cells.tolist()))


def _distance(loop: Loop, own: tuple[float, float], other: tuple[float, float], shift: Floats) -> float:
    """Return the largest distance between a stretch, moved, and another one, which runs the other way."""
    part = np.linspace(0.0, 1.0, _SAMPLES)
    points, beyond = (loop.at(start + part * (stop - start)) for start, stop in (own, other[::-1]))
    return float(np.hypot(*(points + shift - beyond).T).max())
