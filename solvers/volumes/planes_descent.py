"""Minimisation of the functional over the inner nodes of one block."""

from itertools import product

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.volume.hex_mesh import HexMesh
from meshonet.solvers.energy.hex_functional import HexWeights
from meshonet.solvers.energy.hex_tables import tables_of
from meshonet.solvers.energy.hexes import HexProblem, Slides, descent_of


class PlanesDescent(HexProblem):
    """Minimisation of a grid functional over the inner nodes of a volume `planes` (3, ni, nj, nk), in place.

    In each direction, the target length of cells is their mean length on the volume's four edges in this
    direction. With `cubes`, all directions have the same target length.
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
        """Run at most `most` iterations; see `HexProblem.run`."""
        smallest_and_value = super().run(weights, most, epsilon)
        self.planes[...] = self.nodes.T.reshape(self.planes.shape)
        return smallest_and_value


def inverse_lengths(planes: Floats) -> tuple[float, float, float]:
    """Return, for each direction, 1 / the mean cell length along the edges of a volume (3, ni, nj, nk)."""
    lengths = []
    for axis in range(3):
        rows = np.moveaxis(planes, axis + 1, -1)
        edges = np.stack([rows[:, a, b] for a, b in product((0, -1), (0, -1))])
        lengths.append(float(np.sqrt((np.diff(edges, axis=-1) ** 2).sum(axis=1).mean())))
    return 1.0 / lengths[0], 1.0 / lengths[1], 1.0 / lengths[2]
