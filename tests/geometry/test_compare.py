"""Distances between grids, against figures known by hand."""

import numpy as np
import pytest

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.compare import compare


def lattice(ni: int, nj: int) -> np.ndarray:
    return np.stack(
        np.meshgrid(np.arange(ni, dtype=float), np.arange(nj, dtype=float), indexing="ij"), axis=-1
    )


def test_a_grid_does_not_differ_from_itself() -> None:
    difference = compare(Grid.from_nodes(lattice(4, 5)), Grid.from_nodes(lattice(4, 5)))
    assert (difference.max, difference.mean, difference.relative_l2) == (0, 0, 0)
    assert (difference.near_wall, difference.boundary) == (0, 0)


def test_one_moved_node_is_found() -> None:
    moved = lattice(3, 3)
    moved[1, 2] += [0.3, 0.4]
    difference = compare(Grid.from_nodes(moved), Grid.from_nodes(lattice(3, 3)))
    assert difference.max == pytest.approx(0.5)
    assert difference.mean == pytest.approx(0.5 / 9)
    assert difference.at == (1, 2)
    assert difference.relative_l2 == pytest.approx(0.5 / np.sqrt(12))  # 12: squares about the centre


def test_the_relative_difference_does_not_depend_on_place_or_unit() -> None:
    moved = lattice(3, 3)
    moved[1, 1] += [0.3, 0.4]
    here = compare(Grid.from_nodes(moved), Grid.from_nodes(lattice(3, 3))).relative_l2
    there = compare(
        Grid.from_nodes(moved * 1e3 + 7e3), Grid.from_nodes(lattice(3, 3) * 1e3 + 7e3)
    ).relative_l2
    assert there == pytest.approx(here, rel=1e-12)


def test_grids_of_other_sizes_are_refused() -> None:
    with pytest.raises(InputError, match="3x3 nodes are not comparable with 3x4; compare grids of one size"):
        compare(Grid.from_nodes(lattice(3, 3)), Grid.from_nodes(lattice(3, 4)))


def test_near_the_wall_is_the_first_tenth_of_the_rows() -> None:
    moved = lattice(5, 30)
    moved[:, 2:4] += [0.3, 0.4]  # the last of these rows, and one that is none of them
    difference = compare(Grid.from_nodes(moved), Grid.from_nodes(lattice(5, 30)))
    spread = np.sqrt((np.arange(5.0).var()) + np.arange(30.0).var())
    assert difference.near_wall == pytest.approx(0.5 / spread / np.sqrt(3))
    assert difference.relative_l2 == pytest.approx(0.5 / spread / np.sqrt(15))
    further = lattice(5, 30)
    further[:, 3:] += [0.3, 0.4]
    assert compare(Grid.from_nodes(further), Grid.from_nodes(lattice(5, 30))).near_wall == 0
    assert (
        compare(Grid.from_nodes(lattice(5, 4) + 1), Grid.from_nodes(lattice(5, 4))).near_wall > 0
    )  # one row at least


@pytest.mark.parametrize(("node", "on_it"), [((0, 2), True), ((4, 1), True), ((2, 0), True), ((1, 1), False)])
def test_the_boundary_has_a_distance_of_its_own(node: tuple[int, int], on_it: bool) -> None:
    moved = lattice(5, 4)
    moved[node] += [0.03, 0.04]
    assert compare(Grid.from_nodes(moved), Grid.from_nodes(lattice(5, 4))).boundary == pytest.approx(
        0.05 if on_it else 0.0
    )


def test_the_cut_of_an_o_grid_is_no_boundary() -> None:
    angle = -2 * np.pi * np.arange(9) / 8
    ring = np.stack([np.outer(f(angle), np.linspace(1, 2, 5)) for f in (np.cos, np.sin)], axis=-1)
    ring[-1] = ring[0]
    moved = ring.copy()
    moved[[0, -1], 1:-1] += 0.05
    assert compare(Grid.from_nodes(moved, "o"), Grid.from_nodes(ring, "o")).boundary == 0.0
    moved[3, 0] += 0.03
    assert compare(Grid.from_nodes(moved, "o"), Grid.from_nodes(ring, "o")).boundary == pytest.approx(
        0.03 * 2**0.5
    )
