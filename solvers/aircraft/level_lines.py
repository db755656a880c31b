"""Lines of a level between columns, or from there to nose and tail, with even cells in space."""

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from meshonet.geometry.arrays import Floats, arc_lengths, smooth_step
from meshonet.geometry.curves.cubic import sampled
from meshonet.solvers.rows.span_spacing import smooth_arcs

_FINE = 65  # number of places on a line at which its length is measured
Points: TypeAlias = Callable[[Floats], Floats]  # function from places (..., 3) to points (..., 3) in space
Side: TypeAlias = tuple[Floats, Floats]
"""Nodes (n, 3) of s, theta, zeta from keel to crown beside a column, and the cell lengths (n,) there in s."""


def lines_between(
    points: Points, begin: Floats, end: Floats, sizes: tuple[Floats, Floats], cells: int
) -> Floats:
    """Return nodes (n, cells + 1, 3) on n lines from `begin` (n, 3) to `end` (n, 3).

    Coordinates are s, theta, zeta: along, around and away from a body. `points` maps them to x, y, z. `sizes`
    are differences of s (n,) across the first and the last cells. Cell lengths in x, y, z change smoothly.
    """
    lines, arcs, ends = _measured(points, begin, end, sizes)
    nodes = sampled(lines, arcs, smooth_arcs(arcs[:, -1], ends, cells))
    nodes[:, 0], nodes[:, -1] = begin, end
    return nodes


def ways_between(
    points: Points, begin: Floats, end: Floats, sizes: tuple[Floats, Floats]
) -> tuple[Floats, tuple[Floats, Floats]]:
    """Return lengths (n,) in space of the lines of `lines_between`, and of their first and last cells."""
    _, arcs, ends = _measured(points, begin, end, sizes)
    return arcs[:, -1], ends


def _measured(
    points: Points, begin: Floats, end: Floats, sizes: tuple[Floats, Floats]
) -> tuple[Floats, Floats, tuple[Floats, Floats]]:
    """Return places (n, m, 3) and arc lengths (n, m) on lines, and end cells (n,) in space."""
    lines = _lines(begin, end)
    s, arcs = lines[..., 0], arc_lengths(points(lines))
    first, last = ((arcs[:, k + 1] - arcs[:, k]) / (s[:, k + 1] - s[:, k]) for k in (0, -2))
    return lines, arcs, (first * sizes[0], last * sizes[1])


def _lines(begin: Floats, end: Floats) -> Floats:
    """Return places (n, m, 3) at even s on lines between places (n, 3); theta and zeta change smoothly."""
    along = begin[:, :1] + (end - begin)[:, :1] * np.linspace(0.0, 1.0, _FINE)
    first, last = float(along[:, 0].max()), float(along[:, -1].min())
    t = np.clip((along - first) / (last - first), 0.0, 1.0)[..., None]
    across = begin[:, None, 1:] + (end - begin)[:, None, 1:] * smooth_step(t)
    return np.concatenate([along[..., None], across], axis=-1)
