"""Marched C grids: wall, wake and outlet."""

import numpy as np
import pytest
from march_shapes import deviation, first_cells

from meshonet import GridRequest, infer, make_grid, quality, read
from meshonet.geometry.arrays import Topology
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.quality.measure import count_folded
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.hyperbolic.march import hyperbolic


def c_boundary(name: str = "2412", ni: int = 160, nj: int = 80, **settings: object) -> Boundary:
    return naca(name).boundary(Sampling(ni, nj, "c", **settings))  # type: ignore[arg-type]


@pytest.mark.parametrize("name", ["0012", "4415", "23024"])
def test_a_c_grid_keeps_wall_and_wake_and_has_its_first_cells(name: str) -> None:
    boundary = c_boundary(name)
    grid = hyperbolic(boundary, wall_spacing=1e-5).grid
    assert count_folded(grid.nodes) == 0
    assert (grid.topology, grid.patches) == ("c", boundary.patches)
    np.testing.assert_array_equal(grid.nodes[:, 0], boundary.south)
    wall = next(part for part in grid.patches if part.name == "wall")
    height = first_cells(grid.nodes)
    np.testing.assert_allclose(height[wall.start : wall.stop + 1], 1e-5, rtol=1e-8)
    behind = np.hypot(*(boundary.south[: wall.start] - boundary.south[wall.start]).T)
    opened = 1e-5 * (1 + 5 * behind**2 / (behind + 0.3))
    opened += 3e-4 * behind**2 / ((behind + 1) * (1 + behind / 200))
    np.testing.assert_allclose(height[: wall.start], opened, rtol=1e-8)


def test_the_ends_of_a_c_grid_stay_on_the_outlet() -> None:
    boundary = c_boundary(far_field=12.0)
    nodes = hyperbolic(boundary, wall_spacing=1e-4).grid.nodes
    for end in (0, -1):
        np.testing.assert_allclose(nodes[end, :, 0], boundary.south[end, 0], rtol=1e-12)


def test_a_symmetric_section_has_a_symmetric_c_grid() -> None:
    nodes = hyperbolic(c_boundary("0012", ni=161), wall_spacing=1e-4).grid.nodes
    np.testing.assert_allclose(nodes, nodes[::-1] * [1.0, -1.0], atol=1e-9)


def test_c_grids_are_nearly_orthogonal_where_o_grids_of_sharp_edges_are_not() -> None:
    sharp = c_boundary("0012", 250, 100, te="wedge")
    assert deviation(hyperbolic(sharp, wall_spacing=1e-5).grid.nodes).max() < 5.0
    ring = naca("0012").boundary(Sampling(250, 100, "o", "curvature", te="wedge"))
    assert deviation(hyperbolic(ring, wall_spacing=1e-5).grid.nodes).max() > 60.0


@pytest.mark.parametrize("growth", [1.1, 1.2, 1.3])
def test_rows_that_growth_chooses_are_not_bent_by_its_limit(growth: float) -> None:
    boundary = c_boundary("0012-sharp", 200, far_field=100.0)
    nodes = hyperbolic(boundary, wall_spacing=6e-6, growth=growth, free_rows=True).grid.nodes
    assert deviation(nodes).max() < 20.0


@pytest.mark.parametrize("name", ["0012", "2412", "0012-sharp", "4415", "8412"])
def test_cells_of_a_c_grid_grow_slowly_along_every_row_and_line(name: str) -> None:
    nodes = hyperbolic(c_boundary(name, 250, 100, te="wedge"), wall_spacing=1e-5).grid.nodes
    for axis, most in ((0, 1.146), (1, 1.145)):
        step = np.diff(nodes, axis=axis)
        ratio = np.diff(np.log(np.hypot(step[..., 0], step[..., 1])), axis=axis)
        assert np.exp(np.abs(ratio).max()) < most


def test_lines_do_not_run_together_behind_the_edge_of_a_fine_c_grid() -> None:
    """Without the smoothing that grows with the height they do: cells become 50 degrees skew."""
    boundary = c_boundary("0012", 600, 150)
    assert deviation(hyperbolic(boundary, wall_spacing=1e-5).grid.nodes).max() < 10.0


