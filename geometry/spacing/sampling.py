"""Where nodes go along a curve: the settings a user can give, and the spacing laws."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

import numpy as np

from meshonet.geometry.arrays import TOPOLOGIES, Floats, Topology
from meshonet.geometry.errors import InputError

Spacing: TypeAlias = Literal["auto", "conformal", "uniform", "cosine", "tanh", "curvature"]
SPACINGS: tuple[Spacing, ...] = get_args(Spacing)

TrailingEdge: TypeAlias = Literal["auto", "exact", "round", "wedge"]
TRAILING_EDGES: tuple[TrailingEdge, ...] = get_args(TrailingEdge)

DEFAULT_NI = 200
DEFAULT_NJ = 100
DEFAULT_FAR_FIELD = 15.0
MOST_NODES = 100_000


@dataclass(frozen=True)
class Sampling:
    """How a shape becomes edges of nodes; validates itself.

    Parameters
    ----------
    ni, nj : nodes along xi (around the body) and eta (away from it); None means what the shape has,
        and for a curve `DEFAULT_NI` and `DEFAULT_NJ`.
    topology : ``auto`` lets the shape choose.
    spacing : law of the nodes along a wall. ``auto`` is ``conformal`` around airfoils and smooth bodies
        (``tanh`` where a cell is asked for), and ``uniform`` elsewhere.
    le_spacing, te_spacing : wall cell at the leading and at the trailing edge, in chords.
    far_field : radius of the outer boundary, in chords or, around other bodies, in their largest extent;
        None is `DEFAULT_FAR_FIELD`, and all that shapes without one take.
    corners : the points, counted from 0, that become the corners of a quad domain.
    te : blunt trailing edges of airfoils as they are (``exact``), with their corners rounded (``round``) or
        closed by a wedge behind them (``wedge``); ``auto`` is ``wedge`` for a C boundary, which needs a sharp
        edge, and ``exact`` otherwise.
    wake : length of a C boundary's wake in chords; None is as long as the far field is away.
    wake_nodes : nodes of it, the trailing edge included; None leaves the number to `meshonet.geometry.shapes.wake`.
    viscous : the cells at the wall will be thin: ``auto`` topology is then C around sharp edges.
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
    far_field: float | None = None
    corners: tuple[int, int, int, int] | None = None
    normalise: bool = False
    te: TrailingEdge = "auto"
    wake: float | None = None
    wake_nodes: int | None = None
    viscous: bool = False

    def __post_init__(self) -> None:
        for name, count in (("ni", self.ni), ("nj", self.nj)):
            if count is not None and not 2 <= count <= MOST_NODES:
                raise InputError(f"{name} is {count} nodes", f"use 2 to {MOST_NODES}")
        if self.topology != "auto" and self.topology not in TOPOLOGIES:
            raise InputError(f"topology {self.topology!r} is not known", "use auto/" + "/".join(TOPOLOGIES))
        if self.spacing not in SPACINGS:
            raise InputError(f"spacing {self.spacing!r} is not known", "use " + "/".join(SPACINGS))
        for name, size in (("le_spacing", self.le_spacing), ("te_spacing", self.te_spacing)):
            if size is not None and not 1e-9 <= size <= 0.2:
                raise InputError(f"{name} is {size:g} chords", "use 1e-9 to 0.2")
        if not 1.0 < self.radius <= 1e6:
            raise InputError(f"the far field is at {self.radius:g} chords", "use more than 1 and at most 1e6")
        if self.wake is not None and not 0.5 <= self.wake <= 1e6:
            raise InputError(f"the wake is {self.wake:g} chords long", "use 0.5 to 1e6")
        if self.wake_nodes is not None and not 3 <= self.wake_nodes <= MOST_NODES:
            raise InputError(f"the wake has {self.wake_nodes} nodes", f"use 3 to {MOST_NODES}")
        if self.te not in TRAILING_EDGES:
            raise InputError(f"trailing edge {self.te!r} is not known", "use " + "/".join(TRAILING_EDGES))
        if self.corners is not None and len(set(self.corners)) != 4:
            raise InputError(
                f"corners {self.corners} are not four different points", "give four point indices"
            )

    @property
    def radius(self) -> float:
        """Radius of the far field in chords."""
        return DEFAULT_FAR_FIELD if self.far_field is None else self.far_field


def spacing_uniform(n: int) -> Floats:
    """Return n values from 0 to 1 in equal steps.

    Examples
    --------
    >>> spacing_uniform(3).tolist()
    [0.0, 0.5, 1.0]
    """
    return np.linspace(0.0, 1.0, n)


def spacing_cosine(n: int) -> Floats:
    """Return n values (1 - cos(pi q)) / 2 from 0 to 1, close together at both ends.

    Examples
    --------
    >>> spacing_cosine(3).round(12).tolist()
    [0.0, 0.5, 1.0]
    """
    return np.asarray(np.sin(0.5 * np.pi * np.linspace(0.0, 1.0, n)) ** 2)


def spacing_tanh(n: int, first: float, last: float) -> Floats:
    """Return n values from 0 to 1 whose first step is `first` and whose last is `last` (`TanhLaw`).

    Examples
    --------
    >>> steps = np.diff(spacing_tanh(21, 0.01, 0.02))
    >>> [float(round(step, 6)) for step in (steps[0], steps[-1])]
    [0.01, 0.02]
    """
    return TanhLaw.fitted(n - 1, first, last)(np.linspace(0.0, 1.0, n))


