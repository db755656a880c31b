"""Every k-th node of grids and boundaries."""

import numpy as np
import pytest

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.extrude import extruded
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.blocks.transform import coarser_boundary, coarser_grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.outline import Outline
from meshonet.geometry.spacing.laws import Spacing
from meshonet.geometry.spacing.sampling import Sampling


def lattice(ni: int, nj: int) -> np.ndarray:
    return np.stack(np.meshgrid(np.arange(float(ni)), np.arange(float(nj)), indexing="ij"), axis=-1)


def test_the_kept_nodes_are_bitwise_the_same() -> None:
    nodes = lattice(13, 7)
    nodes[1:-1, 1:-1] += np.random.default_rng(1).uniform(-0.2, 0.2, (11, 5, 2))
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


def flatback() -> Airfoil:
    """A section with a base of 4 % of the chord, square to it."""
    half = 0.02 + 0.1 * np.sin(np.pi * np.linspace(0.0, 1.0, 60) ** 0.5) * np.linspace(1.0, 0.2, 60)
    half[0] = 0.0
    x = np.linspace(0.0, 1.0, 60) ** 2
    upper = np.stack([x, half], axis=1)
    return Airfoil(np.concatenate([upper[::-1], upper[1:] * [1.0, -1.0]]), "flatback")


@pytest.mark.parametrize("spacing", ["auto", "curvature", "tanh"])
@pytest.mark.parametrize("k", [2, 4, 8])
def test_corners_of_a_base_survive_every_level(spacing: Spacing, k: int) -> None:
    body = flatback()
    fine = body.boundary(Sampling(401, 65, "o", spacing))
    coarse = coarser_boundary(fine, k).south
    corners = body.curve.points[[1, -1]]
    for corner in corners:
        assert np.hypot(*(coarse - corner).T).min() < 1e-12


def test_what_would_cut_a_corner_is_refused_with_the_largest_number_that_does_not() -> None:
    boundary = flatback().boundary(Sampling(401, 65, "o", base_nodes=13))
    nodes = np.linspace(boundary.south, boundary.north, 65, axis=1)
    grid = Grid.from_nodes(nodes, "o")
    with pytest.raises(
        InputError, match=r"a corner of south at .*, node 6, would be cut: .* all corners is 2;"
    ):
        coarser_grid(grid, 4)
    assert coarser_grid(grid, 2).ni == 201


def test_corners_asked_for_at_multiples_stand_there() -> None:
    star = np.array([[0, 0], [4, 0], [4, 2], [2.3, 2], [2, 1.2], [1.1, 2], [0, 2]], dtype=float)
    for sampling in (Sampling(129, 33, "quad", refined=4), Sampling(257, 33, "o", "tanh", refined=8)):
        outline = Outline(star, corners=(0, 1, 2, 6) if sampling.topology == "quad" else None)
        boundary = outline.boundary(sampling)
        coarse = coarser_boundary(boundary, sampling.refined)
        for corner in star:
            assert np.hypot(*(coarse.outline() - corner).T).min() < 1e-9


def test_edges_of_walls_in_space_are_kept_too() -> None:
    boundary = flatback().boundary(Sampling(65, 9, "o", base_nodes=13))
    plane = Grid.from_nodes(np.linspace(boundary.south, boundary.north, 9, axis=1), "o")
    grid = extruded(plane, np.linspace(0.0, 1.0, 9).tolist())
    with pytest.raises(InputError, match=r"a corner of south at \(1, -0.02, 0\), node 6, would be cut"):
        coarser_grid(grid, 4)
    assert coarser_grid(grid, 2).blocks[0].counts == (33, 5, 5)
