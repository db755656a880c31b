"""Blocks inside the section of a wing at its tip: a ring whose cells match the collar, and a core."""

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.sections.section import turned
from meshonet.solvers.rows.span_spacing import smooth_arcs
from meshonet.solvers.stacking.tip import ROWS, Cap

_GROWTH = 1.27  # growth ratio of the ring's rows: the section is thin and has no boundary layer there
_LONGEST = 0.18, 0.05  # outermost and innermost cells of lines that are too short, in their lengths
_MOST_ROWS = 200


def tip_patches(loop: Floats, first: float) -> tuple[Floats, Floats]:
    """Return patches inside a closed `loop` (n, 3): a ring (n, rows + 1, 3), and a core (m, k, 3) inside it.

    The loop starts at the trailing edge and runs along the upper side first. At the loop, the cells of
    the ring are `first` high, or lower where the section is too thin.
    """
    ring, core = Cap(bulge=0.0).patches(loop)
    edge, inner = ring[:, 0], ring[:, -1]
    lengths, last = norms(inner - edge), norms(inner - ring[:, -2])
    for rows in range(ROWS, _MOST_ROWS):
        arcs = _arcs(lengths, first, last, rows)
        steps = np.diff(arcs)
        if (steps[:, 1] <= _GROWTH * steps[:, 0]).all():
            break
    parts = (arcs / lengths[:, None])[..., None]
    nodes = edge[:, None] + parts * (inner - edge)[:, None]
    nodes[:, -1] = inner
    return nodes, core


def canted_tip_patches(loop: Floats, first: float, cant: float) -> tuple[Floats, Floats]:
    """Return the patches of `tip_patches` for a tip whose normal is turned by `cant` radians from z to y."""
    if not cant:
        return tip_patches(loop, first)
    place, cants = loop[0, 1:], np.array([-cant, cant])
    ring, core = tip_patches(turned(loop, place, cants[0]), first)
    ring, core = turned(ring, place, cants[1]), turned(core, place, cants[1])
    ring[:, 0] = loop
    return ring, core


def half_tip_patches(half: Floats, first: float) -> tuple[Floats, Floats]:
    """Return half the ring and half the core that fill the tip of a fin, on one side of the plane z = 0.

    `half` (n, 3) are nodes of half of the section, from nose to trailing edge. For `first` see `tip_patches`.
    """
    flat = half[:, [0, 2, 1]]
    loop = np.concatenate([flat[::-1], flat[1:] * [1.0, -1.0, 1.0]])
    ring, core = tip_patches(loop, first)
    ring, core = ring[: len(half)][::-1, :, [0, 2, 1]], core[:, : core.shape[1] // 2 + 1, [0, 2, 1]]
    ring[[0, -1], :, 2] = core[:, -1, 2] = 0.0
    return ring, core


def _arcs(lengths: Floats, first: float, last: Floats, rows: int) -> Floats:
    """Return arcs (n, rows + 1) on lines of `lengths` (n,), with end cells near `first` and `last` (n,)."""
    outer, inner = (max(share, 1.0 / rows) * lengths for share in _LONGEST)
    outermost = np.minimum(first, outer)
    constant = smooth_arcs(lengths, (outermost, None), rows)
    innermost = np.minimum(last, np.maximum(constant[:, -1] - constant[:, -2], inner))
    return smooth_arcs(lengths, (outermost, innermost), rows)
