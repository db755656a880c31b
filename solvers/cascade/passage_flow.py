r"""Flow through a cascade without circulation: its potential maps the blades to plates without stagger.

With ζ = π z / (p n), where n is the axial direction and p the pitch, the complex potential is

    G = ζ + ∫ γ(s) log sinh(ζ - s) ds,   Im G = const along the blade,   ∫ γ ds = 0.

The blade becomes a slit from -h to h that repeats every iπ. The region between the slits is mapped to the
strip |Im σ| < π / 2 by

    σ = log(sinh(G + h) / sinh(G - h)) / 2,   inlet and outlet at -h and h.

The vortex sheet γ is computed with panels. Martensen, Arch. Rat. Mech. Anal. 3 (1959) 235-270.
"""

from dataclasses import dataclass
from functools import partial
from typing import Self

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats, Indices
from meshonet.geometry.cached import cached_property
from meshonet.geometry.elementary import arccos, arctan2, log, modulus, product, sinh, tanh, times
from meshonet.geometry.linear import solve
from meshonet.geometry.threads import in_threads, run_in_threads, thread_count

_GAUSS = (-(3.0**-0.5), 3.0**-0.5)  # places in a side from -1 to 1, of weight 1
_TINY = 1e-12  # in place of a distance of 0, where the integrand is 0 in the limit
_LONGEST = 0.25  # step of the potential, of period π, between the points of Cauchy's integral
_LEAST = 1e-9  # of the slit: by how much the potential rises from point to point


@dataclass(frozen=True, eq=False)
class PassageFlow:
    """Potential flow past a cascade. Its potential G maps each blade to a slit.

    Parameters
    ----------
    half : half the length of the slit, h.
    around : (n,) increasing angles ν of points on the blade; the potential is G = h cos ν.
    strip : (n,) images σ of the points, if the region between blades is mapped to the strip |Im σ| <= π/2.
        Two images are infinite: those of the points at the ends of the slit, where G is -h or h.
    away : (n,) ζ - G at the points: their complex coordinates (see `Passage.zeta`) minus the potential.
    """

    half: float
    around: Floats
    strip: Complexes
    away: Complexes

    @classmethod
    def of(cls, points: Complexes) -> Self:
        """Return the flow past a cascade of clockwise polygons; `points` are complex ζ (`Passage.zeta`)."""
        sheet = _sheet(points)
        gain = 2.0 * np.pi * sheet * modulus(np.roll(points, -1) - points)
        parts = int(np.ceil(np.abs(gain).max() / _LONGEST))
        steps = (np.roll(points, -1) - points)[:, None] * (np.arange(parts) / parts)
        points, gain = (points[:, None] + steps).ravel(), np.repeat(gain / parts, parts)
        potential = np.concatenate([[0.0], np.cumsum(gain)[:-1]])
        first, last = int(np.argmin(potential)), int(np.argmax(potential))
        half = 0.5 * float(potential[last] - potential[first])
        phi = potential - potential[first] - half
        angle = np.empty(len(points))
        for start, stop, way in ((first, last, 1.0), (last, first, -1.0)):  # the sides above and below
            side = _range(start, stop, len(points))
            rising = np.maximum.accumulate(way * phi[side]) + _LEAST * half * np.arange(len(side))
            rising = np.interp(rising, rising[[0, -1]], [-half, half])
            phi[side] = way * rising
            angle[side] = way * arccos(np.clip(way * rising / half, -1.0, 1.0))
        with np.errstate(divide="ignore"):
            along = 0.5 * log(sinh(half + phi) / sinh(half - phi))
        angle[[first, last]] = np.pi, 0.0
        edge = np.where(angle > 0.0, -0.5j, 0.5j) * np.pi
        return cls(half, np.unwrap(angle), along + edge, points - phi)

    def to_places(self, potential: Complexes) -> Complexes:
        """Return coordinates ζ (n,) (see `Passage.zeta`) of points with a complex `potential` (n,)."""
        ratio = sinh(potential + self.half) / sinh(potential - self.half)
        return potential + self.inside(np.asarray(0.5 * log(ratio)))

    @cached_property
    def far(self) -> tuple[float, float]:
        """Real part of ζ - G far upstream and downstream: coordinate ζ (`Passage.zeta`), potential G."""
        before, behind = self.inside(self.half * np.array([-1.0, 1.0], dtype=np.complex128))
        return float(before.real), float(behind.real)

    def inside(self, places: Complexes) -> Complexes:
        """Return ζ (see `Passage.zeta`) minus the flow's complex potential, at m points between the blades.

        `places` (m,) are images of the points in the strip |Im σ| < π/2. The result follows from the values
        on the blade by Cauchy's integral, computed as the quotient of two trapezoidal sums in tanh(σ/2)
        (Helsing, Ojala, J. Comput. Phys. 227 (2008) 2899-2921).
        """
        finite = np.isfinite(self.strip)
        circle = tanh(0.5 * self.strip[finite])
        weight = np.roll(circle, -1) - np.roll(circle, 1)
        terms = np.stack([self.away[finite], np.ones(len(circle))], axis=1)

        def integrals(some: Complexes) -> Complexes:
            sums = product(weight / (circle - tanh(0.5 * some)[:, None]), terms)
            return np.asarray(sums[:, 0] / sums[:, 1])

        return np.concatenate(in_threads(integrals, np.array_split(places, thread_count())))


def _range(start: int, stop: int, count: int) -> Indices:
    return np.arange(start, stop + (count if stop < start else 0) + 1) % count


def _sheet(points: Complexes) -> Floats:
    """Return the strength (n,) of the vortex sheet along each side of a polygon (n,)."""
    n = len(points)
    step = np.roll(points, -1) - points
    length = modulus(step)
    middle = points + 0.5 * step

    def rest(place: float) -> Floats:
        away = middle[:, None] - (middle + 0.5 * place * step)
        away[away == 0.0] = _TINY
        return np.asarray(0.5 * length * log(modulus(sinh(away) / away)))

    near = partial(_log_integrals, points, step, middle)
    kernel = np.zeros((n + 1, n + 1))
    for part in run_in_threads([near, *(partial(rest, place) for place in _GAUSS)]):
        kernel[:n, :n] += part
    kernel[:n, n] = -1.0
    kernel[n, :n] = length
    return solve(kernel, np.append(-middle.imag, 0.0))[:n]


def _log_integrals(points: Complexes, step: Complexes, middle: Complexes) -> Floats:
    """Return the integrals (n, n) of log |middle - s| along the sides of a polygon."""
    local = times(middle[:, None] - points, np.conj(step / modulus(step)))
    high = np.abs(local.imag)

    def primitive(x: Floats) -> Floats:
        distance = np.maximum(np.hypot(x, high), 1e-300)
        return np.asarray(x * log(distance) - x + high * arctan2(x, high))

    return primitive(local.real) - primitive(local.real - modulus(step))
