"""Compares a smoothed planar multi-block grid with the given one, and candidates with each other."""

import math
from dataclasses import dataclass
from typing import Self

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.blocks import block_figures
from meshonet.geometry.quality.checkmesh import faces
from meshonet.geometry.quality.measure import count_folded_in

_SLACK = 1e-7  # tolerance for rounding, in degrees and for skewness
_NOTHING = 1.0, 0.05, 0.1
"""Non-orthogonality, skewness and mean deviation below which differences are ignored."""


@dataclass(frozen=True)
class PlaneMeasures:
    """The number of folded cells, and measures that must not become worse; a smaller `score` is better."""

    folded: int
    angle: float  # largest non-orthogonality of a face in degrees
    skew: float  # largest skewness of a face
    mean: float  # mean deviation of corner angles from 90 degrees
    score: float

    def no_worse(self, than: Self) -> bool:
        """Return whether no measure is larger."""
        if than.folded or self.folded:
            return self.folded < than.folded
        pairs = (self.angle, than.angle), (self.skew, than.skew), (self.mean, than.mean)
        both = zip(pairs, _NOTHING, strict=True)
        return all(own <= max(other + _SLACK, nothing) for (own, other), nothing in both)


def measures(grid: Grid) -> PlaneMeasures:
    """Return the measures of a planar multi-block grid."""
    of_faces, figures = faces(grid), block_figures(grid)
    angle = of_faces.non_orthogonality.max if of_faces.non_orthogonality else 0.0
    skew = of_faces.face_skewness.max if of_faces.face_skewness else 0.0
    angles, across = figures.deviation, figures.lines.growth_across
    jump = math.log(across.max) if across else 0.0
    folded = count_folded_in(grid)
    score = angle / 30.0 + skew + angles.mean / 5.0 + (angles.p99 or 0.0) / 30.0 + jump
    return PlaneMeasures(folded, angle, skew, angles.mean, math.inf if folded else score)
