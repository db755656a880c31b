"""Marches out of concave edges: no folds, exact first cells, refusals that name angle and place."""

import numpy as np
import pytest
from surface_shapes import boxes, corner_quality, cube, dented, grid_of, room_corner, sphere, wedge, wing

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import NoValidGridError
from meshonet.geometry.quality.volumes import BEZIER, count_folded_solids
from meshonet.geometry.surface.hollows import hollows_of
from meshonet.geometry.surface.surface import surface_of
from meshonet.geometry.threads import limited_to
from meshonet.solvers.hyperbolic.volume.march import VolumeMarch, march_surface

L_SHAPE = {(0, 0, 0), (1, 0, 0), (0, 1, 0)}


def marched(patches: list[Floats], first: float, layers: int | None, far: float) -> Grid:
    return march_surface(surface_of(grid_of(patches)), VolumeMarch(first, layers, far)).grid


def folded(grid: Grid) -> int:
    return sum(count_folded_solids(block.nodes, BEZIER) for block in grid.blocks)


@pytest.mark.parametrize("degrees", [45.0, 60.0, 90.0, 120.0])
def test_the_angle_between_walls_is_that_of_the_concave_edge(degrees: float) -> None:
    surface = surface_of(grid_of(wedge(degrees)))
    hollows = hollows_of(surface)
    assert len(hollows.edges) == 6
    assert hollows.angles == pytest.approx(np.full(6, degrees))
    x, y = surface.nodes[:, 0], surface.nodes[:, 1]
    away = np.hypot(x, y)
    assert hollows.distance == pytest.approx(away + away[away > 0.0].min(), rel=1e-9)


@pytest.mark.parametrize("patches", [cube(8), sphere(8), dented(12), wing(), boxes({(0, 0, 0)})])
def test_convex_edges_and_smooth_hollows_are_no_concave_edges(patches: list[Floats]) -> None:
    hollows = hollows_of(surface_of(grid_of(patches)))
    assert len(hollows.edges) == 0
    assert hollows.sharpest() is None
    assert np.isinf(hollows.distance).all()


@pytest.mark.parametrize("first", [1e-3, 1e-5])
@pytest.mark.parametrize("degrees", [60.0, 75.0, 90.0, 120.0])
def test_walls_at_an_angle_are_marched_beyond_their_length(degrees: float, first: float) -> None:
    grid = marched(wedge(degrees), first, 49, 3.0)
    assert folded(grid) == 0
    for block in grid.blocks:
        step = np.linalg.norm(block.nodes[:, :, 1] - block.nodes[:, :, 0], axis=-1)
        assert step == pytest.approx(np.full(step.shape, first), rel=1e-9)
        assert np.linalg.norm(block.nodes[:, :, -1, :2], axis=-1).max() > 2.5


@pytest.mark.parametrize(("first", "least"), [(1e-3, 0.6), (1e-6, 0.15)])
def test_two_walls_at_a_right_angle_have_cells_of_even_corners(first: float, least: float) -> None:
    grid = marched(room_corner(15), first, 65, 2.5)
    assert folded(grid) == 0
    assert corner_quality(grid) > least


@pytest.mark.parametrize("cubes", [L_SHAPE, {*L_SHAPE, (0, 0, 1)}])
def test_a_closed_body_with_concave_edges_is_marched_to_the_far_field(
    cubes: set[tuple[int, int, int]],
) -> None:
    grid = marched(boxes(cubes), 1e-3, None, 10.0)
    assert folded(grid) == 0
    assert {patch.name for patch in grid.patches} == {"wall", "farfield"}
    for block in grid.blocks:
        steps = np.linalg.norm(np.diff(block.nodes, axis=2), axis=-1)
        assert steps[:, :, 0] == pytest.approx(np.full(steps.shape[:2], 1e-3), rel=1e-9)


def test_threads_do_not_change_a_bit_of_a_relaxed_march(eager_threads: None) -> None:
    grids = []
    for threads in (1, 3):
        with limited_to(threads):
            grids.append(marched(boxes(L_SHAPE, 6), 1e-2, 17, 0.5))
    for a, b in zip(grids[0].blocks, grids[1].blocks, strict=True):
        assert np.array_equal(a.nodes, b.nodes)


def test_an_acute_junction_is_refused_with_its_angle_and_place() -> None:
    with pytest.raises(NoValidGridError, match=r"walls meet at an angle of 15 degrees at patch 0, i=0, j=\d"):
        marched(wedge(15.0), 1e-3, 49, 3.0)


def test_the_junction_that_is_named_is_the_one_beside_the_folded_cells() -> None:
    surface = surface_of(grid_of(boxes({*L_SHAPE, (2, 0, 0), (3, 0, 0), (4, 0, 0), (4, 1, 0)})))
    hollows, (x, y, _) = hollows_of(surface), surface.nodes.T

    def named(x0: float, y0: float) -> tuple[float, float] | None:
        node = np.hypot(x - x0, y - y0).argmin()
        junction = hollows.nearest(surface, np.array([node]))
        return junction and (round(x[junction[1]], 6), round(y[junction[1]], 6))

    edges = surface.nodes[hollows.edges[:, 0], :2]
    left, right = edges[edges[:, 0].argmin()], edges[edges[:, 0].argmax()]
    assert left[0] < right[0]
    assert named(left[0] + 0.2, left[1]) == pytest.approx(tuple(left))
    assert named(right[0], right[1] + 0.2) == pytest.approx(tuple(right))
    assert named(x.max(), y.min()) is None
