"""Node distributions along the edges of a volume, as parameters from 0 to 1 for the interpolation.

The laws of one direction are (4, n): those of its edges at the (low, low), (high, low), (low, high) and
(high, high) ends of the other two directions.
"""

from typing import TypeAlias

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.blocks.six_faces import SixFaces, place_of
from meshonet.geometry.errors import InputError

Laws: TypeAlias = tuple[Floats, Floats, Floats]
"""Laws of xi, eta and zeta."""

SAME = 1e-9
"""Largest difference of laws that count as equal."""


def uniform_laws(counts: tuple[int, int, int]) -> Laws:
    """Return equal steps along each direction with `counts` nodes."""
    xi, eta, zeta = (np.tile(np.linspace(0.0, 1.0, n), (4, 1)) for n in counts)
    return xi, eta, zeta


def arc_laws(faces: SixFaces) -> Laws:
    """Return the relative arc lengths of the edges. Raises InputError: an edge without length."""
    xi, eta, zeta = (_arcs(faces.edges_along(axis)) for axis in range(3))
    return xi, eta, zeta


def mean_laws(laws: Laws) -> Laws:
    """Return for each direction the mean of its four laws, repeated four times."""
    xi, eta, zeta = (np.tile(law.mean(axis=0), (4, 1)) for law in laws)
    return xi, eta, zeta


def _arcs(edges: list[Floats]) -> Floats:
    steps = np.stack([norms(np.diff(edge, axis=0)) for edge in edges])
    arcs = np.concatenate([np.zeros((4, 1)), np.cumsum(steps, axis=1)], axis=1)
    short = np.flatnonzero(~(steps > 0).all(axis=1))
    if len(short):
        edge, at = int(short[0]), int(np.argmin(steps[short[0]]))
        problem = f"nodes {at} and {at + 1} of an edge are the same"
        raise InputError(problem, "volumes need edges of some length", place=place_of(edges[edge][at]))
    laws = arcs / arcs[:, -1:]
    laws[:, -1] = 1.0
    mean = laws.mean(axis=0)
    return np.tile(mean, (4, 1)) if np.abs(laws - mean).max() <= SAME else laws
