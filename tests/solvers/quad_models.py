"""A quad model of small random weights, for tests that need a file and no quality."""

from pathlib import Path

import numpy as np

from meshonet.geometry.arrays import Topology
from meshonet.solvers.neural.model_file import QUAD, write_model
from meshonet.solvers.neural.quad.encoding import HEADS
from meshonet.solvers.neural.quad.network import shapes

WIDTHS, BLOCKS = (1, 2, 2), (0, 1, 1)


def random_model(path: Path, size: float = 0.05, topology: Topology = "quad") -> Path:
    """Write a model whose answers are smooth and of about this size, and return its path."""
    rng = np.random.default_rng(0)
    weights = {
        name: rng.normal(size=shape) * (1.0 / np.prod(shape[1:])) ** 0.5
        for name, shape in shapes(WIDTHS, BLOCKS, len(HEADS)).items()
    }
    weights["project"] *= size
    arrays = {name: array.astype(np.float32) for name, array in weights.items()}
    write_model(path, QUAD, arrays, name="random", topology=topology, recipe={}, figures={})
    return path
