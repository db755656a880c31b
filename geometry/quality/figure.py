"""A scalar figure of a grid with its place, and the names of the figures that gates and profiles judge."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from meshonet.geometry.summary import named

COUNTS = ("folded", "bezier_folded")
"""Names of the counts of folded cells: by corner Jacobians, and by the Bezier test of volumes."""
FIGURES: Mapping[str, str] = MappingProxyType({
    "growth": "greatest ratio of neighbouring steps along all directions of grid lines, sides of blocks too",
    "wall_growth": "the same along the lines that leave walls",
    "equal_wall_cells": "fewest equal cells at a wall",
    "far_field": "least distance of the far field from the middle of the walls, in chords",
    "non_orthogonality": "greatest of checkMesh's, degrees",
    "face_skewness": "greatest of checkMesh's",
    "box_ratio": "checkMesh's aspect ratio, the greatest",
    "irregular": "irregular vertices",
    "deviation_mean": "deviation of corner angles from 90 degrees, mean",
    "deviation_p99": "its 99th percentile",
    "growth_across": "growth across sides of blocks",
    "bend_across": "bend across sides of blocks, degrees",
})  # fmt: skip
"""Names of the figures other than metrics and counts, with a description of each."""


@dataclass(frozen=True)
class Figure:
    """A value, with its node or cell (i, j) or (block, i, j[, k]) and the direction of its grid line.

    Place and direction are given if they are known.
    """

    value: float
    at: tuple[int, ...] | None = None
    along: str | None = None

    @property
    def where(self) -> str:
        """Direction and place as text for users, empty if neither is known.

        >>> Figure(1.4, (12, 0), "xi").where, Figure(3.0).where
        (' along xi at i=12, j=0', '')
        """
        return (f" along {self.along}" if self.along else "") + (f" at {named(self.at)}" if self.at else "")
