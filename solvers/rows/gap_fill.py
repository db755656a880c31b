r"""Five blocks inside the outline of a blade, in a gap: a ring of four, and a core.

::

      .---------- side 0 ----------.        The ring's blocks count i along the outline, j inwards. The core
    .'\ _________________________ /'.       counts i along side 0 and j from side 0 to side 2; sides 1 and 3
   (  |___________ core __________|  )      go around the edges of the blade.
    './                           \.'
      '---------- side 2 ----------'
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.curves.cubic import cubic_spline
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.elementary import power
from meshonet.geometry.errors import NoValidGridError
from meshonet.geometry.layout.lattice import lattice_quads
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.geometry.polygon.corners import Indices
from meshonet.geometry.spacing.growth import cells_for_growth
from meshonet.solvers.energy.quads import optimise
from meshonet.solvers.rows.columns import resampled, with_first

_MOST_ASIDE = 8
"""Cells of half of side 1 or 3 at the most."""
_INSET = 0.5  # part of half the thickness that the ring fills
_FEWEST_ROWS = 4
_ITERATIONS = 150
_POWER = 6.0  # how fast the core's lines gather towards its ends


@dataclass(frozen=True, eq=False)
class GapFill:
    """The inside of an outline.

    Parameters
    ----------
    outline : (k,) numbers of its nodes, clockwise from the first of side 0; these come first in `layout`.
    layout : the five blocks, the core last.
    """

    outline: Indices
    layout: Layout


def outline_sides(outline: Floats, lead: int) -> list[Indices]:
    """Return positions of the four sides among the nodes of an outline (k, 2), `lead` at the leading edge.

    Sides 1 and 3 are as long as the round edges of the blade, about half circles.
    """
    count = len(outline)
    half = count // 2
    m = (_aside(outline, lead) + _aside(outline, lead + half) + 1) // 2
    cuts = [m, half - m, half + m, count - m, count + m]
    return [(lead + np.arange(a, b + 1)) % count for a, b in pairwise(cuts)]


def _aside(outline: Floats, edge: int) -> int:
    """Return how many nodes from an edge the outline has turned by about a right angle to both sides."""
    count = len(outline)
    m = np.arange(1, min(_MOST_ASIDE, count // 8) + 1)
    one, other = outline[(edge + m) % count], outline[(edge - m) % count]
    behind = norms(0.5 * (one + other) - outline[edge % count])
    round_off = np.flatnonzero(behind >= 0.5 * norms(one - other))
    return int(m[round_off[0]]) if len(round_off) else int(m[-1])


def filled_outline(outline: Floats, lead: int, first: float, growth: float) -> GapFill:
    """Return the five blocks inside an outline (k, 2), clockwise, at whose edge cells are `first` high.

    Raises NoValidGridError: they are folded.
    """
    sides = outline_sides(outline, lead)
    order = np.concatenate([side[:-1] for side in sides])
    start, blocks = _first_guess([outline[side] for side in sides], first, growth)
    loop = Loop.of_polygon(outline[order][::-1], (), ("blade",))
    places = Places.inside(len(start))
    around = np.arange(len(order))
    places.loop[around], places.arc[around] = 0, loop.curve.knots[::-1]
    held = np.zeros(len(start), dtype=bool)
    held[around] = True
    mesh = QuadMesh(Domain((loop,), "gap"), start, lattice_quads([block[::-1] for block in blocks]), places)
    optimum = optimise(mesh, iterations=_ITERATIONS, held=held)
    if not optimum.valid:
        raise NoValidGridError("cells in the gap stay folded")
    nodes = optimum.mesh.nodes.copy()
    for block in blocks[:4]:
        lines = nodes[block]
        steps = norms(np.diff(lines, axis=1))
        even = np.repeat(steps.mean(axis=1)[:, None], steps.shape[1], axis=1)
        nodes[block[:, 1:-1]] = resampled(lines, steps, with_first(even, np.minimum(first, even[:, 0])))[
            :, 1:-1
        ]
    return GapFill(order, Layout(mesh.with_nodes(nodes), tuple(blocks)))


def _first_guess(sides: Sequence[Floats], first: float, growth: float) -> tuple[Floats, list[Indices]]:
    """Return nodes (n, 2), those of the outline first, and the blocks of their numbers."""
    low, high = sides[0], sides[2][::-1]
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    width = norms(half)
    along = np.concatenate([[0.0], np.cumsum(norms(np.diff(middle, axis=0)))])
    part = along / along[-1]
    at = along + _INSET * (width[0] * power(1.0 - part, _POWER) - width[-1] * power(part, _POWER))
    across = np.linspace(-1.0, 1.0, len(sides[1]))[None, :, None]
    centre, reach = cubic_spline(middle, along, at), cubic_spline(half, along, at)
    core = centre[:, None] + (1.0 - _INSET) * across * reach[:, None]
    rows = max(_FEWEST_ROWS, cells_for_growth(first, _INSET * float(width.max()), growth) + 1)
    inner = [core[:, 0], core[-1], core[::-1, -1], core[0, ::-1]]
    t = np.linspace(0.0, 1.0, rows + 1)[:, None]
    ring = [a[:, None] + t * (b - a)[:, None] for a, b in zip(sides, inner, strict=True)]
    return _numbered(ring, core)


def _numbered(ring: Sequence[Floats], core: Floats) -> tuple[Floats, list[Indices]]:
    """Return the nodes (n, 2) of ring blocks and core, shared ones once, and the blocks of their numbers."""
    counts = np.cumsum([0, *(len(block) - 1 for block in ring)])
    rows = ring[0].shape[1]
    points, number = [np.concatenate([block[:-1, 0] for block in ring]), core.reshape(-1, 2)], int(counts[-1])
    own = number + np.arange(core[..., 0].size).reshape(core.shape[:2])
    number += own.size
    inner = [own[:, 0], own[-1], own[::-1, -1], own[0, ::-1]]
    diagonals = []
    for block in ring:
        diagonals.append(number + np.arange(rows - 2))
        points.append(block[0, 1:-1])
        number += rows - 2
    blocks = []
    for k, block in enumerate(ring):
        ids = np.empty(block.shape[:2], dtype=np.intp)
        ids[:, 0] = np.append(np.arange(counts[k], counts[k + 1]), counts[(k + 1) % 4 if k < 3 else 0])
        ids[:, -1] = inner[k]
        ids[0, 1:-1], ids[-1, 1:-1] = diagonals[k], diagonals[(k + 1) % 4]
        inside = ids[1:-1, 1:-1].shape
        ids[1:-1, 1:-1] = number + np.arange(inside[0] * inside[1]).reshape(inside)
        number += inside[0] * inside[1]
        points.append(block[1:-1, 1:-1].reshape(-1, 2))
        blocks.append(ids)
    return np.concatenate(points), [*blocks, own]
