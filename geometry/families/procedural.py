"""Random airfoils with random wall spacing, to train and test operators: NACA, CST and Karman-Trefftz.

Kulfan, J. Aircraft 45 (2008) 142 (CST); Milne-Thomson, Theoretical Aerodynamics (1966) 7.32 (Karman-Trefftz).
"""

import cmath
import math
from dataclasses import replace
from typing import Any

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.elementary import angle, arctan, cos, exp, modulus, power, product, sin
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.airfoil.naca import thickness
from meshonet.geometry.shapes.far_field import straight
from meshonet.geometry.spacing.laws import Spacing
from meshonet.geometry.spacing.sampling import Sampling

POINTS = 120  # points per surface
ORDER = 6  # order of the Bernstein polynomials


def boundary(rng: np.random.Generator, ni: int, nj: int, spacing: Spacing | None = None) -> Boundary:
    """Return the O boundary of a random airfoil, with a random far field at 4 to 60 chords.

    `spacing` is the distribution of nodes on the wall; None: a random one.
    """
    while True:
        settings: dict[str, Any] = {"spacing": spacing} if spacing else {}
        far_field = math.exp(rng.uniform(math.log(4.0), math.log(60.0)))
        try:
            airfoil = Airfoil(_section(rng), "procedural")
            if airfoil.crossing:
                continue
            settings = settings or _spacing(rng)
            edges = airfoil.boundary(Sampling(ni, nj, "o", far_field=far_field, **settings))
        except InputError:
            continue  # the section crosses itself, or the cells do not fit it: draw another
        return _turned(edges, float(rng.normal(0.0, 0.08))) if rng.random() < 0.5 else edges


def _turned(edges: Boundary, around: float) -> Boundary:
    """Return the boundary with its far field rotated by `around` (radians), which shears the grid."""
    middle = 0.5 * (edges.north.min(axis=0) + edges.north.max(axis=0))
    c, s = math.cos(around), math.sin(around)
    north = middle + product(edges.north - middle, [[c, s], [-s, c]])
    north[-1] = north[0]
    cut = straight(edges.south[0], north[0], edges.nj)
    return replace(edges, north=north, west=cut, east=cut)


def _spacing(rng: np.random.Generator) -> dict[str, Any]:
    """Return random settings of `Sampling`: a spacing, and cell sizes at both edges."""
    draw = rng.random()
    for share, law in ((0.3, "conformal"), (0.45, "cosine"), (0.52, "uniform"), (0.6, "curvature")):
        if draw < share:
            return {"spacing": law}
    steps: dict[str, Any] = {"spacing": "tanh"}
    for name in ("le_spacing", "te_spacing"):
        if rng.random() < 0.8:
            steps[name] = math.exp(rng.uniform(math.log(5e-4), math.log(1.5e-2)))
    return steps


def _section(rng: np.random.Generator) -> Floats:
    """Return points (n, 2) from the trailing edge over the upper side and back, sometimes noisy or sparse."""
    for _ in range(100):
        draw = rng.random()
        points = _naca(rng) if draw < 0.25 else _cst(rng) if draw < 0.8 else _karman_trefftz(rng)
        points = _normalised(points)
        if rng.random() < 0.4:
            points = _as_found(rng, points)
        if _thickness(points).min() > 0.0025:
            return points
    return _naca(rng)


def _naca(rng: np.random.Generator) -> Floats:
    t, p = rng.uniform(0.04, 0.26), rng.uniform(0.2, 0.6)
    m = 0.0 if rng.random() < 0.3 else rng.uniform(0.0, 0.08)
    x = _cosine()
    half = thickness(x, t, sharp=bool(rng.choice([False, True])))
    front = x < p
    camber = m * np.where(front, (2 * p * x - x * x) / p**2, (1 - 2 * p + 2 * p * x - x * x) / (1 - p) ** 2)
    slope = arctan(2 * m * (p - x) / np.where(front, p**2, (1 - p) ** 2))
    return _joined(
        x - half * sin(slope), camber + half * cos(slope), x + half * sin(slope), camber - half * cos(slope)
    )


