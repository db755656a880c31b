"""Hard boundaries for every elliptic method: a valid grid, or an error that names the worst cells."""

from collections.abc import Callable

import numpy as np
import pytest
from solver_shapes import folded, horseshoe, l_shape, quad, segment, spike, wrench

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import NoValidGridError
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.elliptic.solve import solve, solve_thomas_middlecoff
from meshonet.solvers.elliptic.steger_sorenson import solve_steger_sorenson
from meshonet.solvers.layers.first_cells import Heights
from meshonet.solvers.layers.redistribute import spread, worst_first_cell
from meshonet.solvers.layers.slide_nodes import slide_walls
from meshonet.solvers.pipeline.fallback import guard
from meshonet.solvers.solution import Solution

METHODS: dict[str, Callable[..., Solution]] = {
    "winslow": solve,
    "thomas-middlecoff": solve_thomas_middlecoff,
    "steger-sorenson": solve_steger_sorenson,
}


def seamount(ni: int = 99, nj: int = 38) -> Boundary:
    """Depth over a Gaussian seamount as ocean modellers met it: 1000 m across, a = 0.5, b = 8."""
    x = np.linspace(0, 1000, ni)
    depth = 1000 * 0.5 * (1 - 0.5 * np.exp(-8 * (2 * x / 1000 - 1) ** 2))
    south, north = np.stack([x, -depth], axis=1), np.stack([x, 0 * x], axis=1)
    west, east = (segment(tuple(south[k]), tuple(north[k]), nj) for k in (0, -1))
    return quad(south, north, west, east, "seamount")


HARD = [seamount(), spike(101, 81), l_shape(101, 61), horseshoe(121, 41), wrench(121, 101)]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("boundary", HARD, ids=lambda b: b.name or "horseshoe")
def test_hard_boundaries_end_in_valid_grids(boundary: Boundary, method: str) -> None:
    grid = guard(METHODS[method](boundary), boundary).grid
    assert folded(grid.nodes) == 0
    np.testing.assert_array_equal(grid.nodes[:, 0], boundary.south)
    np.testing.assert_array_equal(grid.nodes[:, -1], boundary.north)


@pytest.mark.parametrize(
    "boundary", [seamount(), l_shape(101, 61), horseshoe(121, 41)], ids=["sea", "L", "U"]
)
@pytest.mark.parametrize("slide", [False, True])
def test_hard_boundaries_take_layers(boundary: Boundary, slide: bool) -> None:
    size = float(np.ptp(boundary.outline(), axis=0).max())
    moved, controls = slide_walls(boundary) if slide else (boundary, None)
    made = spread(solve(moved, controls=controls), moved, Heights(south=1e-5 * size, north=1e-5 * size))
    assert made.boundary is not None
    made = guard(made, moved)
    assert folded(made.grid.nodes) == 0
    assert worst_first_cell(made) < 1e-8


@pytest.mark.parametrize("method", METHODS)
def test_any_start_will_do(method: str) -> None:
    boundary = seamount(65, 33)
    rng = np.random.default_rng(6)
    start = tfi(boundary).nodes + rng.normal(0, 5.0, (65, 33, 2))
    result = METHODS[method](boundary, initial=Grid.from_nodes(start), tol=1e-7, max_cycles=60).grid.nodes
    assert folded(result) == 0


@pytest.mark.parametrize("method", METHODS)
def test_a_boundary_without_a_valid_grid_is_refused_with_its_cells(method: str) -> None:
    """A corner of a quad that opens by 180 degrees or more has no valid cell."""
    corner = (0.6, 0.6)  # beyond the line between its neighbours
    south, west = segment(corner, (1, 0), 21), segment(corner, (0, 1), 21)
    boundary = quad(south, segment((0, 1), (1, 1), 21), west, segment((1, 0), (1, 1), 21))
    with pytest.raises(NoValidGridError) as caught:
        guard(METHODS[method](boundary), boundary)
    assert caught.value.exit_code == 3
    assert caught.value.worst
    assert "opens by 180 degrees or more" in str(caught.value)
