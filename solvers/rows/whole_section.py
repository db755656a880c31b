"""Adds layers, and rows to inlet and outlet, to the blocks of a section."""

import math
from collections.abc import Mapping

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import log
from meshonet.geometry.layout.layout import Layout
from meshonet.solvers.blocking.layers.attach import Rows
from meshonet.solvers.blocking.layers.layer_rows import heights_inside, ring_rows
from meshonet.solvers.cascade.cascade_layout import row_steps, straight_rows
from meshonet.solvers.cascade.passage import BLADE, extended
from meshonet.solvers.rows.section_plane import SectionPlane

_BISECTIONS = 60
_RATIO = 2.0


def whole_section(
    plane: SectionPlane, beyond: Layout, layers: int, largest: float, longest: Mapping[int, float]
) -> Layout:  # fmt: skip
    """Return the layout of a section with this many `layers`, and straight grid lines to inlet and outlet.

    Parameters
    ----------
    beyond : layout of the blocks beyond the layers, in m' (see `MeridionalMap`) and theta.
    largest : length of the longest cells along the straight lines.
    longest : largest length, in any section, of straight grid lines to `INLET` and `OUTLET` (the keys).
    """
    cascade = plane.cascade
    mesh = beyond.mesh
    inner = heights_inside(beyond, BLADE)
    rows = [ring_rows(mesh, BLADE, cascade.ring, layers, cascade.layers, inner, cascade.factors_at)]
    for number, length, way in straight_rows(cascade):
        start = mesh.nodes[mesh.places.along(number)]
        first = math.exp(log(heights_inside(beyond, number)).mean())
        count = len(row_steps(first, max(length, longest[number]), largest)) - 1
        steps = _grown(first, length, count)
        rows.append(
            Rows(
                number,
                start[:, None] + steps[:, None] * (way * cascade.passage.axis),
                np.zeros(len(start)),
                False,
            )
        )
    return extended(beyond, cascade.passage, cascade.blade, rows)


def _grown(first: float, length: float, cells: int) -> Floats:
    """Return distances (cells + 1,) from 0 to a length, of cells that follow one of size `first`."""
    low, high = 1.0 / _RATIO, _RATIO
    for _ in range(_BISECTIONS):
        ratio = 0.5 * (low + high)
        total = first * sum(math.pow(ratio, k + 1) for k in range(cells))
        low, high = (low, ratio) if total > length else (ratio, high)
    steps = np.concatenate([[0.0], np.cumsum([math.pow(ratio, k + 1) for k in range(cells)])])
    return np.asarray(steps * (length / steps[-1]))
