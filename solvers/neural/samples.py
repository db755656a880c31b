"""Grids of one size and topology on which an operator is trained or tested."""

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats, Topology
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError


@dataclass(frozen=True, eq=False)
class Samples:
    """Solved grids of the same size and topology, with names and splits (training or test)."""

    nodes: Floats  # (n, ni, nj, 2), any unit of length
    topology: Topology  # ``quad`` or ``o``
    names: tuple[str, ...]  # (n,) of the shapes
    splits: tuple[str, ...]  # (n,) ``train``, ``test`` or nothing
    parameters: Floats  # (n,) of their family, NaN where there is none

    def __len__(self) -> int:
        return len(self.nodes)

    @property
    def ni(self) -> int:
        """Nodes along xi."""
        return int(self.nodes.shape[1])

    @property
    def nj(self) -> int:
        """Nodes along eta."""
        return int(self.nodes.shape[2])

    def boundaries(self) -> list[Boundary]:
        """Return the boundary of every grid."""
        return [edges(nodes, self.topology, name) for nodes, name in zip(self.nodes, self.names, strict=True)]

    def pick(self, rows: Iterable[int]) -> "Samples":
        """Return the samples with indices `rows`."""
        chosen = np.fromiter(rows, dtype=np.intp)
        names, splits = (tuple(have[k] for k in chosen) for have in (self.names, self.splits))
        return Samples(self.nodes[chosen], self.topology, names, splits, self.parameters[chosen])

    def where(self, split: str) -> NDArray[np.intp]:
        """Return the indices of the samples in a split; samples without a split belong to ``train``."""
        return np.array([k for k, own in enumerate(self.splits) if (own or "train") == split], dtype=np.intp)

    def fingerprint(self) -> str:
        """Return a hash of nodes and splits."""
        digest = hashlib.sha256(np.ascontiguousarray(self.nodes).tobytes())
        digest.update("/".join(self.splits).encode())
        return digest.hexdigest()[:16]


def edges(nodes: Floats, topology: Topology, name: str = "") -> Boundary:
    """Return the boundary of nodes (ni, nj, 2)."""
    return Boundary(nodes[:, 0], nodes[:, -1], nodes[0], nodes[-1], topology, name=name)


def gathered(grids: Iterable[Grid]) -> Samples:
    """Return `grids` as samples. Raises InputError: no grid, unequal sizes or topologies, C grids."""
    rows: list[Floats] = []
    facts: list[tuple[str, str, float]] = []
    first: Grid | None = None
    for grid in grids:
        first = first or grid
        if (grid.nodes.shape, grid.topology) != (first.nodes.shape, first.topology):
            sizes = [f"{g.ni}x{g.nj} {g.topology}" for g in (grid, first)]
            problem = f"{grid.name or 'a grid'} is {sizes[0]} and the first is {sizes[1]}"
            raise InputError(problem, "train on grids of one size and topology")
        if grid.topology == "c":
            raise InputError("a C grid among the training grids", "give quad or O grids")
        values = [value for _, value in grid.origin.parameters]
        rows.append(np.array(grid.nodes))
        facts.append((grid.name, grid.origin.split, values[0] if values else float("nan")))
    if first is None:
        raise InputError("no grid to train on", "give a dataset of grids: meshonet solve-pde IN -o OUT.h5")
    names, splits, parameters = zip(*facts, strict=True)
    return Samples(np.array(rows), first.topology, names, splits, np.array(parameters))
