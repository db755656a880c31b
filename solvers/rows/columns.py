"""Layers of a section, respaced so that first cells have the prescribed height in space."""

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, arc_parts, norms, smooth_step
from meshonet.geometry.curves.cubic import sampled
from meshonet.geometry.elementary import exp, log
from meshonet.geometry.layout.layout import Layout

_NEWTON, _SETTLED = 12, 1e-12  # steps at the most, and a step after which others would be rounding
_STRAIGHT, _MARCHED = 0.5, 1.5  # distances of straight and marched columns from corners, in thicknesses


def layer_columns(layout: Layout) -> Indices:
    """Return indices (k, layers + 1) of nodes in a blade's layers: clockwise around it, and outwards."""
    blocks = [layout.blocks[number] for number in layout.layers]
    ordered, left = [blocks[0]], blocks[1:]
    while left:
        k = next(k for k, each in enumerate(left) if each[0, 0] == ordered[-1][-1, 0])
        ordered.append(left.pop(k))
    return np.concatenate([block[:-1] for block in ordered])


def straight_near(lines: Floats, away: Floats) -> Floats:
    """Return grid lines (k, m, 2) through layers, straightened near corners of the wall.

    `away` (k,) is the distance of each line from the nearest corner.
    """
    thickness = norms(np.diff(lines, axis=1)).sum(axis=1).max()
    t = np.clip((_MARCHED - away / thickness) / (_MARCHED - _STRAIGHT), 0.0, 1.0)
    part = smooth_step(t)
    straight = lines[:, :1] + arc_parts(lines)[..., None] * (lines[:, -1:] - lines[:, :1])
    return np.asarray(lines + part[:, None, None] * (straight - lines))


def respaced_columns(values: Floats, space: Floats, first: float) -> Floats:
    """Return s, theta (k, m, 2) of the nodes of k columns, moved so that first cells are `first` high.

    `values` (k, m, 2) are s (see `Channel`) and theta of the given nodes, `space` (k, m, 3) their x, y, z.
    Nodes move along their column; its outer end stays.
    """
    steps = norms(np.diff(space, axis=1))
    return resampled(values, steps, with_first(steps, np.full(len(steps), first)))


def resampled(values: Floats, steps: Floats, new: Floats) -> Floats:
    """Return `values` (k, m, 2) of the nodes on k lines, interpolated to new nodes on the same lines.

    `steps` (k, m - 1) are the lengths of cells, `new` (k, m - 1) the lengths of cells between the new nodes.
    """
    arcs = arcs_of(steps)
    return sampled(values, arcs, arcs_of(new))


def arcs_of(steps: Floats) -> Floats:
    """Return the arc lengths (k, m + 1) at the nodes of k lines with cells of the lengths `steps` (k, m)."""
    return np.concatenate([np.zeros((len(steps), 1)), np.cumsum(steps, axis=1)], axis=1)


def with_first(steps: Floats, first: Floats) -> Floats:
    """Return `steps` (k, m), changed gradually so that the first is `first` (k,) and sums stay the same."""
    t = np.linspace(0.0, 1.0, steps.shape[1])
    begin = steps * exp(log(first[:, None] / steps[:, :1]) * (1.0 - t) ** 2)
    total = steps.sum(axis=1)
    bend = np.zeros(len(steps))
    for _ in range(_NEWTON):
        sizes = begin * exp(bend[:, None] * (t * (1.0 - t)))
        step = (sizes.sum(axis=1) - total) / (sizes * (t * (1.0 - t))).sum(axis=1)
        bend -= step
        if np.abs(step).max() < _SETTLED:
            break
    sizes = begin * exp(bend[:, None] * (t * (1.0 - t)))
    sizes[:, 1:] *= ((total - first) / sizes[:, 1:].sum(axis=1))[:, None]
    sizes[:, 0] = first
    return np.asarray(sizes)
