"""Whether a smoothed grid of blocks is no worse than the one that was given, and which of several is best."""

from __future__ import annotations

import math
from dataclasses import dataclass

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.blocks import block_figures
from meshonet.geometry.quality.checkmesh import faces
from meshonet.geometry.quality.measure import count_folded_in

_SLACK = 1e-7
"""Degrees, and parts of a skewness, that rounding may add."""
_NOTHING = 1.0, 0.05, 0.1
"""Non-orthogonality, skewness and mean deviation up to which one is as good as the other."""


@dataclass(frozen=True)
class PlaneMeasures:
    """Folded cells and what must not become worse; the score, of which less is better, is of all together."""

    folded: int
    angle: float
    """Largest non-orthogonality of a face, degrees."""
    skew: float
    """Largest skewness of a face."""
    mean: float
    """Mean deviation of corners from 90 degrees."""
    score: float

    def no_worse(self, than: PlaneMeasures) -> bool:
        """Say whether no figure is larger."""
        if than.folded or self.folded:
            return self.folded < than.folded
        pairs = (self.angle, than.angle), (self.skew, than.skew), (self.mean, than.mean)
        both = zip(pairs, _NOTHING, strict=True)
        return all(own <= max(other + _SLACK, nothing) for (own, other), nothing in both)


def measures(grid: Grid) -> PlaneMeasures:
    """Return the measures of a grid of planar blocks."""
    of_faces, figures = faces(grid), block_figures(grid)
    angle = of_faces.non_orthogonality.max if of_faces.non_orthogonality else 0.0
    skew = of_faces.face_skewness.max if of_faces.face_skewness else 0.0
    angles, across = figures.deviation, figures.lines.growth_across
    jump = math.log(across.max) if across else 0.0
    folded = count_folded_in(grid)
    score = angle / 30.0 + skew + angles.mean / 5.0 + (angles.p99 or 0.0) / 30.0 + jump
    return PlaneMeasures(folded, angle, skew, angles.mean, math.inf if folded else score)
