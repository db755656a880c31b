"""Heights of nodes along the span of a wing, blade or duct, with a node at each section."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, growth_ratios
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.along_curve import on_corners
from meshonet.geometry.spacing.tanh_law import TanhLaw
from meshonet.solvers.rows.span_spacing import smooth_arcs

_ROOT_CELL = 1.4  # length of the cell at the root relative to the mean cell along the span
_EVEN = 1e-6  # smallest relative decrease of the largest growth for which a cell changes its panel


def span_heights(
    sections: Floats, nodes: int, last: float | None, panels: Sequence[int | None] = ()
) -> Floats:
    """Return z (nodes,) of nodes along the span; each height in `sections` is the z of a node.

    Cells decrease towards the tip to the length `last`; if it is None, they are nearly equal. `panels` has
    the number of cells between each section and the next; panels with None share the remaining cells.
    Raises InputError if there are more sections than nodes, or if numbers of cells do not fit.
    """
    cells, span = nodes - 1, float(sections[-1] - sections[0])
    q = np.linspace(0.0, 1.0, nodes)
    if last is not None and last < span / cells:
        q = TanhLaw.fitted(cells, _ROOT_CELL / cells, last / span)(q)
    away = on_corners(q, (sections[1:-1] - sections[0]) / span)
    heights = np.asarray(sections[0] + span * away)
    inner = np.searchsorted(away, (sections[1:-1] - sections[0]) / span)
    heights[inner], heights[-1] = sections[1:-1], sections[-1]
    if all(each is None for each in panels):
        return heights
    free = [k for k, each in enumerate(panels) if each is None]
    split = _cells(np.diff([0, *inner, cells]), panels, free)
    best, growth = by_panel(sections, split, last), np.inf
    while len(free) > 1:  # cells move to where neighbours differ most
        moved = [_moved(split, a, b) for a in free for b in free if a != b and split[a] > 1]
        made = [(largest_growth(heights := by_panel(sections, each, last)), each, heights) for each in moved]
        least = min(made, key=lambda each: each[0], default=(np.inf, split, best))
        if not least[0] < (1.0 - _EVEN) * min(growth, largest_growth(best)):
            break
        growth, split, best = least
    return best


def _moved(cells: list[int], source: int, target: int) -> list[int]:
    out = list(cells)
    out[source], out[target] = out[source] - 1, out[target] + 1
    return out


def growth_at(heights: Floats) -> Floats:
    """Return the ratio (n - 2,), 1 or more, of the two cells at each inner node of `heights` (n,)."""
    return growth_ratios(np.diff(heights))


def largest_growth(heights: Floats) -> float:
    """Return the largest ratio of neighbouring cells between nodes at `heights` (n,)."""
    return float(growth_at(heights).max())


def _cells(own: Indices, panels: Sequence[int | None], free: Sequence[int]) -> list[int]:
    """Return the cells of each panel; panels without a number share the rest in proportion to `own`."""
    rest = int(own.sum()) - sum(each for each in panels if each is not None)
    if rest < len(free) or (rest and not free):
        prescribed = int(own.sum()) - rest
        problem = f"{int(own.sum()) + 1} nodes along the span, and panels with {prescribed + 1} of them"
        raise InputError(problem, f"use {prescribed + len(free) + 1} or more", parameter="span")
    out = [each or 0 for each in panels]
    for k in free:  # the last one takes what rounding leaves
        later = [j for j in free if j >= k]
        share = rest * int(own[k]) / sum(int(own[j]) for j in later)
        out[k] = min(max(round(share), 1), rest - len(later) + 1)
        rest -= out[k]
    return out


def by_panel(sections: Floats, cells: Sequence[int], last: float | None) -> Floats:
    """Return heights of nodes: one at each of `sections` (n,), and `cells` (n - 1,) cells between these.

    The cell at the tip is at most `last` high (None: any) if the top two sections are 3 or more cells apart.
    """
    lengths = np.diff(sections)
    means = lengths / np.array(cells)
    ends = np.concatenate([means[:1], np.sqrt(means[1:] * means[:-1]), means[-1:]])
    if last is not None:
        ends[-1] = min(last, ends[-1])
    heights = [sections[:1]]
    for k, (first, end) in enumerate(pairwise(ends)):
        if cells[k] > 2:
            inner = smooth_arcs(lengths[k : k + 1], (first, end), cells[k])[0, 1:-1]
        else:
            inner = lengths[k] * np.array([first / (first + end)])[: cells[k] - 1]
        heights.append(np.append(sections[k] + inner, sections[k + 1]))
    return np.concatenate(heights)
