"""Grids near Winslow's (J. Comput. Phys. 1 (1966) 149) by Picard steps; Swarztrauber, SIAM Rev. 19 (1977)."""

from functools import lru_cache
from typing import Any

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats, array_like, read_only
from meshonet.geometry.elementary import cos, sin
from meshonet.kernels._native import LINE, winslow_steps
from meshonet.solvers.elliptic.winslow import left_side
from meshonet.solvers.neural.quad.encoding import LATENT, planes_of

STEPS = 4  # after the harmonic grid; a fifth would reduce the error by a tenth on average
AFTER = 3  # steps after the network's Winslow output
FINER = 65  # most nodes along a direction that these are taken on: splines from 33 err by 3e-4
SHARE = 0.75  # fraction of the leading error of differences that is corrected
GROWTH = 4.0  # a step whose square is so many times the last one's, in the mean, is not taken

TINY = 1e-30  # keeps quotients finite where nothing moves

# differences of five values
THIRD, FOURTH = np.array([[-0.5, 1.0, 0.0, -1.0, 0.5], [1.0, -4.0, 6.0, -4.0, 1.0]])


def approach(
    z: Any, xp: Any, around: bool = False, steps: int = STEPS, *, harmonic: bool = True
) -> tuple[Any, Any]:
    """Return grids nearer to Winslow's solution than `z`, and their last change; boundary nodes stay.

    Each Picard step inverts, by sine transforms, an operator with constant coefficients. They are the means
    over the domain of alpha / (alpha + gamma) and gamma / (alpha + gamma). Winslow's equations are::

        alpha z_xixi - 2 beta z_xieta + gamma z_etaeta = 0,
        alpha = |z_eta|^2, beta = z_xi . z_eta, gamma = |z_xi|^2        of the previous iterate

    `z` (batch, n, n) are nodes x + i y of grids of unit size, arrays of `xp`, numpy or torch. With `around`,
    `z` (batch, m + 1, n) are O grids mapped to periodic strips by i log(z - centre), so that ``z[:, m]`` is
    ``z[:, 0]`` plus one period. With `harmonic`, steps start from the solution of z_xixi + z_etaeta = 0 that
    has the boundary of `z`. Without it, they start from `z`, and are accelerated by Anderson's method with
    one previous iterate, J. ACM 12 (1965) 547-560.
    """
    if xp is np:
        return _compiled(z, around, steps, harmonic)
    p = xp.stack([z.real, z.imag], 1)
    turn = p[:, :, -1:] - p[:, :, :1]
    if around:
        p = p[:, :, :-1]
    (left, slow), (right, fast) = (_waves(p, axis, xp, around and axis == 2) for axis in (2, 3))
    move, step, size = 0.0 * p, 0.0 * p, xp.inf + 0.0 * p[:, :1, :1, :1]
    for k in range(0 if harmonic else 1, steps + 1):
        ring = xp.concatenate([p[:, :, -2:] - turn, p, p[:, :, :2] + turn], 2) if around else p
        missed, alpha, gamma = _missed(ring, xp, around, SHARE if k else 0.0, linear=k == 0)
        inner = left @ ((left @ missed @ right) / (alpha * slow[:, None] + gamma * fast)) @ right
        square = (inner**2).mean((1, 2, 3))[:, None, None, None]
        taken = square < GROWTH * size  # and a number
        correction = xp.nn.functional.pad(inner, (1, 1) if around else (1, 1, 1, 1))
        move = correction if harmonic or k == 1 else _extrapolated(correction, step, move, xp)
        move, step = (xp.where(taken, value, 0.0 * step) for value in (move, correction))
        size, p = xp.where(taken, square, size), p + move
    if around:
        p, step = xp.concatenate([p, p[:, :, :1] + turn], 2), xp.concatenate([step, step[:, :, :1]], 2)
    return p[:, 0] + 1j * p[:, 1], step[:, 0] + 1j * step[:, 1]


def _compiled(z: Complexes, around: bool, steps: int, harmonic: bool) -> tuple[Complexes, Complexes]:
    near = planes_of(z)
    last, (m, n) = np.empty_like(near), z.shape[1:]
    turns = np.ascontiguousarray(near[:, :, -1] - near[:, :, 0])
    tables = _padded(m - 1 if around else m, around), _padded(n, around=False)
    winslow_steps(near, turns, harmonic, steps, SHARE, GROWTH, *tables, around, last)
    return near[:, 0] + 1j * near[:, 1], last[:, 0] + 1j * last[:, 1]


