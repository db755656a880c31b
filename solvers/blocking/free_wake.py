"""Bodies with one sharp edge, and wakes that lead from it to the outer loop past all other bodies."""

from __future__ import annotations

import cmath
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, distinct
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.gap import wall_points
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.elementary import exp, expm1, times

SHARP_DEG = 300.0
"""Angle of the domain from which on an edge is sharp: one of the body of 60 degrees."""
MOST_BENT = np.radians(40.0)
"""Most that a wake may turn on its way from the bisector of the edge to the normal of the outer loop."""
RELAXATION = 0.5
"""Chords over which the wake does so."""
FREE = 0.15
"""Chords that the wake must stay away from other bodies."""
_NEAR = 5.0


@dataclass(frozen=True, eq=False)
class Wake:
    """The line (n, 2) from an edge to the outer loop, and the arc length of that where it ends."""

    points: Floats
    arc: float
    chord: float


def free_wake(domain: Domain, number: int, outer: Loop) -> Wake | None:
    """Return the wake of a body with one sharp edge and no other corner, None where it is not free.

    It leaves along the bisector of the edge and turns to the normal of `outer`, the loop it ends at.
    """
    loop = domain.loops[number]
    if number == 0 or len(loop.corners) != 1 or loop.corner_angles[0] < SHARP_DEG:
        return None
    edge = loop.corner_arcs[:1]
    begin = loop.at(edge)[0]
    chord = float(np.hypot(*(loop.curve.points - begin).T).max())
    sides = loop.tangent(np.array([edge[0] - 1e-4 * loop.length, edge[0] + 1e-4 * loop.length]))
    leaving = cmath.phase(complex(*(sides[0] - sides[1])))
    landing, turn = None, 0.0
    for _ in range(4):
        landing = _reach(begin, leaving, turn, chord, outer)
        if landing is None:
            return None
        along = outer.tangent(np.array([landing.arc]))[0]
        turn = cmath.phase(complex(along[1], -along[0]) * cmath.exp(-1j * leaving))
        if abs(turn) > MOST_BENT:
            return None
    others = [each for k, each in enumerate(domain.loops) if k not in (0, number)]
    if others and landing is not None:
        walls = wall_points(others)
        apart = landing.points[:, None] - walls[None]
        if np.hypot(apart[..., 0], apart[..., 1]).min() < FREE * chord:
            return None
    return landing


def _reach(begin: Floats, leaving: float, turn: float, chord: float, outer: Loop) -> Wake | None:
    """Return a wake that turns by `turn` on its way."""
    reach = float(np.hypot(*(outer.curve.points - begin).T).max()) * 1.5
    near = min(_NEAR * chord, reach)  # it is straight beyond
    s = distinct(np.append(np.linspace(0.0, near, 240), np.linspace(near, 1.01 * reach, 80)))
    middle = 0.5 * (s[1:] + s[:-1])
    angle = leaving + turn * -expm1(-middle / (RELAXATION * chord))
    step = np.diff(s) * exp(1j * angle)
    z = complex(*begin) + np.concatenate([[0.0], np.cumsum(step)])
    places = distinct(np.append(np.linspace(0.0, outer.length, 600, endpoint=False), outer.corner_arcs))
    at = outer.at(places)
    w = at[:, 0] + 1j * at[:, 1]
    v = np.roll(w, -1) - w
    area = times(np.conj(v)[:, None], step[None]).imag  # rows are of the loop
    t = times(np.conj(v)[:, None], (w[:, None] - z[None, :-1])).imag / np.where(area == 0, np.inf, area)
    u = times(np.conj(step)[None], (z[None, :-1] - w[:, None])).imag / np.where(area == 0, np.inf, -area)
    hit = (t >= 0) & (t < 1) & (u >= 0) & (u < 1)
    if not hit.any():
        return None
    k = int(np.argmax(hit.any(axis=0)))
    j = int(np.argmax(hit[:, k]))
    span = np.diff(places, append=outer.length + places[0])[j]
    arc = float(places[j] + u[j, k] * span)
    end = complex(*outer.at(np.array([arc]))[0])
    line = np.append(z[: k + 1], end)
    if k > 1 and abs(line[-1] - line[-2]) < 0.5 * abs(step[0]):
        line = np.delete(line, -2)
    return Wake(np.stack([line.real, line.imag], axis=1), arc, chord)
