"""What a geometry file holds before it is sampled."""

from __future__ import annotations

from typing import Protocol

from geometry.boundary import Boundary
from geometry.sampling import Sampling


class Shape(Protocol):
    """Anything that can be sampled into a boundary: an airfoil, an outline, a boundary itself."""

    @property
    def name(self) -> str:
        """What the input called it."""
        ...

    def boundary(self, sampling: Sampling) -> Boundary:
        """Return the four edges with the node counts and spacing of `sampling`."""
        ...
