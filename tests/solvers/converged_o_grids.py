"""O grids of the compiled conformal solver at the limit of its Picard steps, by Newton's method."""

from collections.abc import Callable

import numpy as np
from scipy.sparse.linalg import LinearOperator, gmres

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.solvers.conformal.solve import solve
from meshonet.solvers.conformal.strip import across, harmonic, picard

STILL = 1e-13
"""Change (radians) in a step at which the iteration ends."""
PLAIN, NEWTON = 1_000, 9
"""The most plain steps, and steps of Newton's method after them."""
SMALL = 1e-6
"""Largest change (radians) of modes between which a step's derivative is the difference of steps."""


def converged(boundary: Boundary) -> Floats:
    """Return the nodes (ni, nj, 2)."""
    return solve([boundary], "off", _correction)[0].grid.nodes


def _correction(walls: Complexes, fars: Complexes, _: object) -> Complexes:
    """Return the limit of the compiled steps minus the harmonic extension.

    The filter applies once to the whole change, in place of once to each step.
    """
    back = 1.0 - across().smooth[:, None]
    results = []
    for wall, far in zip(walls, fars, strict=True):
        start = harmonic(wall, far, across().eta)

        def change(c: Complexes, start: Complexes = start) -> Complexes:
            return picard(c, 1)[0] + back * (start - c) - c

        results.append(_limit(change, start) - start)
    return np.array(results)


def _limit(change: Callable[[Complexes], Complexes], start: Complexes) -> Complexes:
    """Return the modes that do not change: after plain steps, or after Newton's if plain ones are slow."""
    c = start
    for step in range(PLAIN + NEWTON):
        moved = change(c)
        if np.abs(moved).max() < STILL:
            return c + moved
        c = c + (moved if step < PLAIN else _newton(change, c, moved))
    raise AssertionError(
        f"Winslow's equations did not converge: a step changes modes by {np.abs(moved).max()}"
    )


def _newton(change: Callable[[Complexes], Complexes], c: Complexes, moved: Complexes) -> Complexes:
    """Return the step of Newton's method to where `change`, which is `moved` at `c`, vanishes."""

    def modes_of(values: Floats) -> Complexes:
        inside = values.reshape(len(c), -1).view(complex)
        return np.pad(inside, ((0, 0), (1, 1)))

    def values_of(modes: Complexes) -> Floats:
        return modes[:, 1:-1].copy().view(float).ravel()

    def falls(way: Floats) -> Floats:
        """Minus the derivative of `change` along a way."""
        by = SMALL / np.abs(way).max()
        step = modes_of(by * way)
        return values_of(change(c - step) - change(c + step)) / (2.0 * by)

    right = values_of(moved)
    system = LinearOperator((right.size, right.size), matvec=falls, dtype=float)
    return modes_of(gmres(system, right, rtol=1e-3, restart=120, maxiter=4)[0])
