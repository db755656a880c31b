"""The quality metrics of a cell (docs/reference/metrics.md). To add one, add a line to `METRICS`.

Sources: C. J. Stimpson et al., The Verdict Geometric Quality Library, SAND2007-1751 (2007), and its code in
VTK, V_QuadMetric.cpp and V_HexMetric.cpp; A. Johnen, J.-F. Remacle, C. Geuzaine, Geometrical validity of
curvilinear finite elements, J. Comput. Phys. 233 (2013) 359-372.
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
    """A quality metric; `worst` says which of its extremes is bad, ``min`` or ``max``."""

    name: str
    unit: str
    worst: Literal["min", "max"]
    short: str
    cells: Callable[[Floats], Floats] | None = None  # from nodes (ni, nj[, nk], d) to values; None: compiled


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
    """Return the metrics for the cells of `grid`: metrics of quadrilaterals or of hexahedra."""
    return (*(SOLID_METRICS if grid.form == "volume" else QUAD_METRICS), *METRICS)


def metric_of(grid: Grid, name: str) -> Metric:
    """Return the metric called `name`. Raises InputError: cells of `grid` have no such metric."""
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
