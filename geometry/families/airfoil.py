"""Case 5 of the paper: symmetric airfoils of varying thickness in a far field.

::

          .-''''''-.           NACA 00xx with a closed trailing edge; the parameter is the thickness in
         (    t     '''--..    chords; the far field is a circle of 15 chords around mid-chord
          '-......-'''''
"""

from __future__ import annotations

import numpy as np

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.families.family import Family
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.airfoil.naca import POINTS, thickness
from meshonet.geometry.spacing.sampling import Sampling


def boundary(ratio: float, ni: int, nj: int) -> Boundary:
    """Return the O boundary around the section that is `ratio` chords thick."""
    x = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, POINTS))
    half = thickness(x, ratio, sharp=True)
    upper, lower = np.stack([x, half], axis=1), np.stack([x, -half], axis=1)
    section = Airfoil(np.concatenate([upper[::-1], lower[1:]]), f"airfoil-{ratio:.6g}")
    return section.boundary(Sampling(ni=ni, nj=nj))


FAMILY = Family("airfoil", "thickness in chords", 0.06, 0.24, 0.01, 0.6, "o", boundary)
