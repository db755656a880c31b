"""The quality metrics of a cell. To add one, add a line to `METRICS`.

A cell has its corners at nodes a = (i, j), b = (i+1, j), c = (i+1, j+1), d = (i, j+1). Metrics that Verdict
also has are defined as there for a planar quadrilateral, except that Verdict ignores orientation: here a cell
whose corners run clockwise is folded. An edge of zero length has no direction: such a cell counts as having
angles of 0 and 180 degrees and a scaled Jacobian of 0.

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
area_ratio          greatest ratio, larger over smaller, of the areas of a cell and of a neighbour in i or j,
                    also across the seam of an ``o`` grid and the wake of a ``c`` grid
==================  ========================================================================================

A cell of a surface patch is measured as such a quadrilateral in space, relative to its own normal at its
centre.

A cell of a volume has three edges u, v, w at each of its 8 corners, in the direction of their indices, and
the corner Jacobian u . (v x w). A corner with an edge of zero length, as at a pole, is left out.

==================  ========================================================================================
max_angle           greatest of the 24 angles between two edges at a corner, degrees
min_angle           least of these angles, degrees
skewness            max((max_angle - 90)/90, (90 - min_angle)/90) (Verdict: equiangle skew, faces without a
                    reflex angle)
deviation           greatest deviation of the three angles at a corner from 90 degrees, averaged over the
                    corners
scaled_jacobian     least, over the corners and the centre, of the Jacobian over the product of the lengths of
                    its three vectors, at the centre the principal axes (Verdict: scaled Jacobian)
jacobian_ratio      least corner Jacobian over the greatest absolute value of a corner Jacobian (Verdict:
                    nodal Jacobian ratio; the quality that pyHyp prints)
bezier_ratio        least of the 27 Bezier coefficients of the Jacobian over the greatest absolute value of a
                    corner Jacobian: if it is positive, so is the Jacobian everywhere in the cell
aspect_ratio        longest over shortest principal axis (Verdict: maximum edge ratio)
orthogonality       least angle between the three families of grid lines at the centre of the cell, 0 to 90
                    degrees (Verdict: the arc cosine of skew)
volume_ratio        greatest ratio, larger over smaller, of the volumes of a cell and of a neighbour in i, j
                    or k, also across connections; the volume is that of the trilinear cell (Verdict:
                    volume)
==================  ========================================================================================

Sources: C. J. Stimpson et al., The Verdict Geometric Quality Library, SAND2007-1751 (2007); its code in
VTK, ThirdParty/verdict/vtkverdict/V_QuadMetric.cpp and V_HexMetric.cpp; A. Johnen, J.-F. Remacle, C.
Geuzaine, Geometrical validity of curvilinear finite elements, J. Comput. Phys. 233 (2013) 359-372.
"""

from collections.abc import Callable
from dataclasses import dataclass
from operator import attrgetter
from typing import Literal

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError


@dataclass(frozen=True)
class Metric:
    """A quality metric; `worst` is the extreme that is bad, ``min`` or ``max``."""

    name: str
    unit: str
    worst: Literal["min", "max"]
    short: str
    cells: Callable[[Floats], Floats] | None = None
    """From nodes (ni, nj, 2), (ni, nj, 3) or (ni, nj, nk, 3) of a block to values (ni-1, nj-1[, nk-1]) of its
    cells; None for metrics of the compiled kernels."""


_NAME = attrgetter("name")
METRICS: tuple[Metric, ...] = ()
"""Metrics of all cells, in the plane, on surfaces and in volumes, each with its function."""

# those of kernels/geometry/cells.h, in its order
QUAD_METRICS: tuple[Metric, ...] = (
    Metric("max_angle", "deg", "max", "greatest included angle"),
    Metric("min_angle", "deg", "min", "least included angle"),
    Metric("skewness", "", "max", "equiangle skewness, 0 to 1 unless folded"),
    Metric("scaled_jacobian", "", "min", "least sine of a corner, -1 to 1"),
    Metric("aspect_ratio", "", "max", "longest edge x perimeter / 4 areas"),
    Metric("orthogonality", "deg", "min", "angle between grid lines, 90 at best"),
    Metric("area_ratio", "", "max", "area against the neighbours'"),
)

NAMES: tuple[str, ...] = tuple(map(_NAME, QUAD_METRICS))

# those of kernels/solids/solids.h, in its order
SOLID_METRICS: tuple[Metric, ...] = (
    Metric("max_angle", "deg", "max", "greatest angle of two edges at a corner"),
    Metric("min_angle", "deg", "min", "least angle of two edges at a corner"),
    Metric("skewness", "", "max", "equiangle skewness, 0 to 1"),
    Metric("deviation", "deg", "max", "deviation of corner angles from 90"),
    Metric("scaled_jacobian", "", "min", "least Jacobian of unit edges, -1 to 1"),
    Metric("jacobian_ratio", "", "min", "least over greatest corner Jacobian"),
    Metric("bezier_ratio", "", "min", "least Bezier coefficient over greatest Jacobian"),
    Metric("aspect_ratio", "", "max", "longest over shortest axis"),
    Metric("orthogonality", "deg", "min", "angle between grid lines, 90 at best"),
    Metric("volume_ratio", "", "max", "volume against the neighbours'"),
)

# those of geometry/quality/checkmesh.py: drawn, but no part of the table, since faces have them and not cells
FACE_METRICS: tuple[Metric, ...] = (
    Metric("non_orthogonality", "deg", "max", "greatest of its faces, as in checkMesh"),
    Metric("face_skewness", "", "max", "greatest of its faces, as in checkMesh"),
    Metric("box_ratio", "", "max", "aspect ratio, as in checkMesh"),
)
# that of geometry/quality/lines.py: drawn, but no part of the table, since lines have it and not cells
LINE_METRIC = Metric("growth", "", "max", "greatest growth of lines at its nodes")

SOLID_NAMES: tuple[str, ...] = tuple(map(_NAME, SOLID_METRICS))
FACE_NAMES: tuple[str, ...] = tuple(map(_NAME, FACE_METRICS))
ALL_NAMES = tuple(dict.fromkeys((*NAMES, *SOLID_NAMES, *map(_NAME, METRICS))))
"""Names of the metrics of planes, surfaces and volumes."""


def metrics_of(grid: Grid) -> tuple[Metric, ...]:
    """Return the metrics of the cells of `grid`: those of quadrilaterals or of volumes."""
    return (*(SOLID_METRICS if grid.form == "volume" else QUAD_METRICS), *METRICS)


def metric_of(grid: Grid, name: str) -> Metric:
    """Return the metric called `name`; raise InputError if cells of `grid` have none of that name."""
    metrics = (*metrics_of(grid), LINE_METRIC, *(() if grid.form == "surface" else FACE_METRICS))
    for metric in metrics:
        if metric.name == name:
            return metric
    what = f"metric {name!r} is not known"
    if name in FACE_NAMES:
        what = f"metric {name!r} is none of surfaces, whose cells have no faces between them"
    if name in ALL_NAMES:
        cells = "volumes" if grid.form == "volume" else "quadrilaterals"
        what = f"metric {name!r} is none of {cells}"
    raise InputError(what, "use one of " + ", ".join(metric.name for metric in metrics))
