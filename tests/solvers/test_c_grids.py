"""C boundaries in the methods that take any: valid grids, wall, wake and far field met bitwise."""

from collections.abc import Callable

import numpy as np
import pytest
from winslow_reference import residual

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.measure import count_folded
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.elliptic.solve import solve
from meshonet.solvers.pipeline.coarse import solve_coarse

METHODS: dict[str, Callable[[Boundary], Grid]] = {
    "tfi": tfi,
    "winslow": lambda boundary: solve(boundary).grid,
    "winslow, coarse": lambda boundary: solve_coarse(boundary, solve, 33, smooth=True).grid,
}


@pytest.mark.parametrize("name", METHODS)
@pytest.mark.parametrize("section", ["0012", "4415"])
def test_c_grids_are_valid_and_their_edges_are_those_given(name: str, section: str) -> None:
    boundary = naca(section).boundary(Sampling(150, 60, "c"))
    grid = METHODS[name](boundary)
    assert (grid.topology, grid.patches) == ("c", boundary.patches)
    assert count_folded(grid.nodes) == 0
    for result, given in (
        (grid.nodes[:, 0], boundary.south),
        (grid.nodes[:, -1], boundary.north),
        (grid.nodes[0], boundary.west),
        (grid.nodes[-1], boundary.east),
    ):
        np.testing.assert_array_equal(result, given)


def test_winslow_solves_its_equations_inside_a_c() -> None:
    boundary = naca("0012").boundary(Sampling(120, 50, "c"))
    start, done = tfi(boundary).nodes, solve(boundary, tol=1e-9, max_cycles=60).grid.nodes
    assert np.abs(residual(done)).max() < 1e-7 * np.abs(residual(start)).max()
