"""Percentiles of large grids: those of numpy over all cells, to the last bit."""

import numpy as np
import pytest

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality import measure as quality
from meshonet.geometry.quality.measure import measure, per_cell
from meshonet.geometry.quality.metrics import NAMES


def lattice(ni: int, nj: int) -> np.ndarray:
    return np.stack(np.meshgrid(np.linspace(0, 1, ni), np.linspace(0, 1, nj), indexing="ij"), axis=-1)


def shaken(ni: int, nj: int, amount: float) -> Grid:
    step = np.array([1 / (ni - 1), 1 / (nj - 1)])
    return Grid.from_nodes(
        lattice(ni, nj) + step * np.random.default_rng(3).uniform(-amount, amount, (ni, nj, 2))
    )


def ring(ni: int, nj: int) -> Grid:
    """An ellipse's layers, the first cells flat: distributions with long tails."""
    turn = np.linspace(0, -2 * np.pi, ni)[:, None]
    radius = 1 + np.geomspace(1e-6, 10, nj)[None, :]
    nodes = np.stack([radius * np.cos(turn), (radius - 0.8) * np.sin(turn)], axis=-1)
    nodes[-1] = nodes[0]
    return Grid.from_nodes(nodes, "o")


def folded() -> Grid:
    nodes = lattice(300, 280)
    nodes[100:140, 100:140] = nodes[139:99:-1, 100:140]
    return Grid.from_nodes(nodes)


GRIDS = {
    "shaken": lambda: shaken(310, 290, 0.4),
    "smooth": lambda: ring(400, 220),
    "thin": lambda: ring(20001, 5),
    "of one value": lambda: Grid.from_nodes(lattice(257, 257)),
    "folded": folded,
}


@pytest.mark.slow
@pytest.mark.parametrize("name", GRIDS)
def test_they_are_those_of_all_cells_sorted(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    grid = GRIDS[name]()
    together = measure(grid, percentiles=True)
    monkeypatch.setattr(quality, "FEW", 100)
    one_by_one = measure(grid, percentiles=True)
    for metric in NAMES:
        low, high = np.percentile(per_cell(grid, metric), [1, 99])
        for result in (together, one_by_one):
            assert (result[metric].p01, result[metric].p99) == (low, high), metric
