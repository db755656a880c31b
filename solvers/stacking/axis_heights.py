"""Heights of nodes along the axis of a duct or blade whose sections are unevenly spaced.

Each section is at a node; cells next to short panels grow from the cells of these.
"""

from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import Floats, Indices
from meshonet.solvers.stacking.span_heights import by_panel, growth_at, largest_growth, span_heights
from meshonet.solvers.stacking.wing_surface import DEFAULT_SPAN

GROWTH = 1.2  # largest ratio of neighbouring cells along the axis without a note
SLOPE = 0.15  # growth of cell lengths per length, away from short panels
MOST, STEPS = 2, 8  # largest number of cells tried, in default numbers; and how many numbers are tried
WORTH = 1.05  # ratio by which more cells must reduce the growth
_SAMPLES = 16  # of each panel
_BISECTIONS = 50
_TIE = 1e-9  # so that a half is rounded alike on every processor


def axis_heights(
    sections: Floats, nodes: int | None, panels: Sequence[int | None]
) -> tuple[Floats, tuple[str, ...]]:
    """Return z (n,) of nodes along the axis, and notes; there is a node at each z in `sections`.

    `nodes` is the number of nodes, by default 49, or more if sections are uneven. `panels` has the number of
    cells between each section and the next, or None if it is free.

    Raises InputError as `span_heights`.
    """
    enough = nodes or max(DEFAULT_SPAN, len(sections))
    heights = span_heights(sections, enough, None, panels)
    if all(each is None for each in panels) and largest_growth(heights) > GROWTH:
        cells = enough - 1
        tried = {cells} if nodes else {cells + (MOST - 1) * cells * k // STEPS for k in range(STEPS + 1)}
        made = [heights] + [_gradual(sections, count) for count in sorted(tried)]
        least = min(map(largest_growth, made))
        heights = next(each for each in made if largest_growth(each) <= max(GROWTH, WORTH * least))
    return heights, (*_counted(heights, nodes), *_uneven(heights))


def _counted(heights: Floats, nodes: int | None) -> list[str]:
    if nodes or len(heights) == DEFAULT_SPAN:
        return []
    return [f"{len(heights)} nodes along z instead of {DEFAULT_SPAN}, for the spacing of the sections"]


def _uneven(heights: Floats) -> list[str]:
    """Return a note on the largest growth along the axis, if it is large."""
    growth = growth_at(heights)
    most = int(growth.argmax())
    if growth[most] <= GROWTH:
        return []
    z = float(heights[1 + most])
    differ = f"cells along z differ by a factor of {growth[most]:.3g} at z={z:g}"
    remedy = "space them evenly, or give more nodes by {span}"
    return [f"{differ}, where sections are unevenly spaced: {remedy}"]


def _gradual(sections: Floats, cells: int) -> Floats:
    """Return heights of nodes with `cells` cells, shorter near short panels."""
    lengths = np.diff(sections)
    places = sections[:-1, None] + lengths[:, None] * (np.arange(_SAMPLES) + 0.5) / _SAMPLES
    away = np.maximum(sections[:-1] - places[..., None], places[..., None] - sections[1:])
    limit = (lengths + SLOPE * np.maximum(away, 0.0)).min(axis=-1)

    def wanted(size: float) -> Floats:
        """Return the number of cells (panels,) for a length of cells far from short panels."""
        count = np.zeros(len(lengths))
        for k in range(_SAMPLES):
            count += lengths / (_SAMPLES * np.minimum(size, limit[:, k]))
        return count

    low, high = 0.0, float(sections[-1] - sections[0])
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _rounded(wanted(middle)).sum() > cells else (low, middle)
    counts, want = _rounded(wanted(high)), wanted(high)
    while (off := cells - int(counts.sum())) != 0:  # equal panels are rounded together
        rest = (want - counts) / want if off > 0 else np.where(counts > 1, (counts - want) / want, -np.inf)
        counts[int(rest.argmax())] += 1 if off > 0 else -1
    return by_panel(sections, counts.tolist(), None)


def _rounded(counts: Floats) -> Indices:
    return np.maximum(np.floor(counts + (0.5 - _TIE)), 1.0).astype(np.intp)
