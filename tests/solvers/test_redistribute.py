"""Layers at the walls of any grid: heights, growth, kinks, lines kept."""

import numpy as np
import pytest
from solver_shapes import arch, bump, folded, hexagon, hole, horseshoe, l_shape, naca, quad, seamount, segment

from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError
from meshonet.kernels._native import layer_lines, layer_steps
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.elliptic.solve import solve
from meshonet.solvers.layers.first_cells import Heights, cells_needed, edge_in_layers, layer_ratio
from meshonet.solvers.layers.redistribute import spread, worst_first_cell
from meshonet.solvers.pipeline.fallback import guard
from meshonet.solvers.solution import Solution


def first_cells(nodes: Floats, side: str) -> Floats:
    rows = nodes if side in ("west", "east") else np.swapaxes(nodes, 0, 1)
    one, two = (rows[0], rows[1]) if side in ("west", "south") else (rows[-1], rows[-2])
    return np.linalg.norm(two - one, axis=1)


@pytest.mark.parametrize(
    ("first", "last"), [(1e-5, 1e-5), (1e-3, 1e-6), (2e-2, 0.0), (0.0, 1e-4), (0.05, 0.04)]
)
@pytest.mark.parametrize("constant", [1, 4])
def test_steps_grow_by_one_ratio_from_each_end_and_fill_the_length(
    first: float, last: float, constant: int
) -> None:
    steps = np.empty(60)
    largest = layer_steps(steps, 2.0, first, last, constant)
    assert steps.sum() == pytest.approx(2.0, rel=1e-12)
    if first:
        np.testing.assert_allclose(steps[:constant], first, rtol=1e-14)
    if last:
        np.testing.assert_allclose(steps[-constant:], last, rtol=1e-14)
    ratios = np.log(steps[1:] / steps[:-1])
    assert np.exp(np.abs(ratios).max()) <= largest * (1 + 1e-12)
    inner = ratios[constant - 1 if first else 0 : 60 - constant if last else None]
    assert len(np.unique(np.round(inner, 9))) <= (3 if first and last else 1)


def test_one_end_is_a_geometric_series() -> None:
    steps = np.empty(3)
    assert layer_steps(steps, 7.0, 1.0, 0.0, 1) == pytest.approx(2.0)
    np.testing.assert_allclose(steps, [1.0, 2.0, 4.0])


def test_what_does_not_fit_has_no_ratio() -> None:
    assert layer_ratio(4, 1.0, 0.6, 0.6, 1) == np.inf
    assert cells_needed(7.0, 1.0, 0.0, Heights(south=1.0, growth=2.0)) == 3


def test_straight_lines_get_exactly_the_law() -> None:
    x, y = np.meshgrid(np.arange(5.0), np.linspace(0, 1, 9), indexing="ij")
    out = np.empty((2, 5, 33))
    layer_lines(x, y, out[0], out[1], 1e-6, 1e-3, 2)
    steps = np.empty(32)
    layer_steps(steps, 1.0, 1e-6, 1e-3, 2)
    np.testing.assert_allclose(out[0], np.broadcast_to(np.arange(5.0)[:, None], (5, 33)), atol=1e-14)
    np.testing.assert_allclose(np.diff(out[1], axis=1), np.broadcast_to(steps, (5, 32)), rtol=1e-8)


def test_a_side_is_sampled_from_its_curve() -> None:
    angle = np.linspace(0, 1.5, 41)
    arc = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    nodes = edge_in_layers(arc, 61, 1e-4, 1e-5, Heights(south=1e-4, north=1e-5))
    np.testing.assert_allclose(np.hypot(*nodes.T), 1.0, atol=1e-7)
    np.testing.assert_allclose(np.hypot(*(nodes[1] - nodes[0])), 1e-4, rtol=1e-9)
    np.testing.assert_allclose(np.hypot(*(nodes[-1] - nodes[-2])), 1e-5, rtol=1e-9)
    assert np.array_equal(nodes[[0, -1]], arc[[0, -1]])


CASES = [
    Heights(south=1e-5),
    Heights(south=1e-5, north=1e-5),
    Heights(north=1e-3, constant=3),
    Heights(west=1e-4),
    Heights(south=1e-5, west=1e-3, east=1e-3),
    Heights(south=1e-4, north=1e-4, west=1e-4, east=1e-4),
]


@pytest.mark.parametrize("make", [arch, hexagon, bump, seamount, l_shape, horseshoe])
@pytest.mark.parametrize("heights", CASES, ids=str)
def test_every_first_cell_of_a_solved_grid_is_exact_and_none_folds(make, heights: Heights) -> None:  # type: ignore[no-untyped-def]
    boundary = make(101, 65)
    made = spread(solve(boundary), boundary, heights)
    nodes = made.grid.nodes
    assert folded(nodes) == 0
    for side in ("south", "north", "west", "east"):
        height = getattr(heights, side)
        if height:
            np.testing.assert_allclose(first_cells(nodes, side), height, rtol=1e-8)
    assert made.boundary is not None
    np.testing.assert_array_equal(made.boundary.west, nodes[0])
    assert worst_first_cell(made) < 1e-8
    if not (heights.west or heights.east):  # the walls keep their nodes, the rows theirs
        np.testing.assert_array_equal(nodes[:, 0], boundary.south)
        np.testing.assert_array_equal(nodes[:, -1], boundary.north)


