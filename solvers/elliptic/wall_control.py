"""One controlled edge: angle of its lines, height of its first cells, and the sources that change both.

Steger and Sorenson, J. Comput. Phys. 33 (1979) 405-410; feedback of angle and height: Hilgenstock, in
Numerical Grid Generation in Computational Fluid Mechanics (1988) 137-146.
"""

import math
from typing import Self

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.elementary import exp, log
from meshonet.solvers.elliptic.control import Controls, Factors

DECAY = 6.0  # exponent of the decay from an edge to the opposite one
RAMP = 0.03  # fraction of an edge's nodes over which control rises from 0 at a corner to 1
LIMIT = 1.0  # largest logarithm of a step ratio due to a source


class ControlledEdge:
    """An edge (n, 2) at which sources control angles and first-cell heights.

    On line i, the sources at node j from the edge are p(i) e^{-b j} along the edge and q(i) e^{-b j} across
    it, with a constant b. On a uniform grid with steps dx along the edge and dy across it, a Fourier mode of
    p with wave number k rotates lines by (dy/dx) p/(b + k dy). Such a mode of q changes the logarithm of the
    height by q/(b + k dy). Solved for p and q, these relations give the corrections for measured errors.

    `across` is the number of nodes to the opposite edge. `periodic` means a closed edge. `angle` is the angle
    between edge and lines in degrees. `height` is the first-cell height, 0 if not controlled.
    """

    def __init__(
        self, side: str, edge: Floats, across: int, angle: float, height: float, periodic: bool
    ) -> None:
        self.side, self.angle, self.height, self.periodic = side, angle, height, periodic
        curve = Curve(edge, closed=periodic)
        self._tangent = curve.tangent(np.append(curve.knots, 0.0) if periodic else curve.knots)
        self._steps = np.hypot(*np.diff(edge, axis=0).T)
        self._weight = _away_from(curve, len(edge), periodic)
        self.sources = np.zeros((2, len(edge)))
        """p and q, along and across the edge."""
        self._count = across

    def errors(self, nodes: Floats) -> tuple[Floats, Floats]:
        """Return the errors (n,) of the angle (as a sine) and of the logarithm of the first-cell height.

        Near corners and ends of the edge they are reduced to 0, since angles cannot be prescribed there.
        """
        lines = lines_from_side(nodes, self.side)
        lean = leaning(lines, self._tangent) - math.cos(math.radians(self.angle))
        high = log(first_heights(lines) / self.height) if self.height else np.zeros(len(lines))
        return self._weight * lean, self._weight * high

    def correct(self, nodes: Floats, relaxation: float) -> None:
        """Correct the sources by the errors in angle and height at `nodes`, times `relaxation`."""
        lean, high = self.errors(nodes)
        up = first_heights(lines_from_side(nodes, self.side))
        steps = self._steps
        beside = np.concatenate([steps[:1], 0.5 * (steps[:-1] + steps[1:]), steps[-1:]])
        flat = float(np.mean(up) / np.mean(beside))
        decay = DECAY / (self._count - 1)
        for sources, error in zip(self.sources, (lean * beside / up, high), strict=True):
            sources += relaxation * _stiffened(error, decay, flat, self.periodic)
        np.clip(self.sources, -LIMIT, LIMIT, out=self.sources)

    def controls(self) -> Controls:
        """Return the sources as control functions."""
        distance = np.arange(float(self._count))
        fade = exp(-DECAY / (self._count - 1) * distance)
        inwards = 1.0
        if self.side in ("north", "east"):
            fade, inwards = fade[::-1].copy(), -1.0
        along, across = self.sources[:1], inwards * self.sources[1:]
        if self.side in ("south", "north"):
            return Controls(Factors(along, fade[None]), Factors(across, fade[None]))
        return Controls(Factors(fade[None], across), Factors(fade[None], along))

    def resample(self, coarse: Self) -> None:
        """Interpolate the source terms from `coarse`, the same edge on a coarser grid."""
        n, m = self.sources.shape[1], coarse.sources.shape[1]
        place, few = np.linspace(0.0, 1.0, n), np.linspace(0.0, 1.0, m)
        factors = (m - 1) / (n - 1), (coarse._count - 1) / (self._count - 1)
        for k, factor in enumerate(factors):
            self.sources[k] = np.interp(place, few, coarse.sources[k]) * factor


def _away_from(curve: Curve, n: int, periodic: bool) -> Floats:
    """Return weights (n,) that rise from 0 at corners and open ends to 1 some nodes away."""
    index = np.arange(n)
    ends = [] if periodic else [0, n - 1]
    corners = np.unique(np.concatenate([curve.corner_index, np.array(ends, dtype=np.intp)]))
    distance = np.full(n, float(n))
    for corner in corners.tolist():
        apart = np.abs(index - corner)
        distance = np.minimum(distance, np.minimum(apart, n - 1 - apart) if periodic else apart)
    return np.clip(distance / max(3.0, RAMP * n), 0.0, 1.0)


def _stiffened(values: Floats, decay: float, flat: float, periodic: bool) -> Floats:
    """Return values (n,) with each Fourier mode times `decay` + κ, κ its phase per step times `flat`."""
    n = len(values) - 1
    if periodic:
        waves = np.fft.rfft(values[:-1])
        phase = 2.0 * np.pi / n * np.arange(len(waves))
        out = np.fft.irfft(waves * (decay + phase * flat), n)
        return np.append(out, out[0])
    odd = np.concatenate([values, -values[-2:0:-1]])
    waves = np.fft.rfft(odd)
    phase = np.pi / n * np.arange(len(waves))
    return np.asarray(np.fft.irfft(waves * (decay + phase * flat), 2 * n)[: n + 1])


def lines_from_side(nodes: Floats, side: str) -> Floats:
    """Return `nodes` (ni, nj, 2) as a view (n, m, 2): n lines that leave `side`, with m nodes each."""
    lines = nodes if side in ("south", "north") else np.swapaxes(nodes, 0, 1)
    return lines[:, ::-1] if side in ("north", "east") else lines


def first_heights(lines: Floats) -> Floats:
    """Return the lengths (n,) of the first segments of `lines` (n, m, 2)."""
    return np.asarray(np.hypot(*(lines[:, 1] - lines[:, 0]).T))


def leaning(lines: Floats, tangent: Floats) -> Floats:
    """Return the cosine (n,) of the angle between a wall with unit `tangent` (n, 2) and `lines` (n, m, 2).

    The direction of a line at the wall is the tangent of the parabola through its first three nodes.
    """
    a, b, c = lines[:, 0], lines[:, 1], lines[:, 2]
    first, second = np.hypot(*(b - a).T), np.hypot(*(c - b).T)
    out = (b - a) / first[:, None]
    direction = out + (out - (c - b) / second[:, None]) * (first / (first + second))[:, None]
    return np.asarray((direction * tangent).sum(axis=1) / np.hypot(*direction.T))
