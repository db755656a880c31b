"""Nodes along curves in the complex plane."""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats


def arc_lengths(z: Complexes) -> Floats:
    """Return the arc length (n,) at each point of a polygon (n,), from 0."""
    return np.concatenate([[0.0], np.cumsum(np.abs(np.diff(z)))])


def at_lengths(z: Complexes, length: Floats, at: Floats) -> Complexes:
    """Return points (m,) of a polygon (n,), whose points lie at `length`, at arc lengths `at` (m,)."""
    return np.interp(at, length, z.real) + 1j * np.interp(at, length, z.imag)


def as_nodes(z: Complexes) -> Floats:
    """Return (n, 2) nodes for complex ones (n,)."""
    return np.stack([z.real, z.imag], axis=-1)
