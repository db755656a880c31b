"""Wall nodes by the conformal map of the outside of a body to the outside of a circle.

Equal steps of the circle's angle t are dense where the body turns, and let lines leave it at right angles.
Theodorsen's iteration finds t from the wall psi(phi) in the strip (`lift`)::

    phi(t) = t - H[psi(phi(t))],   H the conjugation of Fourier series: cos kt -> sin kt

Theodorsen & Garrick, NACA Report 452 (1933); Henrici, Applied and Computational Complex Analysis 3, 16.8
(1986).
"""

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.geometry.conformal.lift import lift_body, mirrored
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.curves.monotone import inner_slopes
from meshonet.geometry.elementary import cos, exp, power, times
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.sampling import first_within

ANGLES = 1024  # points on the circle at which the angle is computed
ITERATIONS = 28.0  # at most, over the factor of under-relaxation
RELAXATIONS = 0.7, 0.3, 0.1, 0.03, 0.01
"""Factors of under-relaxation tried in turn; those below 2 / (1 + e^2) converge if |dpsi/dphi| <= e."""
DENSE = 640  # points that represent the whole wall


def conformal_knots(
    curve: Curve, marks: Floats, count: int, at: NDArray[np.intp] | None = None, steps: tuple[int, ...] = (1,)
) -> Floats:
    """Return arc lengths (count,) on a closed curve at equal angles of its conformal map to a circle.

    The curve is clockwise from its first node, which is repeated.

    Parameters
    ----------
    marks : (m,) ascending arc lengths in (0, length) at which there must be nodes.
    at : (m,) indices of the nodes at `marks`; if None, they are multiples of one of the numbers `steps`.
    steps : largest first; the first is used that is at most the number of cells, all of equal angle, between
        the first node and the mark that is nearest to it along the circle.

    Raises InputError: the conformal angle does not increase along the curve; no convergence.
    """
    back = None if at is None else count - 1 - at[::-1]
    clockwise = _one_way(curve, marks, count, at, steps, mirror=False)
    mirrored_wall = _one_way(curve, curve.length - marks[::-1], count, back, steps, mirror=True)
    # the two directions differ by the iteration error; with their mean a mirrored body gets mirrored nodes
    knots = 0.5 * (clockwise + (curve.length - mirrored_wall[::-1]))
    knots[np.searchsorted(knots, marks - 1e-9 * curve.length)] = marks
    return knots


def _one_way(
    curve: Curve,
    marks: Floats,
    count: int,
    at: NDArray[np.intp] | None,
    steps: tuple[int, ...],
    *,
    mirror: bool,
) -> Floats:
    """Return arc lengths (count,) clockwise, or counter-clockwise on the mirrored curve."""
    s, u = _dense(curve, marks)
    nodes = curve.at(curve.length - s[:-1]) * np.array([1.0, -1.0]) if mirror else curve.at(s[:-1])
    _, w, _ = lift_body(mirrored(nodes))
    phi = np.append(w.imag, 2.0 * np.pi)
    if np.diff(phi).min() <= 0.0:
        raise InputError("the lifted wall is not star-shaped", "use another spacing")
    t = _circle_angle(phi, np.append(w.real, w.real[0]))
    index = _shared_out(np.interp(marks, s, t), count, at, steps)
    return _smooth_inverse(t, u, s, index)


def _dense(curve: Curve, marks: Floats) -> tuple[Floats, Floats]:
    """Return ascending arc lengths (m,), clustered at both ends of every piece, and their parameter u.

    On piece k, u = k + v with s = s_k + length (1 - cos pi v)/2.
    """
    ends = np.concatenate([[0.0], marks, [curve.length]])
    s, u = [], []
    for k, (a, b) in enumerate(pairwise(ends)):
        n = max(24, round(DENSE * np.sqrt((b - a) / curve.length)))
        v = np.arange(n) / n
        s.append(a + (b - a) * 0.5 * (1.0 - cos(np.pi * v)))
        u.append(k + v)
    return np.concatenate([*s, [curve.length]]), np.concatenate([*u, [len(ends) - 1.0]])


