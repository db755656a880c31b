"""Repairs the folded cells of a volume in windows around them, with fixed faces."""

from itertools import product

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.measure import folded_cells
from meshonet.geometry.quality.volumes import solid_metric
from meshonet.geometry.volume.hex_mesh import HexMesh
from meshonet.solvers.energy.clusters import Window, windows
from meshonet.solvers.energy.hex_functional import OPENING, OPTIMAL, UNFOLDING, HexWeights
from meshonet.solvers.energy.hex_tables import tables_of
from meshonet.solvers.energy.hexes import NEARLY, HexProblem, Slides, descent_of

MARGINS = 5, 8, 11, 14
"""Numbers of nodes around a group of folded cells in a window, for successive rounds."""
LARGEST_CELLS = 40_000  # of a window: two seconds of untangling
ROUNDS, ROUND = 20, 8
"""Largest number of rounds of untangling in a window, and iterations of each."""
FIRST, OPEN, LAST = 15, 8, 10
"""Iterations of the stages that improve the cells after untangling."""
ENOUGH = 0.02
"""Smallest Jacobian above which the complete functional is used in a window."""


def repair(planes: Floats) -> int:
    """Untangle cells of planes (3, ni, nj, nk) in place; return the number of folded cells left."""
    nodes = np.moveaxis(planes, 0, -1)
    bad = folded_cells(nodes)
    if min(planes.shape[1:]) < 3:
        return len(bad)
    for margin in MARGINS:
        if len(bad) == 0:
            break
        for window in windows(bad, margin, nodes.shape[:3], False, LARGEST_CELLS):
            _mend(nodes, window)
        bad = folded_cells(nodes)
    return len(bad)


def open_flat_cells(planes: Floats) -> None:
    """Open flat cells of planes (3, ni, nj, nk) in windows, in place."""
    nodes = np.moveaxis(planes, 0, -1)
    (scaled,) = solid_metric(Grid.from_nodes(nodes), "scaled_jacobian")
    for window in windows(np.argwhere(scaled < NEARLY), MARGINS[0], nodes.shape[:3], False, LARGEST_CELLS):
        _mend(nodes, window)


def _mend(nodes: Floats, window: Window) -> None:
    part = window.cut(nodes)
    if min(part.shape[:3]) > 2:
        _unfold(np.moveaxis(part, -1, 0))
        window.put(nodes, False, part)


def _unfold(part: Floats) -> None:
    """Untangle a window and open its cells, in place."""
    descent = PlanesDescent(part)
    if descent.unfold(descent.smallest(), ROUNDS, ROUND) <= 0.0:
        return
    descent.run(UNFOLDING, FIRST)
    if descent.run(OPENING[0], OPEN)[0] > ENOUGH:
        descent.run(OPTIMAL, LAST)


class PlanesDescent(HexProblem):
    """Minimisation over planes of nodes (3, ni, nj, nk), in place, at interior nodes.

    With `cubes`, edges of all directions have the same target length.
    """

    def __init__(self, planes: Floats, cubes: bool = False) -> None:
        counts = planes.shape[1:]
        self.planes, self.iterations, self.slides = planes, 0, Slides.none()
        self.nodes = np.ascontiguousarray(planes.reshape(3, -1).T)
        over = inverse_lengths(planes)
        over = (float(np.prod(over)) ** (1 / 3),) * 3 if cubes else over
        lattice = np.arange(len(self.nodes)).reshape(counts)
        self.moves = np.pad(np.ones([n - 2 for n in counts], dtype=bool), 1).ravel()
        self.mesh = HexMesh(self.nodes, (lattice,), ())
        lengths = np.broadcast_to(1.0 / np.array(over)[:, None, None, None], (3, *(n - 1 for n in counts)))
        edges = [np.broadcast_to(0.0, [n + (k == d) for k, n in enumerate(counts)]) for d in range(3)]
        tables = tables_of(self.mesh, self.moves, [(edges[0], edges[1], edges[2])], [lengths], turned=False)
        sizes = np.full(len(tables.free), max(over))
        slides = np.empty(0, dtype=np.intp), np.empty((0, 9))
        self.descent = descent_of(self.nodes, tables, sizes, self.mesh.cells, slides, over)

    def run(self, weights: HexWeights, most: int, epsilon: float = 0.0) -> tuple[float, float]:
        """Do at most `most` iterations; return the smallest Jacobian and the value of the functional."""
        smallest_and_value = super().run(weights, most, epsilon)
        self.planes[...] = self.nodes.T.reshape(self.planes.shape)
        return smallest_and_value


def inverse_lengths(planes: Floats) -> tuple[float, float, float]:
    """Return for each direction of `planes` (3, ni, nj, nk) 1 / mean step along the edges of the volume."""
    lengths = []
    for axis in range(3):
        rows = np.moveaxis(planes, axis + 1, -1)
        edges = np.stack([rows[:, a, b] for a, b in product((0, -1), (0, -1))])
        lengths.append(float(np.sqrt((np.diff(edges, axis=-1) ** 2).sum(axis=1).mean())))
    return 1.0 / lengths[0], 1.0 / lengths[1], 1.0 / lengths[2]
