"""Turns grid lines to the normals of body and wing near these walls.

A line at the distance a from another wall is moved over about half of a.
"""

from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, arc_lengths, norms
from meshonet.geometry.elementary import exp
from meshonet.solvers.aircraft.wing_lines import WingLines

_WAY = 0.6  # length over which a line is displaced, divided by its distance from the other wall
_TURN = 0.5  # length that takes the place of this distance beyond a tip, in chords of the tip
_OBLIQUE = 0.4  # largest cosine between the level and the mean direction of lines at the edge of a tip


def off_body(points: Floats, above: Floats, rings: Sequence[Indices], first: float) -> Floats:
    """Return `points` (k, p, 3), k on each of p lines, moved so that lines leave the body along normals.

    Parameters
    ----------
    above : (p, 3) points at the distance `first` from the starts of the lines, along normals of the body.
    rings : for each wing, indices (n, m) of lines; their starts are m loops of n nodes around the wing.
    """
    turned = (above - points[1]) / first
    turned[points[0, :, 2] == 0.0, 2] = 0.0
    away = [arc_lengths(points[0, ring]) for ring in rings]
    most = min(float(apart[:, -1].min()) for apart in away)
    beside = np.full(points.shape[1], most)
    for ring, apart in zip(rings, away, strict=True):
        beside[ring] = np.minimum(apart, most)
        beside[ring[:, :2]] = 0.0
    out = points + turned * _moved(points, beside)[..., None]
    at = beside > 0.0
    out[1, at] = _at(points[0, at], out[1, at], first)
    return out


def off_wing(points: Floats, ring: Indices, first: float, *, closed: bool) -> Floats:
    """Return `points` (k, p, 3), moved so that grid lines start from a wing at right angles to its span.

    k points are on each of p spanwise lines. `ring` (n, m) are indices of n x m of these lines: n around the
    wing, m away from its surface. If `closed`, the last of the n repeats the first. Cells at the wing are
    `first` high.
    """
    lines = np.moveaxis(points[:, ring], 2, 0)  # (m, k, n, 3), from the wing outwards
    wall, away = lines[0], (lines[1] - lines[0]) / first
    span = np.gradient(wall, axis=0)
    span /= norms(span)[..., None]
    square = away - (away * span).sum(axis=-1)[..., None] * span
    turned = square / norms(square)[..., None] - away
    arcs = arc_lengths(wall.swapaxes(0, 1)).T
    beside = np.minimum(arcs, arcs[-1] - arcs)
    beside[[0, 1, -2, -1]] = 0.0
    shape = lines.shape
    flat = lines.reshape(shape[0], -1, 3)
    most = norms(np.diff(flat, axis=0)).sum(axis=0)
    moved = flat + turned.reshape(-1, 3) * _moved(flat, np.minimum(beside.ravel(), most))[..., None]
    at = beside.ravel() > 0.0
    moved[1, at] = _at(flat[0, at], moved[1, at], first)
    out = points.copy()
    out[:, ring] = np.moveaxis(moved.reshape(shape), 0, 2)
    if closed:
        out[:, ring[-1]] = out[:, ring[0]]
    return out


def across_tip(
    low: Floats, high: Floats, ring: Indices, wing: WingLines, first: float
) -> tuple[Floats, Floats]:
    """Return nodes on both sides of a wing tip, moved so that cells at the tip are less oblique.

    `low` (inboard of the tip) and `high` (outboard) are (k, p, 3): k nodes on each of p spanwise lines.
    `ring` (n, m) are indices of n x m lines: n around the wing, m away from its surface. Cells at the wing
    stay `first` high.
    """
    level = high[0, ring]
    along, lines = wing.axis, low[-1, ring[:, 0]] - low[-2, ring[:, 0]]
    middle = along + lines / norms(lines)[:, None]
    middle /= norms(middle)[:, None]
    away = level[:, 1] - level[:, 0]
    away /= norms(away)[:, None]
    part = (away * middle).sum(axis=1)
    less = np.clip(part, -_OBLIQUE, _OBLIQUE)
    square = away - part[:, None] * middle
    square *= (np.sqrt(1.0 - less * less) / norms(square))[:, None]
    turned = square + less[:, None] * middle - away
    reach = _TURN * _chord(level[:, 0], wing)
    moved = turned[:, None] * _moved(level.swapaxes(0, 1), np.full(len(level), reach)).T[..., None]
    out = []
    for points in (low[::-1], high):
        arcs = arc_lengths(points[:, ring].transpose(1, 2, 0, 3))
        way = arcs / (_WAY * reach)
        fade = exp(-way) * (1.0 + way) * (1.0 - arcs / arcs[..., -1:]) ** 2
        near = points.copy()
        near[:, ring] += (fade[..., None] * moved[:, :, None]).transpose(2, 0, 1, 3)
        out.append(near)
    below, beyond = out[0][::-1], out[1]
    wall, beside = ring[:, 0], ring[:, 1]
    below[1:, beside] = _at(below[1:, wall], below[1:, beside], first)
    beyond[0, beside] = below[-1, beside]
    return below, beyond


def _chord(edge: Floats, wing: WingLines) -> float:
    return (1.0 if wing.fin else 0.5) * float(norms(np.diff(edge, axis=0)).sum())


def off_tip(points: Floats, cap: Indices, ring: Indices, wing: WingLines) -> Floats:
    """Return nodes `points` (k, p, 3) of p lines beyond a wing tip, moved so that lines start normal to it.

    `cap` (c,) are indices of lines that start on the tip. `ring` (n, m) are indices of lines that start
    beside it: n around its edge, m at increasing distance from the edge. Lines far from the tip move less.
    """
    apart = arc_lengths(points[0, ring])
    fade = 1.0 - apart / apart[:, -1:]
    columns = np.concatenate([cap, ring.ravel()])
    away = points[1, columns] - points[0, columns]
    first = norms(away)
    turned = wing.axis - away / first[:, None]
    chord = _chord(points[0, ring[:, 0]], wing)
    share = np.concatenate([np.ones(len(cap)), (fade * fade).ravel()])
    out = points.copy()
    out[:, columns] += (
        turned * (share * _moved(points[:, columns], np.full(len(columns), _TURN * chord)))[..., None]
    )
    out[1, columns] = _at(out[0, columns], out[1, columns], first)
    return out


def _moved(lines: Floats, beside: Floats) -> Floats:
    """Return the moves of nodes of lines (k, p, 3) per unit of turn, at distances (p,) from another wall."""
    arcs = arc_lengths(lines.swapaxes(0, 1)).T
    way = np.where(beside > 0.0, _WAY * beside, 1.0)
    fade = 1.0 - arcs / arcs[-1]
    return np.where(beside > 0.0, arcs * exp(-arcs / way) * fade * fade, 0.0)


def _at(wall: Floats, beside: Floats, first: Floats | float) -> Floats:
    """Return points (..., 3) towards `beside` at the distance `first` from a wall."""
    away = beside - wall
    return wall + away * (first / norms(away))[..., None]
