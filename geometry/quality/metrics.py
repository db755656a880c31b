"""The quality metrics of a cell: a new one is a line in `METRICS`.

A cell has its corners at nodes a = (i, j), b = (i+1, j), c = (i+1, j+1), d = (i, j+1). Where Verdict has a
metric, this is Verdict's definition for a quadrilateral that lies in the plane; a cell whose corners run
clockwise has no orientation there and is folded here. An edge of no length has no direction: such a cell
counts as having angles of 0 and 180 degrees and a scaled Jacobian of 0.

==================  ========================================================================================
max_angle           greatest included angle, degrees; 360 minus the greatest angle between two edges when a
                    corner Jacobian is negative (Verdict: maximum angle)
min_angle           least included angle, degrees (Verdict: minimum angle)
skewness            max((max_angle - 90)/90, (90 - min_angle)/90) (Verdict: equiangle skew)
scaled_jacobian     least over the corners of u x v / (abs(u) abs(v)), u and v the edges that meet there
                    (Verdict: scaled Jacobian)
aspect_ratio        longest edge times perimeter over four areas; (r + 1)/2 for a rectangle with sides 1 and r
                    (Verdict: aspect ratio)
orthogonality       angle between the two families of grid lines at the centre of the cell, 0 to 90 degrees
                    (Verdict: the arc cosine of skew)
area_ratio          greatest ratio, larger over smaller, of the areas of a cell and of one beside it in i or
                    j, across the seam of an ``o`` grid and the wake of a ``c`` grid too
==================  ========================================================================================

Sources: C. J. Stimpson et al., The Verdict Geometric Quality Library, SAND2007-1751 (2007); its code in
VTK, ThirdParty/verdict/vtkverdict/V_QuadMetric.cpp.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid


@dataclass(frozen=True)
class Metric:
    """A quality metric; `worst` says which of its ends is the bad one."""

    name: str
    unit: str
    worst: Literal["min", "max"]
    short: str
    cells: Callable[[Grid], Floats] | None = None
    """Gives its value (ni-1, nj-1) for every cell of a grid; None for those of the compiled kernel."""


# first those of the compiled kernel, in its order (kernels/geometry/cells.h), then those with a function
METRICS: tuple[Metric, ...] = (
    Metric("max_angle", "deg", "max", "greatest included angle"),
    Metric("min_angle", "deg", "min", "least included angle"),
    Metric("skewness", "", "max", "equiangle skewness, 0 to 1 unless folded"),
    Metric("scaled_jacobian", "", "min", "least sine of a corner, -1 to 1"),
    Metric("aspect_ratio", "", "max", "longest edge x perimeter / 4 areas"),
    Metric("orthogonality", "deg", "min", "angle between grid lines, 90 at best"),
    Metric("area_ratio", "", "max", "area against the neighbours'"),
)

NAMES: tuple[str, ...] = tuple(metric.name for metric in METRICS)
COMPILED = tuple(metric for metric in METRICS if metric.cells is None)