@dataclass(frozen=True)
class TanhLaw:
    """Vinokur's two-sided stretching s(q), both 0 to 1, from its slopes ds/dq at the two ends.

    u = 1/2 + tanh(d (q - 1/2)) / (2 tanh(d/2)),  s = u / (a + (1 - a) u),
    a = sqrt(end/start),  sinh(d)/d = 1/sqrt(start end); tan and sin where that is below 1.
    Vinokur, J. Comput. Phys. 50 (1983) 215-234.
    """

    start: float
    end: float

    @property
    def stretch(self) -> float:
        """The d above, positive where tanh holds, negative where tan does, 0 for equal steps."""
        b = 1.0 / math.sqrt(self.start * self.end)
        if abs(b - 1.0) < 1e-9:
            return 0.0
        return _inverse_sinhc(b) if b > 1.0 else -_inverse_sinc(b)

    def __call__(self, q: Floats) -> Floats:
        """Return s at q (any shape)."""
        a, d = math.sqrt(self.end / self.start), self.stretch
        u = np.asarray(q, dtype=np.float64)
        if d > 0:
            u = 0.5 + 0.5 * np.tanh(d * (u - 0.5)) / math.tanh(0.5 * d)
        elif d < 0:
            u = 0.5 + 0.5 * np.tan(d * (u - 0.5)) / math.tan(0.5 * d)
        s = u / (a + (1.0 - a) * u)
        return np.asarray(np.where(np.asarray(q) >= 1.0, 1.0, np.where(np.asarray(q) <= 0.0, 0.0, s)))

    def _end_steps(self, one: float, other: float) -> tuple[float, float]:
        """Return s at `one` and 1 - s at 1 - `other`, both small, without loss of digits."""
        a, d = math.sqrt(self.end / self.start), self.stretch
        low, high = (_small_u(d, q) for q in (one, other))
        return low / (a + (1.0 - a) * low), a * high / (1.0 - (1.0 - a) * high)

    @classmethod
    def fitted(cls, cells: float, first: float, last: float, last_part: float = 1.0) -> TanhLaw:
        """Return the law whose first step of `cells` is `first` and whose last is `last`, to 1e-6 of them.

        Parameters
        ----------
        cells : steps from 0 to 1; need not be whole when the last one goes on beyond 1.
        first, last : parts of the whole.
        last_part : how much of the last step lies before 1 (1 or 0.5).

        Raises
        ------
        InputError
            the steps do not fit: they are too large together, or too few nodes lie between them.
        """
        start, end = first * cells, last * cells
        for _ in range(60):
            law = cls(start, end)
            one, other = law._end_steps(1.0 / cells, last_part / cells)
            rise, fall = first / one, last * last_part / other
            if max(abs(rise - 1.0), abs(fall - 1.0)) < 1e-6:
                return law
            start, end = start * min(max(rise, 0.25), 4.0), end * min(max(fall, 0.25), 4.0)
        raise InputError(
            f"steps of {first:.3g} and {last:.3g} of the length do not join over {cells:g} cells",
            "change the spacing or the number of nodes",
        )


def _small_u(d: float, q: float) -> float:
    """Return Vinokur's u at q, for q near 0: 1/2 - tanh(d/2 - d q) / (2 tanh(d/2)) without the difference."""
    if d == 0:
        return q
    if d > 0:
        return 0.5 * math.sinh(d * q) / (math.sinh(0.5 * d) * math.cosh(d * (0.5 - q)))
    return 0.5 * math.sin(-d * q) / (math.sin(-0.5 * d) * math.cos(d * (0.5 - q)))


def _inverse_sinhc(b: float) -> float:
    """Return d with sinh(d)/d = b > 1, by Newton's method on the logarithm."""
    d = math.sqrt(6.0 * (b - 1.0)) if b < 3.0 else math.log(2.0 * b) + math.log(math.log(2.0 * b))
    for _ in range(40):
        d = min(d, 700.0)
        step = (math.log(math.sinh(d) / d) - math.log(b)) / (1.0 / math.tanh(d) - 1.0 / d)
        d -= step
        if abs(step) < 1e-13 * d:
            break
    return d


def _inverse_sinc(b: float) -> float:
    """Return d below pi with sin(d)/d = b < 1, by Newton's method on sin(d) - b d."""
    d = math.pi * (1.0 - b) if b < 0.27 else math.sqrt(6.0 * (1.0 - b))
    for _ in range(40):
        step = (math.sin(d) - b * d) / (math.cos(d) - b)
        d = min(max(d - step, 0.5 * d), 0.5 * (d + math.pi))
        if abs(step) < 1e-14 * d:
            break
    return d


def monotone_cubic(x: Floats, y: Floats, at: Floats) -> Floats:
    """Return the monotone cubic through (x, y), both (n,) and increasing, at `at` (m,) within them.

    The slope at a point is a weighted harmonic mean of those of its two intervals, so that no interval
    overshoots: Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300-304.

    Examples
    --------
    >>> monotone_cubic(np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0, 2.0]), np.array([0.5, 2.0])).tolist()
    [0.5, 2.0]
    """
    h, delta = np.diff(x), np.diff(y) / np.diff(x)
    slope = np.full(len(x), delta[0])
    if len(x) > 2:
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
