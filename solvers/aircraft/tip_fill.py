"""The section of a wing at its tip, filled: a ring whose cells go on as those of the collar, and a core."""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.solvers.rows.span_spacing import smooth_arcs
from meshonet.solvers.stacking.tip import ROWS, Cap

_GROWTH = 1.3
"""Growth of the rows of the ring: the section is thin, and its edge is no place of boundary layers."""
_LONGEST = 0.2
"""Longest first and last cells of the ring over the lengths of its lines: less than 1 - 1 / `_GROWTH`."""
_MOST_ROWS = 200


def tip_patches(loop: Floats, first: float) -> tuple[Floats, Floats]:
    """Return nodes of the ring (n, rows + 1, 3) and of the core (m, k, 3) inside a closed `loop` (n, 3).

    The outermost cells of the ring are `first` long, so that they match those of a collar outside, or shorter
    where the section is too thin for them.
    """
    ring, core = Cap(bulge=0.0).patches(loop)
    edge, inner = ring[:, 0], ring[:, -1]
    lengths = norms(inner - edge)
    last = np.minimum(norms(inner - ring[:, -2]), _LONGEST * lengths)
    outermost = np.minimum(first, _LONGEST * lengths)
    for rows in range(ROWS, _MOST_ROWS):
        arcs = smooth_arcs(lengths, (outermost, last), rows)
        steps = np.diff(arcs)
        if (steps[:, 1] <= _GROWTH * steps[:, 0]).all():
            break
    parts = (arcs / lengths[:, None])[..., None]
    nodes = edge[:, None] + parts * (inner - edge)[:, None]
    nodes[:, -1] = inner
    return nodes, core
