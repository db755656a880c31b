"""Quality metrics against Verdict (through VTK) and against shapes whose figures are known by hand."""

import numpy as np
import pytest
from block_grids import butterfly
from spatial_shapes import box

from meshonet.geometry.arrays import as_planar
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality import metrics
from meshonet.geometry.quality.measure import (
    count_folded,
    folded_cells,
    measure,
    per_cell,
    per_cell_of_blocks,
    worst_cells,
)
from meshonet.geometry.quality.metrics import NAMES, QUAD_METRICS, Metric


def cross(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    return u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]


VERDICT = {
    "max_angle": "QuadMaxAngle",
    "min_angle": "QuadMinAngle",
    "skewness": "QuadEquiangleSkew",
    "scaled_jacobian": "QuadScaledJacobian",
    "aspect_ratio": "QuadAspectRatio",
    "orthogonality": "QuadSkew",
}


def lattice(ni: int, nj: int) -> np.ndarray:
    return np.stack(np.meshgrid(np.linspace(0, 1, ni), np.linspace(0, 1, nj), indexing="ij"), axis=-1)


def shaken(ni: int = 23, nj: int = 17, amount: float = 0.3, seed: int = 3) -> Grid:
    """A lattice whose nodes are moved by up to `amount` of a cell: beyond 0.35 some cells are concave."""
    step = np.array([1 / (ni - 1), 1 / (nj - 1)])
    return Grid.from_nodes(
        lattice(ni, nj) + step * np.random.default_rng(seed).uniform(-amount, amount, (ni, nj, 2))
    )


def ring(ni: int = 25, nj: int = 9, growth: float = 1.3) -> Grid:
    turn = np.linspace(0, -2 * np.pi, ni)[:, None]
    radius = growth ** np.arange(nj)[None, :]
    nodes = np.stack([radius * np.cos(turn), radius * np.sin(turn)], axis=-1)
    nodes[-1] = nodes[0]
    return Grid.from_nodes(nodes, "o")


def verdict(grid: Grid, measure_name: str) -> np.ndarray:
    vtk = pytest.importorskip("vtk")
    from vtk.util.numpy_support import numpy_to_vtk

    flat = np.zeros((grid.ni * grid.nj, 3))
    flat[:, :2] = np.swapaxes(grid.nodes, 0, 1).reshape(-1, 2)
    points = vtk.vtkPoints()
    points.SetDataTypeToDouble()
    points.SetData(numpy_to_vtk(flat, deep=True))
    block = vtk.vtkStructuredGrid()
    block.SetDimensions(grid.ni, grid.nj, 1)
    block.SetPoints(points)
    mesh = vtk.vtkUnstructuredGrid()
    mesh.SetPoints(points)
    for k in range(block.GetNumberOfCells()):
        mesh.InsertNextCell(vtk.VTK_QUAD, block.GetCell(k).GetPointIds())
    quality = getattr(vtk.vtkMeshQuality, measure_name)
    values = [quality(mesh.GetCell(k)) for k in range(mesh.GetNumberOfCells())]
    return np.array(values).reshape(grid.nj - 1, grid.ni - 1).T


@pytest.mark.parametrize("name", VERDICT)
def test_valid_cells_agree_with_verdict(name: str) -> None:
    grid = shaken()
    theirs = verdict(grid, VERDICT[name])
    if name == "orthogonality":
        theirs = np.degrees(np.arccos(theirs))
    np.testing.assert_allclose(per_cell(grid, name), theirs, rtol=0, atol=1e-10)


@pytest.mark.parametrize("name", ["max_angle", "min_angle", "skewness", "scaled_jacobian", "aspect_ratio"])
def test_concave_cells_agree_with_verdict(name: str) -> None:
    grid = shaken(amount=0.6)
    centre = cross(
        np.diff(grid.nodes[:, :-1] + grid.nodes[:, 1:], axis=0),
        np.diff(grid.nodes[:-1] + grid.nodes[1:], axis=1),
    )
    concave = (per_cell(grid, "scaled_jacobian") < 0) & (centre > 0)  # Verdict turns clockwise cells over
    assert concave.sum() > 20
    np.testing.assert_allclose(
        per_cell(grid, name)[concave], verdict(grid, VERDICT[name])[concave], rtol=1e-12, atol=1e-10
    )


@pytest.mark.parametrize("name", ["scaled_jacobian", "aspect_ratio", "max_angle"])
def test_boundary_layer_cells_agree_with_verdict(name: str) -> None:
    nodes = ring(61, 12, 1.2).nodes * [1.0, 0.12]
    stretched = Grid.from_nodes(
        np.concatenate([nodes[:, :1], nodes[:, :1] * (1 + 1e-6), nodes[:, 1:]], axis=1), "o"
    )
    np.testing.assert_allclose(
        per_cell(stretched, name), verdict(stretched, VERDICT[name]), rtol=1e-9, atol=1e-10
    )


