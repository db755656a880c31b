"""Mirror symmetry of closed walls: whether a body is symmetric and, if not, which mirror image it is."""

from typing import TypeAlias

import numpy as np

from meshonet.geometry.arrays import Complexes
from meshonet.geometry.elementary import modulus

Axis: TypeAlias = tuple[complex, complex]
"""A straight line: one of its points, and the square of its direction (a unit complex number)."""

EQUAL = 1e-10  # in units of the wall's extent: nodes closer than this are mirror images


def farthest(wall: Complexes) -> tuple[int, int]:
    """Return the first and the last index of the nodes of `wall` (n,) that are farthest from node 0.

    Distances that differ only by rounding count as equal.
    """
    reach = modulus(wall - wall[0])
    ends = np.flatnonzero(reach > (1.0 - 1e-12) * reach.max())
    return int(ends[0]), int(ends[-1])


def handedness(wall: Complexes, far: Complexes) -> tuple[int, Axis]:
    """Return a sign (1, -1 or 0) that tells a body from its mirror image, and the axis of the mirror.

    The body is given by two curves of complex numbers, `wall` (n,) and `far` (n,). The axis runs from the
    first node of `wall` to the node of `wall` farthest from it, or to the midpoint of two that are farthest.
    The axis is returned as a point and the square of its direction, a complex number. The sign is that of the
    largest deviation of `wall` from symmetry, or of `far` if `wall` is symmetric, or 0 if both are.
    """
    a, b = farthest(wall)
    along = 0.5 * (wall[a] + wall[b]) - wall[0]
    unit = along / abs(along)
    for nodes in (wall, far):
        local = (nodes - wall[0]) / along
        half = np.arange(len(nodes) // 2 + 1)
        nodes_at, partners = local[half], local[-half % len(nodes)]
        amiss = np.concatenate([nodes_at.imag + partners.imag, nodes_at.real - partners.real])
        worst = float(amiss[np.argmax(np.abs(amiss))])
        if abs(worst) > EQUAL * float(modulus(local).max()):
            return (1 if worst > 0.0 else -1), (complex(wall[0]), complex(unit**2))
    return 0, (complex(wall[0]), complex(unit**2))