def _cst(rng: np.random.Generator) -> Floats:
    x, t = _cosine(), rng.uniform(0.04, 0.28)
    bend = rng.normal(0, 0.35) if rng.random() < 0.85 else rng.normal(0, 0.9)
    thick = np.clip(t * (1.3 + rng.normal(0, 0.35, ORDER + 1)), 0.25 * t, 4 * t)
    thick[0] = np.clip(t * rng.uniform(0.7, 1.9), 0.03, 0.6)
    thick[-1] *= rng.uniform(0.1, 1.2)
    camber = (
        0.1 * bend + rng.normal(0, 0.05, ORDER + 1) + 0.1 * np.linspace(-1, 1, ORDER + 1) * rng.normal(0, 0.6)
    )
    camber[0] *= 0.3
    gap = 0.5 * rng.choice([0.0, 0.0, rng.uniform(0, 0.004), rng.uniform(0, 0.02), rng.uniform(0.0, 0.08)])
    bernstein = np.array(
        [math.comb(ORDER, i) * power(x, i) * power(1 - x, ORDER - i) for i in range(ORDER + 1)]
    )
    shape = np.sqrt(x) * (1 - x)
    half, middle = shape * product(thick, bernstein) + x * gap, shape * product(camber, bernstein)
    return _joined(x, middle + half, x, middle - half)


def _karman_trefftz(rng: np.random.Generator) -> Floats:
    k = 2.0 - np.radians(rng.uniform(0, 20)) / np.pi
    centre = -rng.uniform(0.03, 0.22) + 1j * rng.uniform(-0.02, 0.2)
    start = cmath.phase(1 - centre)
    z = centre + abs(1 - centre) * exp(1j * (start + np.linspace(0, 2 * np.pi, 2 * POINTS)))[1:-1]
    ratio = (z - 1) / (z + 1)
    around = np.unwrap(angle(ratio))
    around -= 2 * np.pi * np.round((around[len(around) // 2] - np.pi) / (2 * np.pi))
    raised = power(modulus(ratio), k) * exp(1j * k * around)
    w = np.concatenate([[k], k * (1 + raised) / (1 - raised), [k]])
    return np.stack([w.real, w.imag], axis=1)


def _as_found(rng: np.random.Generator, points: Floats) -> Floats:
    """Return fewer points, with noise of the magnitude that digitised sections have."""
    n, keep = len(points), int(rng.integers(25, 90))
    q = np.linspace(0, 1, keep)
    even, ends = q * (n - 1), sin(np.pi * q) ** 2 * 0.5 * (n - 1)
    k = np.round(0.6 * even + 0.4 * np.where(q < 0.5, ends, n - 1 - ends)).astype(int)
    k = np.unique(np.r_[0, k, np.argmin(points[:, 0]), n - 1])
    sampled = points[k].copy()
    inner = np.clip(4 * sampled[:, 0] * (1 - sampled[:, 0]), 0, 1)
    sampled[:, 1] += math.pow(10.0, rng.uniform(-5.5, -4.2)) * rng.normal(size=len(sampled)) * inner
    return sampled


def _cosine() -> Floats:
    return np.asarray(0.5 * (1 - cos(np.linspace(0, np.pi, POINTS))))


def _joined(xu: Floats, yu: Floats, xl: Floats, yl: Floats) -> Floats:
    return np.concatenate([np.stack([xu, yu], axis=1)[::-1], np.stack([xl, yl], axis=1)[1:]])


def _normalised(points: Floats) -> Floats:
    z = points[:, 0] + 1j * points[:, 1]
    tail = 0.5 * (z[0] + z[-1])
    nose = z[np.argmax(modulus(z - tail))]
    z = (z - nose) / (tail - nose)
    return np.stack([z.real, z.imag], axis=1)


def _thickness(points: Floats) -> Floats:
    k, x = int(np.argmin(points[:, 0])), np.linspace(0.02, 0.97, 60)
    upper, lower = points[: k + 1][::-1], points[k:]
    return np.asarray(np.interp(x, upper[:, 0], upper[:, 1]) - np.interp(x, lower[:, 0], lower[:, 1]))
