"""O grids as strips Z = i log(z - centre) of period 2 pi, by `xp`, numpy or torch."""

from collections.abc import Callable
from typing import Any

import numpy as np

from meshonet.geometry.elementary import functions_of, modulus, times

AROUND = 65  # nodes along xi, the last one period after the first, of the network's input around a body

TURN = 2.0 * np.pi  # once around, the period of a strip


def middles(walls: Any, xp: Any = np) -> Any:
    """Return the centroids (batch,) of the areas inside closed curves (batch, n) of complex nodes."""
    off = walls - walls[:, :1]  # near the origin, against cancellation
    ahead = xp.roll(off, -1, 1)
    cross = times(off.conj(), ahead).imag
    return walls[:, 0] + (cross * (off + ahead)).sum(1) / (3.0 * cross.sum(1))


def unrolled(z: Any, centres: Any, xp: Any = np) -> tuple[Any, Any]:
    """Return complex O grids `z` (batch, m + 1, n) mapped by i log(z - centre), and a mask (batch,).

    ``z[b, i]`` is a line from the body outwards, and ``z[b, m]`` repeats ``z[b, 0]``. The mask is true for
    grids that wind once around their centre; other results are useless.
    """
    off = z - centres[:, None, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        angle_of = functions_of(xp).angle
        cut = angle_of(off[:, :1, 1:] / off[:, :1, :-1])
        first = xp.cumsum(xp.concatenate([angle_of(off[:, :1, :1]), cut], 2), 2)
        steps = angle_of(off[:, 1:] / off[:, :-1])
        angle = xp.cumsum(xp.concatenate([first, steps], 1), 1)
        strip = -angle + 1j * functions_of(xp).log(modulus(off))
    closed = abs(angle[:, -1] - angle[:, 0] + TURN) < 1e-6
    once = closed.all(1) & xp.isfinite(strip).all(2).all(1)
    return xp.concatenate([strip[:, :-1], strip[:, :1] + TURN], 1), once


def around_middles(wall: Any, walls: Any, inside: Callable[[Any], Any], xp: Any = np) -> tuple[Any, Any, Any]:
    """Return closed lines mapped by i log(z - centre), the centres (batch,), and a mask (batch,).

    `walls` (batch, m + 1, n) are n closed lines around a body, of m + 1 complex nodes whose last repeats the
    first. The centre is the centroid of the body's outline `wall` (batch, ni) if all lines wind exactly once
    around it, else the result of `inside` for the nodes of the first line. The mask is false, and the mapped
    lines are useless, if a line does not wind exactly once around the centre.
    """
    centres = middles(wall[:, :-1], xp)
    strips, once = unrolled(walls, centres, xp)
    if not once.all():
        bodies = zip(centres, once, walls[:, :-1, 0], strict=True)
        centres = xp.stack([centre if fits else inside(body) for centre, fits, body in bodies])
        strips, once = unrolled(walls, centres, xp)
    return strips, centres, once


def even(strips: Any, n: int, xp: Any = np) -> Any:
    """Return `n` equally spaced nodes between the ends of each line ``strips[b, i]``: (batch, lines, n)."""
    eta = xp.linspace(0.0, 1.0, n, dtype=strips.real.dtype, device=strips.device)
    return strips[:, :, :1] * (1.0 - eta) + strips[:, :, -1:] * eta


def factors(strips: Any, xp: Any = np) -> Any:
    """Return scale factors (batch,) to area 2 for complex grids (batch, m + 1, n) that are 2 pi wide in x."""
    heights = (strips[:, :-1, -1] - strips[:, :-1, 0]).imag.mean(1)
    return 1.0 / xp.sqrt(0.5 * TURN * heights)


def rolled(strips: Any, centres: Any = 0.0, xp: Any = np) -> Any:
    """Return O grids ``exp(-1j * strips) + centres`` (batch, m + 1, n), with `centres` (batch, 1, 1)."""
    return functions_of(xp).exp(times(-1j, strips)) + centres
