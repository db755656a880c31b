"""Metrics of volumes and surface patches against Verdict (through VTK) and shapes known by hand."""

from collections.abc import Sequence
from itertools import product

import numpy as np
import pytest
from space_grids import lattice, pipe, sphere_patches

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.find_connections import find_connections
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.shared_nodes import with_equal_nodes
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.measure import (
    count_folded,
    folded_cells,
    measure,
    per_cell_of_blocks,
    worst_cells,
    worst_cells_of,
)
from meshonet.geometry.quality.metrics import NAMES, SOLID_NAMES
from meshonet.geometry.quality.volumes import BEZIER, count_folded_solids, padded_volumes
from meshonet.geometry.threads import limited_to

HEX = {
    "scaled_jacobian": "HexScaledJacobian",
    "jacobian_ratio": "HexNodalJacobianRatio",
    "aspect_ratio": "HexMaxEdgeRatio",
    "orthogonality": "HexSkew",
    "skewness": "HexEquiangleSkew",
}
QUAD = {
    "max_angle": "QuadMaxAngle",
    "min_angle": "QuadMinAngle",
    "scaled_jacobian": "QuadScaledJacobian",
    "orthogonality": "QuadSkew",
}
CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]


def shaken(n: int = 6, amount: float = 0.3, seed: int = 3) -> Grid:
    """A lattice whose nodes are moved by up to `amount` of a cell."""
    nodes = lattice(*[(0.0, n - 1.0, n)] * 3)
    return Grid.from_nodes(nodes + np.random.default_rng(seed).uniform(-amount, amount, nodes.shape))


def verdict(nodes: Floats, name: str) -> Floats:
    """What Verdict says of the cells of `nodes` (ni, nj, nk, 3) or (ni, nj, 3)."""
    vtk = pytest.importorskip("vtk")
    solid = nodes.ndim == 4
    corners = CORNERS if solid else [corner[:2] for corner in CORNERS[:4]]
    shape = [count - 1 for count in nodes.shape[:-1]]
    values = np.empty(shape)
    for at in np.ndindex(*shape):
        cell = vtk.vtkHexahedron() if solid else vtk.vtkQuad()
        for number, corner in enumerate(corners):
            cell.GetPoints().SetPoint(number, *nodes[tuple(np.add(at, corner))])
        values[at] = getattr(vtk.vtkMeshQuality, name)(cell)
    return values


def reflex_faces(nodes: Floats) -> Floats:
    """Say which cells have a face with a reflex angle, of which Verdict takes 360 degrees less the angle."""
    result = np.zeros([count - 1 for count in nodes.shape[:-1]], dtype=bool)
    for axis in range(3):
        for number, layer in enumerate(np.moveaxis(nodes, axis, 0)):
            bent = per_cell_of_blocks(Grid.from_nodes(layer), "max_angle")[0] > 180
            cells = np.moveaxis(result, axis, 0)
            for beside in {max(number - 1, 0), min(number, len(cells) - 1)}:
                cells[beside] |= bent
    return result


@pytest.mark.parametrize("name", HEX)
@pytest.mark.parametrize("amount", [0.2, 0.5])
def test_cells_of_volumes_agree_with_verdict(name: str, amount: float) -> None:
    grid = shaken(amount=amount)
    theirs = verdict(grid.nodes, HEX[name])
    if name == "orthogonality":
        theirs = np.degrees(np.arccos(theirs))
    (ours,) = per_cell_of_blocks(grid, name)
    usable = ours > -1  # Verdict divides a jacobian_ratio by the greatest Jacobian, here by its magnitude
    if name == "skewness":
        usable = ~reflex_faces(grid.nodes)
    assert usable.sum() > 40
    np.testing.assert_allclose(ours[usable], theirs[usable], rtol=0, atol=1e-10)


def test_volumes_agree_with_verdict() -> None:
    grid = shaken()
    np.testing.assert_allclose(padded_volumes(grid)[0][1:-1, 1:-1, 1:-1], verdict(grid.nodes, "HexVolume"))


@pytest.mark.parametrize("name", QUAD)
def test_cells_of_surfaces_agree_with_verdict(name: str) -> None:
    nodes = lattice((0, 7, 8), (0, 7, 8), (0, 1, 2))[:, :, 0]
    grid = Grid.from_nodes(nodes + np.random.default_rng(1).uniform(-0.45, 0.45, nodes.shape))
    theirs = verdict(grid.nodes, QUAD[name])
    if name == "orthogonality":
        theirs = np.degrees(np.arccos(theirs))
    np.testing.assert_allclose(per_cell_of_blocks(grid, name)[0], theirs, rtol=0, atol=1e-10)


