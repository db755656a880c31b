"""The handedness of a volume block, by the sign of its volume."""

from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import Floats


def signed_volume(coordinates: Sequence[Floats]) -> float:
    """Return the volume of a block, negative if left-handed; `coordinates` are x, y, z, (ni, nj, nk) each.

    By the divergence theorem, V = 1/3 ∮ r·n dA over the six faces. For each quadrilateral, r is its centre
    and n dA is half the cross product of its diagonals, which neglects its curvature.
    """
    centre = [float(values[0, 0, 0]) for values in coordinates]
    total = 0.0
    for axis in range(3):
        for end, sign in ((0, -1.0), (-1, 1.0)):
            at = (slice(None),) * axis + (end,)
            face = np.stack(
                [values[at].astype(np.float64) - x for values, x in zip(coordinates, centre, strict=True)]
            )
            # the order of a face's directions: (j, k), (k, i), (i, j)
            total += sign * flux_through(face if axis != 1 else face.swapaxes(1, 2))
    return total / 3.0


def flux_through(face: Floats) -> float:
    """Return the integral of the position times the normal over a face with nodes (3, n, m)."""
    a, b, c, d = face[:, :-1, :-1], face[:, 1:, :-1], face[:, 1:, 1:], face[:, :-1, 1:]
    (x, y, z), (u, v, w) = c - a, d - b
    area = 0.5 * np.stack([y * w - z * v, z * u - x * w, x * v - y * u])
    return float((0.25 * (a + b + c + d) * area).sum())