def _extrapolated(correction: Any, step: Any, move: Any, xp: Any) -> Any:
    """Return the accelerated `correction`, given the previous one (`step`) and the `move` made since then."""
    change = correction - step
    share = (change * correction).sum((1, 2, 3)) / ((change**2).sum((1, 2, 3)) + TINY)
    return correction - xp.clip(share, -1.0, 1.0)[:, None, None, None] * (change + move)


def nodes_after(n: int) -> int:
    """Return the node count of a side for the Picard steps after the network: `n`, limited to 33 to 65."""
    return min(max(n, LATENT), FINER)


@lru_cache(maxsize=8)
def _padded(n: int, around: bool) -> tuple[Floats, Floats]:
    """Return the transform and its eigenvalues for `n` nodes, with rows padded for the compiled steps."""
    table, values = _transform(n, around)
    more = -len(values) % LINE
    tables = np.pad(table, ((0, 0), (0, more))), np.pad(values, (0, more), constant_values=1.0)
    return read_only(tables[0]), read_only(tables[1])


def _missed(p: Any, xp: Any, around: bool, share: float, *, linear: bool) -> tuple[Any, Any, Any]:
    """Return the residual of the equations for grids `p` at inner nodes, and their mean coefficients."""
    m, n = p.shape[2:]
    first, second, across, curve = (
        array_like(matrix, p, xp)
        for matrix in (*_differences(m, share, around), *_differences(n, share, False))
    )
    body = p[:, :, 2:-2] if around else p[:, :, 1:-1]
    bends = second @ p[..., 1:-1], body @ curve.T
    if linear:
        unit = 1.0 + 0.0 * p[:, :1, :1, :1]
        return bends[0] + bends[1], unit, unit
    slopes = first @ p
    parts = slopes[..., 1:-1], body @ across.T, bends[0], slopes @ across.T, bends[1]
    missed, alpha, gamma = left_side(parts, lambda a, b: (a * b).sum(1)[:, None])
    total = alpha + gamma + TINY
    return missed / total, *((value / total).mean((2, 3))[:, :, None, None] for value in (alpha, gamma))


@lru_cache(maxsize=16)
def _differences(n: int, share: float, around: bool) -> tuple[Floats, Floats]:
    """Return matrices (., n) of first and second differences inside, a `share` of whose error is corrected.

    `around`: of periodic values, two of which are repeated at either end.
    """
    inner = np.arange(2, n - 2) if around else np.arange(1, n - 1)
    rows, near = np.arange(len(inner))[:, None], np.clip(inner - 2, 0, n - 5)[:, None] + np.arange(5)
    first, second = np.zeros((2, len(inner), n))
    first[rows, near], second[rows, near] = -share / 6.0 * THIRD, -share / 12.0 * FOURTH
    beside = inner[:, None] + np.arange(-1, 2)
    first[rows, beside] += [-0.5, 0.0, 0.5]
    second[rows, beside] += [1.0, -2.0, 1.0]
    return read_only(first), read_only(second)


def _waves(p: Any, axis: int, xp: Any, around: bool) -> tuple[Any, Any]:
    """Return the transform of an axis and negated eigenvalues of second differences, as arrays like `p`."""
    return tuple(array_like(table, p, xp) for table in _transform(p.shape[axis], around))


@lru_cache(maxsize=8)
def _transform(n: int, around: bool) -> tuple[Floats, Floats]:
    """Return the sine or Hartley transform, its own inverse, and negated eigenvalues of differences."""
    if around:
        k = np.arange(n)
        angle = 2.0 * np.pi * (np.outer(k, k) % n) / n
        table = (cos(angle) + sin(angle)) / np.sqrt(n)
        return read_only(table), read_only(4.0 * sin(np.pi * k / n) ** 2)
    k = np.arange(1, n - 1)
    angle = np.pi * (np.outer(k, k) % (2 * (n - 1))) / (n - 1)
    table = np.sqrt(2.0 / (n - 1)) * sin(angle)
    return read_only(table), read_only(4.0 * sin(0.5 * np.pi * k / (n - 1)) ** 2)