def test_every_metric_is_checked_against_verdict_or_by_hand() -> None:
    assert {*VERDICT, "area_ratio"} == set(NAMES)


def test_rectangle_has_the_figures_of_a_rectangle() -> None:
    quality = measure(Grid.from_nodes(lattice(3, 3) * [4.0, 1.0]))
    expected = {
        "max_angle": 90,
        "min_angle": 90,
        "skewness": 0,
        "scaled_jacobian": 1,
        "aspect_ratio": 2.5,
        "orthogonality": 90,
        "area_ratio": 1,
    }
    for name, value in expected.items():
        assert quality[name].min == pytest.approx(value, abs=1e-12)
        assert quality[name].max == pytest.approx(value, abs=1e-12)
    assert (quality.cells, quality.folded) == (4, 0)


def test_parallelogram_has_the_figures_of_a_parallelogram() -> None:
    quality = measure(Grid.from_nodes(lattice(4, 4) @ np.array([[1.0, 0.0], [0.5, np.sqrt(0.75)]])))
    assert quality["max_angle"].mean == pytest.approx(120, abs=1e-10)
    assert quality["min_angle"].mean == pytest.approx(60, abs=1e-10)
    assert quality["skewness"].mean == pytest.approx(1 / 3, abs=1e-12)
    assert quality["orthogonality"].mean == pytest.approx(60, abs=1e-10)


def test_area_ratio_sees_all_four_neighbours() -> None:
    x, y = np.meshgrid([0.0, 1.0, 3.0, 4.0], [0.0, 1.0, 4.0], indexing="ij")
    grid = Grid.from_nodes(np.stack([x, y], axis=-1))
    np.testing.assert_allclose(per_cell(grid, "area_ratio"), [[3, 3], [3, 3], [3, 3]])
    x, y = np.meshgrid([0.0, 1.0, 3.0, 8.0], [0.0, 1.0], indexing="ij")
    np.testing.assert_allclose(
        per_cell(Grid.from_nodes(np.stack([x, y], axis=-1)), "area_ratio").ravel(), [2, 2.5, 2.5]
    )


def test_area_ratio_looks_across_the_seam_of_an_o_grid() -> None:
    turn = -2 * np.pi * (np.geomspace(1, 2, 13) - 1)
    nodes = np.stack([np.outer(np.cos(turn), [1, 2]), np.outer(np.sin(turn), [1, 2])], axis=-1)
    nodes[-1] = nodes[0]
    area = np.sin(-np.diff(turn))
    assert area[-1] / area[0] > 1.5
    across = per_cell(Grid.from_nodes(nodes, "o"), "area_ratio")[[0, -1], 0]
    np.testing.assert_allclose(across, area[-1] / area[0], rtol=1e-12)
    assert per_cell(Grid.from_nodes(nodes, "quad"), "area_ratio")[[0, -1], 0].max() < 1.5


def test_summary_is_that_of_the_cells() -> None:
    grid = shaken(140, 200)
    quality = measure(grid, percentiles=True)
    for metric in QUAD_METRICS:
        values = per_cell(grid, metric.name)
        summary = quality[metric.name]
        assert (summary.min, summary.max) == (values.min(), values.max())
        assert summary.mean == pytest.approx(values.mean(), rel=1e-13)
        assert summary.p01 == pytest.approx(np.percentile(values, 1), rel=1e-13)
        assert summary.p99 == pytest.approx(np.percentile(values, 99), rel=1e-13)
        extreme = values.argmax() if metric.worst == "max" else values.argmin()
        assert summary.worst == np.unravel_index(extreme, values.shape)
    assert measure(grid)["skewness"].p99 is None


@pytest.mark.parametrize("shape", [(2, 2), (2, 9), (9, 2), (3, 18), (40, 130), (5, 300)])
def test_any_size_gives_the_same_figures_as_numpy(shape: tuple[int, int]) -> None:
    grid = shaken(*shape, amount=0.45)
    nodes = grid.nodes
    ring_of = [nodes[:-1, :-1], nodes[1:, :-1], nodes[1:, 1:], nodes[:-1, 1:]]
    edges = [ring_of[(k + 1) % 4] - ring_of[k] for k in range(4)]
    sines = [
        cross(edges[k - 1], edges[k])
        / np.linalg.norm(edges[k - 1], axis=-1)
        / np.linalg.norm(edges[k], axis=-1)
        for k in range(4)
    ]
    np.testing.assert_allclose(
        per_cell(grid, "scaled_jacobian"), np.min(sines, axis=0), rtol=1e-12, atol=1e-14
    )
    assert count_folded(nodes) == int((np.min(sines, axis=0) <= 0).sum())


