"""The section of a wing at its tip, filled: a ring whose cells go on as those of the collar, and a core."""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.solvers.rows.span_spacing import smooth_arcs, spaced_cells, two_sided
from meshonet.solvers.stacking.tip import ROWS, Cap

_GROWTH = 1.25
"""Growth of the rows of the ring: the section is thin, and its edge is no place of boundary layers."""
_LONGEST = 0.2
"""Longest outermost cells of the ring over the lengths of its lines: 1 - 1 / `_GROWTH`."""


def tip_patches(loop: Floats, first: float) -> tuple[Floats, Floats]:
    """Return nodes of the ring (n, rows + 1, 3) and of the core (m, k, 3) inside a closed `loop` (n, 3).

    The outermost cells of the ring are `first` long, so that they match those of a collar outside, or shorter
    where the section is too thin for them.
    """
    ring, core = Cap(bulge=0.0).patches(loop)
    edge, inner = ring[:, 0], ring[:, -1]
    lengths, last = norms(inner - edge), norms(inner - ring[:, -2])
    widest = int(lengths.argmax())
    length, ends = float(lengths[widest]), (first, float(last[widest]))
    rows = spaced_cells(length, ends, _GROWTH, length, ROWS)
    wide, outermost = lengths > rows * first, np.minimum(first, _LONGEST * lengths)
    arcs = smooth_arcs(lengths, (outermost, None), rows)
    arcs[wide] = two_sided(lengths[wide], (first, last[wide]), _GROWTH, rows)
    parts = (arcs / lengths[:, None])[..., None]
    nodes = edge[:, None] + parts * (inner - edge)[:, None]
    nodes[:, -1] = inner
    return nodes, core