def test_a_wake_of_any_direction_ends_on_a_straight_outlet() -> None:
    body = naca("0012").wedged()
    turn = np.array([[0.5, np.sqrt(0.75)], [-np.sqrt(0.75), 0.5]])
    plain = hyperbolic(body.boundary(Sampling(140, 60, "c")), wall_spacing=1e-4).grid.nodes
    turned = Airfoil(body.curve.points @ turn).boundary(Sampling(140, 60, "c"))
    result = hyperbolic(turned, wall_spacing=1e-4).grid.nodes
    np.testing.assert_allclose(result, plain @ turn, atol=1e-6)


@pytest.mark.parametrize(("ni", "nj"), [(401, 105), (801, 209)])
@pytest.mark.parametrize("far", [15.0, 50.0])
@pytest.mark.parametrize("base", [None, 0.005])
def test_long_cells_at_the_end_of_a_wake_are_orthogonal_for_flow_solvers(
    ni: int, nj: int, far: float, base: float | None
) -> None:
    """Lines between middles of cells and normals of faces: they were at up to 75 degrees, behind bases 89."""
    opened = {} if base is None else {"base": base}
    grid = infer("naca:2412-sharp", res=(ni, nj), topology="c", far_field=far, first_cell=6e-6, **opened)
    report = quality(grid, profile="openfoam")
    figures = {result.check.figure: result.figure.value for result in report.profile.results}
    assert figures["non_orthogonality"] < (25.0 if base is None else 65.0)
    assert figures["box_ratio"] < 3000.0


@pytest.mark.parametrize("first", [0.003, 0.01, 0.03, 0.1])
@pytest.mark.parametrize("growth", [None, 1.15])
def test_first_cells_longer_than_the_smallest_wall_cell_leave_no_kink_behind_the_edge(
    first: float, growth: float | None
) -> None:
    """Marched with these first cells, lines from the trailing edge converge at up to 180 degrees."""
    sampling = Sampling(topology="c")
    result = make_grid(read("naca:2412"), GridRequest(sampling=sampling, first_cell=first, growth=growth))
    assert result.quality["max_angle"].max < 109.0
    nodes = result.grid.nodes
    assert np.hypot(*np.moveaxis(nodes[:, 1] - nodes[:, 0], -1, 0)) == pytest.approx(first, rel=1e-8)
    (note,) = (note for note in result.notes if "first" in note)
    assert note.startswith(f"first cells {first:g} off south")


@pytest.mark.parametrize(("topology", "largest"), [("c", 130.0), ("o", 160.0)])
def test_high_first_cells_are_exact_in_refined_grids_too(topology: Topology, largest: float) -> None:
    """Marched with these first cells, lines fold."""
    result = make_grid(read("naca:2412"), GridRequest(Sampling(topology=topology), first_cell=0.01, refine=1))
    nodes = result.grid.nodes
    assert np.linalg.norm(nodes[:, 1] - nodes[:, 0], axis=-1) == pytest.approx(0.01, rel=1e-8)
    assert result.quality["max_angle"].max < largest


def test_rows_of_coarse_o_grids_are_marched_unless_they_grow_abruptly() -> None:
    """Marched lines are closer to right angles: here 95 degrees on average instead of 103."""
    sampling = Sampling(120, 60, topology="o")
    result = make_grid(read("naca:0012"), GridRequest(sampling, first_cell=0.007))
    assert result.quality["max_angle"].mean < 96.0
    cells = np.linalg.norm(np.diff(result.grid.nodes, axis=1), axis=-1)
    assert (np.abs(np.log(cells[:, 1:] / cells[:, :-1])) < np.log(1.3)).all()


@pytest.mark.parametrize("first", [0.01, 0.05])
def test_an_o_grid_with_high_first_cells_grows_evenly(first: float) -> None:
    cells = np.linalg.norm(np.diff(infer("naca:0012", first_cell=first).nodes, axis=1), axis=-1)
    assert cells[:, 0] == pytest.approx(first, rel=1e-8)
    assert (cells[:, 1:] < 1.06 * cells[:, :-1]).all()
