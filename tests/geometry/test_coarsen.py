"""Every k-th node of grids and boundaries."""

import numpy as np
import pytest

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.blocks.transform import coarser_boundary, coarser_grid
from meshonet.geometry.errors import InputError


def lattice(ni: int, nj: int) -> np.ndarray:
    return np.stack(np.meshgrid(np.arange(float(ni)), np.arange(float(nj)), indexing="ij"), axis=-1)


def test_the_kept_nodes_are_bitwise_the_same() -> None:
    nodes = lattice(13, 7) + np.random.default_rng(1).uniform(-0.2, 0.2, (13, 7, 2))
    once = coarser_grid(Grid.from_nodes(nodes, name="a"), 3)
    np.testing.assert_array_equal(once.nodes, nodes[::3, ::3])
    assert (once.name, once.provenance["coarsened"]) == ("a", 3)
    twice = coarser_grid(once, 2)
    np.testing.assert_array_equal(twice.nodes, coarser_grid(Grid.from_nodes(nodes), 6).nodes)
    assert twice.provenance["coarsened"] == 6


def test_parts_keep_their_places() -> None:
    patches = (Patch("inlet", "west", 0, 6), Patch("step", "south", 4, 8), Patch("wall", "north", 0, 12))
    coarse = coarser_grid(Grid.from_nodes(lattice(13, 7), patches=patches), 2)
    assert coarse.patches == (
        Patch("inlet", "west", 0, 3),
        Patch("step", "south", 2, 4),
        Patch("wall", "north", 0, 6),
    )
    with pytest.raises(
        InputError, match="patch 'step' ends at node 4 of south, which every 3-th leaves out; make"
    ):
        coarser_grid(Grid.from_nodes(lattice(13, 7), patches=patches), 3)


def test_rings_stay_closed() -> None:
    turn = np.linspace(0, -2 * np.pi, 13)
    nodes = np.arange(1.0, 4.0)[None, :, None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1)[:, None]
    nodes[-1] = nodes[0]
    coarse = coarser_grid(Grid.from_nodes(nodes, "o"), 2)
    assert (coarse.ni, coarse.nj, coarse.topology) == (7, 2, "o")
    np.testing.assert_array_equal(coarse.nodes[0], coarse.nodes[-1])


def test_boundaries_are_those_of_their_grids() -> None:
    nodes = lattice(9, 5)
    boundary = Boundary(nodes[:, 0], nodes[:, -1], nodes[0], nodes[-1])
    coarse = coarser_boundary(boundary, 4)
    assert (coarse.ni, coarse.nj) == (3, 2)
    np.testing.assert_array_equal(coarse.south, nodes[::4, 0])
    np.testing.assert_array_equal(coarse.east, nodes[-1, ::4])


@pytest.mark.parametrize(
    ("ni", "nj", "k", "message"),
    [
        (13, 7, 4, "13x7 nodes are 12x6 cells, which 4 does not divide; use a number that divides 6, or make "
                   "the grid with 13x5 nodes, say"),
        (12, 7, 2, "12x7 nodes are 11x6 cells, which 2 does not divide; make the grid with 11x7 nodes, say"),
        (5, 5, 100, "use a number that divides 4, or make the grid with 101x101 nodes"),
        (5, 5, 0, "which 0 does not divide"),
    ],
)  # fmt: skip
def test_counts_that_do_not_divide_are_told_with_a_remedy(ni: int, nj: int, k: int, message: str) -> None:
    with pytest.raises(InputError, match=message):
        coarser_grid(Grid.from_nodes(lattice(ni, nj)), k)