def _circle_angle(phi: Floats, psi: Floats) -> Floats:
    """Return the circle's angle t at every wall point, from 0 to 2 pi."""
    t = 2.0 * np.pi * np.arange(ANGLES) / ANGLES
    k = np.fft.rfftfreq(ANGLES, 1.0 / ANGLES)
    conjugate = -1j * exp(-power(k / (ANGLES / 3.0), 8))
    conjugate[0] = 0.0
    for relaxation in RELAXATIONS:
        at = t.copy()
        for _ in range(math.ceil(ITERATIONS / relaxation)):
            wall = np.interp(np.mod(at, 2.0 * np.pi), phi, psi)
            new = t - np.fft.irfft(times(conjugate, np.fft.rfft(wall)), ANGLES)
            change = float(np.abs(new - at).max())
            at += relaxation * (new - at)
            if change < 1e-7:
                break
        if change < 1e-3 and np.diff(at).min() > 0.0:
            break
    else:
        raise InputError("the conformal spacing does not settle", "use another spacing")
    around = np.concatenate([at - 2.0 * np.pi, at, at + 2.0 * np.pi])
    angle = np.interp(phi, around, np.concatenate([t - 2.0 * np.pi, t, t + 2.0 * np.pi]))
    return np.asarray(angle - angle[0])


def _shared_out(marks: Floats, count: int, at: NDArray[np.intp] | None, steps: tuple[int, ...]) -> Floats:
    """Return ascending angles (count,) from 0 to 2 pi in nearly equal steps, with every mark on a node."""
    cells = count - 1
    rank = np.arange(len(marks))
    nodes: Floats | NDArray[np.intp]
    if at is not None:
        nodes = at
    elif not len(marks):
        nodes = np.empty(0)
    else:
        ends = marks[[0, -1]]
        least = min(float(ends[0]), 2.0 * np.pi - float(ends[1])) / (2.0 * np.pi) * cells
        step = first_within(steps, 1.0000001 * least)
        step = step if cells // step > len(marks) else 1
        whole = cells // step
        nodes = np.clip(np.round(marks / (2.0 * np.pi) * whole), 1 + rank, whole - 1 - rank[::-1]) * step
    knots = np.concatenate([[0.0], nodes, [float(cells)]])
    angles = np.concatenate([[0.0], marks, [2.0 * np.pi]])
    return _monotone(knots, angles, np.arange(count, dtype=np.float64), periodic=True)


def _smooth_inverse(t: Floats, u: Floats, s: Floats, at: Floats) -> Floats:
    """Return arc lengths at circle angles `at`, through u: s(u) is analytic at corners."""
    where = _monotone(t, u, at, periodic=False)
    k = np.minimum(where.astype(np.intp), round(u[-1]) - 1)
    ends = s[np.searchsorted(u, np.arange(round(u[-1]) + 1.0))]
    knots = ends[k] + (ends[k + 1] - ends[k]) * 0.5 * (1.0 - cos(np.pi * (where - k)))
    knots[0], knots[-1] = s[0], s[-1]
    on_mark = np.abs(where - np.round(where)) < 1e-9
    knots[on_mark] = ends[np.round(where[on_mark]).astype(np.intp)]
    return np.asarray(knots)


def _monotone(x: Floats, y: Floats, at: Floats, *, periodic: bool) -> Floats:
    """Return the monotone cubic through ascending (x, y) at `at`."""
    h = np.diff(x)
    rise = np.diff(y) / h
    if periodic:
        inner = inner_slopes(np.append(h, h[0]), np.append(rise, rise[0]))
        slope = np.concatenate([inner[-1:], inner])
    else:
        slope = np.concatenate([rise[:1], inner_slopes(h, rise), rise[-1:]])
    k = np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(h) - 1)
    v = (at - x[k]) / h[k]
    value = (
        y[k] * (1 + 2 * v) * (1 - v) ** 2
        + y[k + 1] * v**2 * (3 - 2 * v)
        + h[k] * (slope[k] * v * (1 - v) ** 2 - slope[k + 1] * v**2 * (1 - v))
    )
    return np.asarray(value)