def test_a_flat_surface_has_the_metrics_of_the_plane() -> None:
    plane = lattice((0, 7, 8), (0, 7, 8), (0, 1, 2))[:, :, 0, :2]
    plane = plane + np.random.default_rng(1).uniform(-0.3, 0.3, plane.shape)
    turn = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0][:2]
    for name in NAMES:
        (flat,), (ours,) = (per_cell_of_blocks(Grid.from_nodes(n), name) for n in (plane, plane @ turn))
        np.testing.assert_allclose(ours, flat, rtol=1e-9, atol=1e-9)


def test_a_box_has_the_figures_of_a_box() -> None:
    quality = measure(Grid.from_nodes(lattice((0, 4, 3), (0, 2, 3), (0, 1, 3))), percentiles=True)
    expected = {
        "max_angle": 90, "min_angle": 90, "skewness": 0, "deviation": 0, "scaled_jacobian": 1,
        "jacobian_ratio": 1, "bezier_ratio": 1, "aspect_ratio": 4, "orthogonality": 90, "volume_ratio": 1,
    }  # fmt: skip
    assert set(expected) == set(SOLID_NAMES) <= set(quality.metrics)
    for name, value in expected.items():
        row = quality[name]
        assert [row.min, row.p01, row.mean, row.p99, row.max] == pytest.approx([value] * 5, abs=1e-12)
    assert (quality.cells, quality.folded, quality.bezier_folded) == (8, 0, 0)


def test_a_sheared_box_has_its_angle_at_every_corner() -> None:
    shear = np.array([[1.0, 0, 0], [np.cos(np.radians(60)), np.sin(np.radians(60)), 0], [0, 0, 1.0]])
    quality = measure(Grid.from_nodes(lattice((0, 3, 4), (0, 3, 4), (0, 3, 4)) @ shear))
    assert quality["max_angle"].mean == pytest.approx(120, abs=1e-9)
    assert quality["min_angle"].mean == pytest.approx(60, abs=1e-9)
    assert quality["deviation"].mean == pytest.approx(30, abs=1e-9)
    assert quality["scaled_jacobian"].mean == pytest.approx(np.sin(np.radians(60)), abs=1e-12)


def test_a_node_pulled_through_a_face_folds_the_cells_around_it() -> None:
    nodes = lattice((0, 4, 5), (0, 4, 5), (0, 4, 5))
    nodes[2, 2, 2] += [0, 0, 1.5]
    grid = Grid.from_nodes(nodes)
    folded = folded_cells(grid.nodes)
    assert count_folded(grid.nodes) == len(folded) == measure(grid).folded
    assert folded.tolist() == [[i, j, 2] for i in (1, 2) for j in (1, 2)]
    (worst, *_), of_grid = worst_cells(grid.nodes), worst_cells_of(grid)
    assert (worst.i, worst.j, worst.k) == (1, 1, 2)
    assert str(worst) == "i=1, j=1, k=2, x=1.5, y=1.5, z=2.6875"
    assert str(of_grid[0]) == "block=0, i=1, j=1, k=2, x=1.5, y=1.5, z=2.6875"


def test_a_twisted_cell_may_be_folded_inside_with_all_corners_right() -> None:
    turn = np.radians(100)
    nodes = lattice((-1, 1, 2), (-1, 1, 2), (0, 1, 2))
    x, y = nodes[:, :, 1, 0].copy(), nodes[:, :, 1, 1].copy()
    nodes[:, :, 1, 0] = np.cos(turn) * x - np.sin(turn) * y
    nodes[:, :, 1, 1] = np.sin(turn) * x + np.cos(turn) * y
    grid = Grid.from_nodes(nodes)
    middle = nodes.mean(axis=2)  # the map's derivatives half-way up
    u, v = middle[1] - middle[0], middle[:, 1] - middle[:, 0]
    assert np.cross(u.mean(axis=0), v.mean(axis=0))[2] > 0  # positive there: a turn of 180 degrees makes it 0
    quality = measure(grid)
    assert (quality.folded, quality.bezier_folded) == (0, count_folded_solids(nodes, BEZIER))
    assert quality["bezier_ratio"].min < quality["jacobian_ratio"].min


def test_bezier_coefficients_bound_the_jacobian_everywhere() -> None:
    grid = shaken(amount=0.35)
    nodes = grid.nodes
    t = np.linspace(0, 1, 7)
    least = np.full([count - 1 for count in nodes.shape[:3]], np.inf)
    for a, b, c in product(t, repeat=3):
        u, v, w = (_slope(nodes, axis, ((1 - a, a), (1 - b, b), (1 - c, c))) for axis in range(3))
        least = np.minimum(least, (u * np.cross(v, w)).sum(axis=-1))
    ours = per_cell_of_blocks(grid, "bezier_ratio")[0]
    ratio = per_cell_of_blocks(grid, "jacobian_ratio")[0]
    assert (ours <= ratio + 1e-12).all()
    folded = {tuple(at) for at in folded_cells(nodes).tolist()}
    doubtful = {tuple(at) for at in np.argwhere(ours <= 0).tolist()}
    assert {tuple(at) for at in np.argwhere(least <= 0).tolist()} <= doubtful
    assert folded <= doubtful
    assert count_folded_solids(nodes, BEZIER) == len(doubtful)