@pytest.mark.parametrize("make", [naca, hole])
def test_a_ring_keeps_its_seam(make) -> None:  # type: ignore[no-untyped-def]
    boundary = make(121, 60)
    made = spread(solve(boundary), boundary, Heights(south=1e-5, constant=2))
    nodes = made.grid.nodes
    assert folded(nodes) == 0
    np.testing.assert_array_equal(nodes[0], nodes[-1])
    np.testing.assert_allclose(first_cells(nodes, "south"), 1e-5, rtol=1e-8)


def test_kinks_stay_nodes_when_rows_are_moved_along_walls() -> None:
    boundary = hexagon(101, 65)
    made = spread(solve(boundary), boundary, Heights(west=1e-4))
    for nodes, kink in ((made.grid.nodes[:, 0], (0.5, -0.5)), (made.grid.nodes[:, -1], (0.5, 1.5))):
        assert np.hypot(*(nodes - kink).T).min() < 1e-12


def test_interpolated_grids_take_layers_too() -> None:
    boundary = arch(41, 33)
    made = spread(Solution(tfi(boundary), "tfi"), boundary, Heights(south=1e-4))
    np.testing.assert_allclose(first_cells(made.grid.nodes, "south"), 1e-4, rtol=1e-8)


def test_rows_are_as_many_as_the_growth_needs() -> None:
    boundary = arch(41, 33)
    made = spread(solve(boundary), boundary, Heights(south=1e-5, north=1e-5, growth=1.2, free_rows=True))
    steps = np.linalg.norm(np.diff(made.grid.nodes, axis=1), axis=-1)
    ratios = steps[:, 1:] / steps[:, :-1]
    assert np.maximum(ratios, 1 / ratios).max() < 1.2005
    assert made.grid.nj == 1 + cells_needed(
        1.0015 * steps.sum(axis=1).max(), 1e-5, 1e-5, Heights(south=1e-5, growth=1.2)
    )


def test_folds_are_repaired_before_the_lines_are_used() -> None:
    boundary = arch(41, 41)
    nodes = solve(boundary).grid.nodes.copy(order="K")
    nodes[20, 20], nodes[20, 21] = nodes[20, 21].copy(), nodes[20, 20].copy()
    grid = boundary.grid(nodes)
    made = spread(guard(Solution(grid, "winslow"), boundary), boundary, Heights(south=1e-4))
    assert made.path == ("repair",)
    assert folded(made.grid.nodes) == 0


@pytest.mark.parametrize(
    ("heights", "message"),
    [
        ({"south": -1.0}, "a first cell of -1 off south; give a positive height"),
        ({"west": float("nan")}, "a first cell of nan off west"),
        ({"south": 1e-3, "constant": 0}, "0 constant layers; give at least 1"),
        ({"south": 1e-3, "growth": 0.9}, "a growth of 0.9; give the ratio"),
        ({"south": 0.7, "north": 0.7}, "first cells of 0.7 and 0.7 fill west, which is 1 long"),
        ({"south": 1e-3, "constant": 40}, "33 nodes off south are too few for layers; use at least 42"),
        (
            {"south": 1e-6, "growth": 1.1},
            "need cells that grow by 1.[0-9]*, more than 1.1; use [0-9]+",
        ),
    ],
)
def test_heights_that_do_not_fit_are_refused(heights: dict[str, float], message: str) -> None:
    boundary = arch(41, 33)
    with pytest.raises(InputError, match=message):
        spread(solve(boundary), boundary, Heights(**heights))  # type: ignore[arg-type]


def test_a_ring_has_one_wall() -> None:
    boundary = hole(41, 20)
    with pytest.raises(InputError, match="north, west or east in topology o; give that of its wall, south"):
        spread(solve(boundary), boundary, Heights(north=1e-3))


def test_rows_across_a_square_are_moved_exactly() -> None:
    square = quad(
        segment((0, 0), (1, 0), 33),
        segment((0, 1), (1, 1), 33),
        segment((0, 0), (0, 1), 9),
        segment((1, 0), (1, 1), 9),
    )
    nodes = spread(solve(square), square, Heights(west=1e-4, east=1e-3)).grid.nodes
    np.testing.assert_allclose(nodes[..., 0], np.broadcast_to(nodes[:, :1, 0], (33, 9)), atol=1e-12)
    np.testing.assert_allclose(nodes[..., 1], np.broadcast_to(np.linspace(0, 1, 9), (33, 9)), atol=1e-12)
