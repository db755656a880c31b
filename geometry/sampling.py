"""Where nodes go along a curve: spacing laws, and the settings a user can give."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

import numpy as np

from geometry.arrays import TOPOLOGIES, Floats, Topology
from geometry.errors import InputError

Spacing: TypeAlias = Literal["auto", "uniform", "cosine", "tanh", "curvature"]
SPACINGS: tuple[Spacing, ...] = get_args(Spacing)

DEFAULT_NI = 200
DEFAULT_NJ = 100


@dataclass(frozen=True)
class Sampling:
    """How a shape becomes edges of nodes; validates itself.

    Parameters
    ----------
    ni, nj : nodes along xi (around the body) and eta (away from it); None means what the shape has,
        or 200 and 100 when it is a curve.
    topology : ``auto`` lets the shape choose.
    spacing : law of the nodes along a wall.
    le_spacing, te_spacing : wall cell at the leading and at the trailing edge, in chords.
    far_field : radius of the outer boundary in chords (bodies: in their largest extent).
    corners : the four points, counted from 0, that become corners of a quad domain, south-west first.
    normalise : put the leading edge at (0, 0) and the trailing edge at (1, 0).

    Raises
    ------
    InputError
        a value out of its range.
    """

    ni: int | None = None
    nj: int | None = None
    topology: Topology | Literal["auto"] = "auto"
    spacing: Spacing = "auto"
    le_spacing: float | None = None
    te_spacing: float | None = None
    far_field: float = 15.0
    corners: tuple[int, int, int, int] | None = None
    normalise: bool = False

    def __post_init__(self) -> None:
        for name, count in (("ni", self.ni), ("nj", self.nj)):
            if count is not None and not 2 <= count <= 100_000:
                raise InputError(f"{name} = {count} nodes", "use 2 to 100000")
        if self.topology != "auto" and self.topology not in TOPOLOGIES:
            raise InputError(f"topology {self.topology!r} is not known", "use auto/" + "/".join(TOPOLOGIES))
        if self.spacing not in SPACINGS:
            raise InputError(f"spacing {self.spacing!r} is not known", "use " + "/".join(SPACINGS))
        for name, size in (("le_spacing", self.le_spacing), ("te_spacing", self.te_spacing)):
            if size is not None and not 0 < size < 0.5:
                raise InputError(f"{name} = {size:g} chords", "use more than 0 and less than 0.5")
        if not (np.isfinite(self.far_field) and self.far_field > 1.0):
            raise InputError(f"far field at {self.far_field:g} chords", "use more than 1")


def spacing_uniform(n: int) -> Floats:
    """Return n values from 0 to 1 in equal steps."""
    return np.linspace(0.0, 1.0, n)


def spacing_cosine(n: int) -> Floats:
    """Return n values (1 - cos(pi q)) / 2 from 0 to 1, close together at both ends."""
    return np.asarray(np.sin(0.5 * np.pi * np.linspace(0.0, 1.0, n)) ** 2)


def monotone_cubic(x: Floats, y: Floats, at: Floats) -> Floats:
    """Return the monotone cubic through (x, y), both increasing (n,), at `at` (m,) within them.

    Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300-304: the slope at a point is a weighted
    harmonic mean of those of its two intervals, so that no interval overshoots.
    """
    h, delta = np.diff(x), np.diff(y) / np.diff(x)
    slope = np.empty(len(x))
    if len(x) == 2:
        slope[:] = delta[0]
    else:
        w1, w2 = 2 * h[1:] + h[:-1], h[1:] + 2 * h[:-1]
        slope[1:-1] = (w1 + w2) / (w1 / delta[:-1] + w2 / delta[1:])
        for end, a, b in ((0, 0, 1), (-1, -1, -2)):
            value = ((2 * h[a] + h[b]) * delta[a] - h[a] * delta[b]) / (h[a] + h[b])
            slope[end] = min(max(value, 0.0), 3 * delta[a])
    i = np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(h) - 1)
    t = (at - x[i]) / h[i]
    rise = np.diff(y)[i]
    a, b = h[i] * slope[i], h[i] * slope[i + 1]
    out = y[i] + t * (a + t * ((3 * rise - 2 * a - b) + t * (a + b - 2 * rise)))
    return np.asarray(np.where(at >= x[-1], y[-1], out))
