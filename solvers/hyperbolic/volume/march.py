"""Volumes marched from surfaces of many patches, for boundary layers; the height of first cells is met exactly.

::

    surface --graph--> march --> levels --move along lines--> first cells exact --test--> grid
                         ^                                                         |
                         +--------------- other smoothing, smaller steps ----------+

The equations stand in ``kernels/surfaces/step.c``; `meshonet.solvers.hyperbolic.volume.settings` has what is tried
while cells are folded.
"""

from __future__ import annotations

import time
from typing import NamedTuple

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import BadCell, NoValidGridError
from meshonet.geometry.polygon.corners import Indices
from meshonet.geometry.surface.planes import Plane
from meshonet.geometry.surface.surface import Surface
from meshonet.geometry.threads import thread_count
from meshonet.kernels._native import find_folds, respace_lines, surface_march
from meshonet.solvers.hyperbolic.volume.blocks import volume_grid
from meshonet.solvers.hyperbolic.volume.graph import MarchGraph, march_graph
from meshonet.solvers.hyperbolic.volume.settings import ATTEMPTS, Smoothing, VolumeMarch
from meshonet.solvers.hyperbolic.volume.symmetry import (
    free_edges_note,
    in_planes,
    planes_note,
    symmetry_planes,
)
from meshonet.solvers.solution import Solution

FADE = 12.0  # cells over which what first cells needed fades away along a line
SWEEPS = 10  # of the smoothing of steps along lines
_WORST = 10


class _Volume(NamedTuple):
    """Lines (3, n, levels) of a march, how far it came, and what is worst above each face of the surface."""

    lines: Floats
    made: int
    corner: Floats
    level: Indices
    folded: int


def march_surface(surface: Surface, settings: VolumeMarch) -> Solution:
    """Return the volume between a surface and a far field, a block a patch.

    i and j of a block are those of its patch, k goes from the wall (``bottom``) to the far field (``top``).
    Sides in planes of symmetry are patches ``symmetry``, free ones ``free``; all others are connected. First
    cells are as high as asked, along every line.

    Chan and Steger, Appl. Math. Comput. 51 (1992) 181; what differs from it is in ``kernels/surfaces/step.c``.

    Raises InputError: settings that no march can meet; NoValidGridError with the worst cells: cells stay folded,
    by their corners or a Bezier coefficient of their Jacobian.
    """
    begun = time.perf_counter()
    planes, inside = symmetry_planes(surface, settings.symmetry)
    nodes = in_planes(surface, planes, inside)
    steps = settings.steps(surface.size)
    best: _Volume | None = None
    tries = 0
    for tries, smoothing in enumerate(ATTEMPTS, start=1):
        graph = march_graph(surface, planes, inside, smoothing.splay)
        volume = _marched(surface, graph, nodes, steps, smoothing)
        if best is None or (volume.made, -volume.folded) > (best.made, -best.folded):
            best = volume
        if volume.made == len(steps) and not volume.folded:
            break
    else:
        raise _refusal(surface, best, len(steps))
    _keep_planes(volume.lines, surface, planes, inside)
    grid = volume_grid(surface, volume.lines, inside.any(axis=0))
    notes = [*surface.notes, planes_note(planes, settings.symmetry), free_edges_note(surface, inside)]
    if tries > 1:
        notes.append(f"{tries} marches were made: others left folded cells")
    return Solution(
        grid,
        "hyperbolic",
        seconds={"grid": time.perf_counter() - begun},
        notes=tuple(note for note in notes if note),
        first_cells={"bottom": settings.first_cell},
    )


def _marched(
    surface: Surface, graph: MarchGraph, nodes: Floats, steps: Floats, smoothing: Smoothing
) -> _Volume:
    """March as far as it goes, move nodes along their lines, and test the cells."""
    threads = thread_count()
    levels = np.empty((len(steps) + 1, 3, len(nodes)))
    levels[0] = nodes[graph.order].T
    numbers = smoothing.numbers(0.5 * surface.size)
    made, _, _ = surface_march(levels, np.cumsum(steps), graph, numbers, threads)
    levels, steps = levels[: made + 1], steps[:made]
    lines = np.empty((3, len(nodes), made + 1))
    if made > 1 and np.isfinite(levels[-1]).all():
        fade = np.exp(-np.arange(made) / FADE)
        respace_lines(levels, steps, fade, graph.order, SWEEPS, lines, threads)
    else:
        lines[:, graph.order] = np.moveaxis(levels, 0, -1)
    if made == 0:
        none = np.zeros(len(surface.quads))
        return _Volume(lines, 0, none, none.astype(np.intp), 0)
    corner, _, level, folded, doubtful = find_folds(lines, surface.quads, threads)
    return _Volume(lines, made, corner, level, int(np.maximum(folded, doubtful).sum()))


def _keep_planes(lines: Floats, surface: Surface, planes: tuple[Plane, ...], inside: Indices) -> None:
    """Put what rounding moved out of planes of symmetry back, in place."""
    edges = surface.open_edges
    for plane, flags in zip(planes, inside, strict=True):
        lines[plane.axis, edges[flags]] = plane.value


def _refusal(surface: Surface, volume: _Volume | None, cells: int) -> NoValidGridError:
    assert volume is not None
    if volume.made < cells:
        problem = f"the march stops after {volume.made} of {cells} cells from the wall"
    else:
        problem = f"{volume.folded} of {cells * len(volume.corner)} cells are folded"
    remedy = f"after {len(ATTEMPTS)} tries with other smoothing; give a nearer {{far_field}}, or smoother patches"
    return NoValidGridError(f"{problem} {remedy}", _worst(surface, volume))


def _worst(surface: Surface, volume: _Volume) -> list[BadCell]:
    """Return the worst cells, one of a column."""
    cells = []
    first = np.cumsum([0, *((k.shape[0] - 1) * (k.shape[1] - 1) for k in surface.lattices)])
    for quad in np.argsort(volume.corner, kind="stable")[:_WORST].tolist():
        patch = int(np.searchsorted(first, quad, side="right")) - 1
        i, j = divmod(quad - int(first[patch]), surface.lattices[patch].shape[1] - 1)
        k = int(volume.level[quad])
        centre = volume.lines[:, surface.quads[quad], k : k + 2].mean(axis=(1, 2))
        cells.append(BadCell(i, j, float(centre[0]), float(centre[1]), patch, k, float(centre[2])))
    return cells