def _slope(nodes: Floats, axis: int, weights: Sequence[tuple[float, float]]) -> Floats:
    """The derivative of every trilinear cell along an axis at one point of it."""
    values = np.diff(nodes, axis=axis)
    for across in {0, 1, 2} - {axis}:
        layers = np.moveaxis(values, across, 0)
        low, high = weights[across]
        values = np.moveaxis(low * layers[:-1] + high * layers[1:], 0, across)
    return values


def test_corners_at_an_axis_are_left_out() -> None:
    grid = Grid.from_nodes(pipe())
    quality = measure(grid)
    assert (quality.folded, quality.bezier_folded) == (0, 0)
    assert quality["scaled_jacobian"].min > 0.9
    flipped = pipe()[:, ::-1]
    assert count_folded(flipped) == quality.cells


def test_neighbours_across_connections_count() -> None:
    blocks = [
        Block(lattice((0, 1, 3), (0, 1, 3), (0, 1, 3))),
        Block(lattice((1, 5, 3), (0, 1, 3), (0, 1, 3))),
    ]
    apart, connections = Grid(tuple(blocks)), find_connections(blocks)
    assert measure(apart)["volume_ratio"].max == pytest.approx(1)
    together = measure(Grid(with_equal_nodes(blocks, connections), (), connections))["volume_ratio"]
    assert (together.max, together.worst) == (pytest.approx(4), (0, 1, 0, 0))
    sides = [
        lattice((0, 1, 3), (0, 1, 3), (0, 1, 2))[:, :, 0],
        lattice((1, 4, 3), (0, 1, 3), (0, 1, 2))[:, :, 0],
    ]
    patches = [Block(side) for side in sides]
    joined = Grid(tuple(patches), (), find_connections(patches))
    assert measure(joined)["area_ratio"].max == pytest.approx(3)


@pytest.mark.slow
@pytest.mark.parametrize("shape", [(70, 66, 68), (3, 300, 400), (400, 3, 300)])
def test_figures_of_many_cells_are_those_of_all_values(shape: tuple[int, int, int]) -> None:
    nodes = lattice(*[(0.0, count - 1.0, count) for count in shape])
    grid = Grid.from_nodes(nodes + np.random.default_rng(0).uniform(-0.25, 0.25, nodes.shape))
    quality = measure(grid, percentiles=True)
    for name, row in quality.metrics.items():
        (values,) = per_cell_of_blocks(grid, name)
        assert (row.min, row.max) == (values.min(), values.max())
        assert (row.p01, row.p99) == tuple(np.percentile(values, (1, 99)))
        assert row.mean == pytest.approx(values.mean(), rel=1e-12)
        assert values[row.worst[1:]] in (row.min, row.max)


@pytest.mark.slow
def test_threads_change_no_bit(eager_threads: None) -> None:
    nodes = lattice((0, 69, 70), (0, 69, 70), (0, 65, 66))
    grid = Grid.from_nodes(nodes + np.random.default_rng(0).uniform(-0.4, 0.4, nodes.shape))
    results = []
    for threads in (1, 2, 5):
        with limited_to(threads):
            results.append((measure(grid, percentiles=True), folded_cells(grid.nodes).tolist()))
    assert results[0][1]
    assert results[0] == results[1] == results[2]


def test_a_surface_is_folded_where_a_corner_turns_against_its_cell() -> None:
    patches = sphere_patches()
    assert (
        sum(count_folded(patch) for patch in patches)
        == sum(count_folded(patch[::-1]) for patch in patches)
        == 0
    )
    patch = lattice((0, 3, 4), (0, 3, 4), (0, 1, 2))[:, :, 0]
    patch[1, 1] += [0.8, 0.8, 0]
    (worst,) = worst_cells(patch)
    assert (worst.i, worst.j, worst.k, worst.z) == (1, 1, None, 0.0)


def test_metrics_of_other_cells_are_refused_by_name() -> None:
    with pytest.raises(InputError, match="metric 'area_ratio' is none of volumes; use one of max_angle"):
        per_cell_of_blocks(shaken(), "area_ratio")
    with pytest.raises(InputError, match="metric 'volume_ratio' is none of quadrilaterals"):
        per_cell_of_blocks(
            Grid.from_nodes(lattice((0, 1, 3), (0, 1, 3), (0, 1, 2))[:, :, 0, :2]), "volume_ratio"
        )