def test_folded_cells_are_counted_listed_and_ranked() -> None:
    nodes = lattice(12, 11)
    nodes[5, 4] += [0.13, 0.0]  # beyond its right neighbour: two cells cross over, two stay whole
    nodes[9, 9] = nodes[8, 8]  # a collapsed cell
    nodes = as_planar(nodes)
    assert {(5, 3), (5, 4), (8, 8)} <= {tuple(cell) for cell in folded_cells(nodes)}
    assert count_folded(nodes) == len(folded_cells(nodes)) == measure(Grid.from_nodes(nodes)).folded
    worst = worst_cells(nodes)
    assert (worst[0].i, worst[0].j) in {(5, 3), (5, 4)}
    assert worst[0].x == pytest.approx(
        nodes[worst[0].i : worst[0].i + 2, worst[0].j : worst[0].j + 2, 0].mean()
    )
    assert len(worst_cells(nodes, limit=1)) == 1
    assert worst_cells(lattice(4, 4)) == []


def test_three_nodes_in_a_line_are_folded_on_every_processor() -> None:
    # fused multiply-add would leave the corner between u and k*u a Jacobian of rounding size and any sign
    rng = np.random.default_rng(5)
    for u in rng.uniform(0.1, 1, (200, 2)):
        nodes = np.array([[[0.0, 0.0], [-u[1], u[0]]], [u, 2 * u]])
        assert count_folded(nodes) == 1


def test_a_clockwise_grid_is_folded_everywhere() -> None:
    quality = measure(Grid.from_nodes(lattice(5, 6)[::-1]))
    assert quality.folded == quality.cells == 20
    assert quality["scaled_jacobian"].max == pytest.approx(-1)
    assert quality["max_angle"].min == pytest.approx(270)


def test_collapsed_cells_have_finite_figures() -> None:
    nodes = lattice(3, 3)
    nodes[1, 1] = nodes[0, 0]
    nodes[2, 2] = nodes[2, 1] = nodes[1, 2] = nodes[1, 1]
    quality = measure(Grid.from_nodes(nodes), percentiles=True)
    assert quality.folded == 4
    for metric in QUAD_METRICS:
        assert np.isfinite(
            [quality[metric.name].min, quality[metric.name].mean, quality[metric.name].max]
        ).all()
    assert quality["aspect_ratio"].max == 1e30
    assert (quality["min_angle"].max, quality["max_angle"].min, quality["scaled_jacobian"].max) == (0, 180, 0)


def test_nodes_that_are_no_numbers_count_as_folded() -> None:
    nodes = lattice(4, 4)
    nodes[1, 1] = np.nan
    assert count_folded(nodes) == 4


def test_an_unknown_metric_is_refused_with_the_known_ones() -> None:
    with pytest.raises(InputError, match="'beauty' is not known; use one of max_angle, min_angle"):
        per_cell(shaken(), "beauty")


FORMS = {
    "plane": Grid.from_nodes(lattice(4, 6)),
    "blocks": butterfly(),
    "surface": Grid.from_nodes(np.pad(lattice(4, 6), ((0, 0), (0, 0), (0, 1)))),
    "volume": Grid.from_nodes(box()),
}


@pytest.mark.parametrize("form", FORMS)
def test_a_metric_with_a_function_is_measured_in_every_grid(
    form: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A line of `METRICS` is enough; here the abscissa of a cell's first corner."""
    grid = FORMS[form]
    inner = (slice(-1),) * len(grid.blocks[0].counts)
    abscissa = Metric("abscissa", "", "max", "x of the first corner", lambda nodes: nodes[(*inner, 0)])
    monkeypatch.setattr(metrics, "METRICS", (abscissa,))
    values = per_cell_of_blocks(grid, "abscissa")
    assert [cells.shape for cells in values] == [
        tuple(count - 1 for count in block.counts) for block in grid.blocks
    ]
    result = measure(grid, percentiles=True)
    every = np.concatenate([cells.ravel() for cells in values])
    assert list(result)[-1] == "abscissa"
    row = result["abscissa"]
    assert (row.min, row.max, row.p99) == (every.min(), every.max(), np.percentile(every, 99))
    worst = row.worst if grid.topology == "blocks" else (0, *row.worst)
    assert values[worst[0]][worst[1:]] == every.max()
