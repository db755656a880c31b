"""Given grids of blocks in space are smoothed across their interfaces and never become worse."""

from collections.abc import Callable

import numpy as np
import pytest
from block_grids import butterfly, o_ring
from joined_volumes import bend, joined, perturbed, shell
from surface_shapes import cube, grid_of

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import PLACES, Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.extrude import extruded
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.measure import measure
from meshonet.geometry.surface.surface import surface_of
from meshonet.geometry.volume.hex_mesh import hex_mesh_of, with_nodes
from meshonet.solvers.hyperbolic.volume.march import VolumeMarch, march_surface
from meshonet.solvers.smoothing.volumes import smooth_volumes
from meshonet.solvers.solution import Outcome

HEIGHTS = np.linspace(0.0, 1.5, 9)
SHAPES: list[Callable[[], Grid]] = [
    shell,
    bend,
    lambda: extruded(butterfly(9, 7), HEIGHTS),
    lambda: extruded(o_ring(), HEIGHTS),
]


def figures(grid: Grid) -> tuple[int, float, float]:
    """Folded cells, mean deviation from 90 degrees, least scaled Jacobian."""
    quality = measure(grid)
    return quality.folded, quality["deviation"].mean, quality["scaled_jacobian"].min


def first_cells(grid: Grid, *walls: tuple[int, str]) -> Floats:
    heights = []
    for block, side in walls:
        axis, end = PLACES[side]  # type: ignore[index]
        nodes = np.moveaxis(grid.blocks[block].nodes, axis, 0)[:: -1 if end else 1]
        heights.append(np.linalg.norm(nodes[1] - nodes[0], axis=-1).ravel())
    return np.concatenate(heights)


@pytest.mark.parametrize("make", SHAPES)
@pytest.mark.parametrize("size", [0.3, 0.6, 1.0])
def test_random_folds_go_and_angles_become_as_good_as_before(make: Callable[[], Grid], size: float) -> None:
    grid = make()
    spoilt = perturbed(grid, size)
    solution = smooth_volumes(spoilt)
    folded, mean, least = figures(solution.grid)
    assert folded == 0
    assert mean < 1.05 * figures(grid)[1]
    assert mean < 0.5 * figures(spoilt)[1]
    assert least > 0.8 * figures(grid)[2]
    assert solution.outcome is Outcome.DONE


@pytest.mark.parametrize("make", SHAPES)
def test_a_good_grid_becomes_no_worse(make: Callable[[], Grid]) -> None:
    grid = make()
    solution = smooth_volumes(grid)
    before, after = figures(grid), figures(solution.grid)
    assert after[0] == 0
    assert after[1] <= before[1]
    assert after[2] >= min(0.98 * before[2], 0.7)
    assert solution.grid.connections == grid.connections
    assert solution.grid.patches == grid.patches


@pytest.mark.parametrize("make", SHAPES)
def test_outer_sides_stay_bitwise(make: Callable[[], Grid]) -> None:
    grid = perturbed(make(), 0.5)
    smoothed = smooth_volumes(grid).grid
    for patch in grid.patches:
        np.testing.assert_array_equal(
            smoothed.face(patch.block, patch.side), grid.face(patch.block, patch.side)
        )


def test_first_cells_at_walls_keep_their_heights() -> None:
    grid = shell(n=13, first=0.01)
    walls = [(k, "bottom") for k in range(6)]
    smoothed = smooth_volumes(grid)
    assert not smoothed.notes
    np.testing.assert_allclose(first_cells(smoothed.grid, *walls), first_cells(grid, *walls), rtol=1e-9)


def test_marched_blocks_keep_their_first_cells() -> None:
    grid = march_surface(surface_of(grid_of(cube(8))), VolumeMarch(1e-3, 17, 4.0)).grid
    walls = [(k, "bottom") for k in range(6)]
    smoothed = smooth_volumes(grid, iterations=20).grid
    assert np.abs(smoothed.blocks[0].nodes - grid.blocks[0].nodes).max() > 1e-3
    np.testing.assert_allclose(first_cells(smoothed, *walls), first_cells(grid, *walls), rtol=1e-2)


def test_angles_of_a_shell_improve_across_its_interfaces() -> None:
    grid = shell(n=13)
    assert figures(smooth_volumes(grid).grid)[1] < 0.85 * figures(grid)[1]


def box(bump: float = 0.25) -> Grid:
    """Two blocks over a floor with a bump, named by their sides, lines upright as the floor's own."""
    x, y, z = np.meshgrid(np.linspace(0, 2, 17), np.linspace(0, 1, 9), np.linspace(0, 1, 9), indexing="ij")
    floor = bump * np.exp(-20 * ((x - 0.8) ** 2 + (y - 0.4) ** 2))
    nodes = np.stack(
        [x + 0.1 * np.sin(np.pi * z) * np.sin(np.pi * x / 2), y, floor + (1 - floor) * z], axis=-1
    )
    names = {(0, 0.0): "inlet", (0, 2.0): "outlet", (1, 0.0): "left", (1, 1.0): "right", (2, 1.0): "lid"}

    def name(side: Floats) -> str:
        flat = [names.get((k, float(side[0, 0, k]))) for k in range(3) if np.ptp(side[..., k]) == 0]
        return next((each for each in flat if each), "floor")

    return joined([nodes[:9], nodes[8:]], name)


def test_nodes_of_flat_patches_slide_in_their_planes() -> None:
    grid = box()
    kept, slid = smooth_volumes(grid).grid, smooth_volumes(grid, slide=True).grid
    assert figures(slid)[1] < figures(kept)[1]
    for patch in grid.patches:
        side, before = slid.face(patch.block, patch.side), grid.face(patch.block, patch.side)
        if patch.name == "floor":
            np.testing.assert_array_equal(side, before)
            continue
        axis = {"inlet": 0, "outlet": 0, "left": 1, "right": 1, "lid": 2}[patch.name]
        np.testing.assert_array_equal(side[..., axis], before[..., axis])
        assert not np.array_equal(side, before)
    corner = slid.blocks[0].nodes[0, 0, -1]
    np.testing.assert_array_equal(corner, grid.blocks[0].nodes[0, 0, -1])


def test_folds_that_its_sides_have_are_left_and_reported() -> None:
    grid = box()
    nodes = grid.blocks[0].nodes.copy()
    nodes[0, 0, 3:6] = nodes[0, 0, 5:2:-1]
    folded = Grid((Block(nodes), grid.blocks[1]), grid.patches, grid.connections)
    solution = smooth_volumes(folded)
    assert solution.outcome is Outcome.FOLDED
    assert 0 < figures(solution.grid)[0] <= figures(folded)[0]


@pytest.mark.parametrize("seed", range(3))
def test_nodes_in_any_order_are_put_in_order(seed: int) -> None:
    """As a file whose inner nodes are of no use: Laplace's equation begins anew."""
    grid = box(bump=0.0)
    mesh = hex_mesh_of(grid)
    inner = np.flatnonzero(~mesh.outer)
    nodes = mesh.nodes.copy()
    nodes[inner] = nodes[np.random.default_rng(seed).permutation(inner)]
    solution = smooth_volumes(with_nodes(grid, mesh.with_nodes(nodes)))
    assert figures(solution.grid)[0] == 0


def test_blocks_with_an_axis_and_with_poles_are_unfolded() -> None:
    spans = (0.0, 1.0, 8), (0.0, 2 * np.pi, 17), (0.0, 2.0, 7)
    r, t, z = np.meshgrid(*(np.linspace(*span) for span in spans), indexing="ij")
    pipe = np.stack([r * np.cos(t), r * np.sin(t), z], axis=-1)
    angle = 0.5 * np.pi * z
    ball = np.stack([np.cos(t) * np.sin(angle), np.sin(t) * np.sin(angle), -np.cos(angle)], axis=-1)
    ball *= 1.0 + 2.0 * r[..., None]
    ball[:, :, [0, -1], :2] = 0.0
    for nodes in (pipe, ball):
        nodes[:, -1] = nodes[:, 0]
        grid = joined([nodes])
        assert len(grid.connections) == 1
        spoilt = perturbed(grid, 0.5)
        assert figures(spoilt)[0] > 0
        folded, mean, least = figures(smooth_volumes(spoilt).grid)
        assert folded == 0
        assert mean < 1.1 * figures(grid)[1]
        assert least > 0.8


def test_blocks_that_share_a_part_of_a_side_are_smoothed() -> None:
    large = np.stack(np.meshgrid(*(0.25 * np.arange(n) for n in (5, 9, 5)), indexing="ij"), axis=-1)
    small = large[:, :5] + (1.0, 0.0, 0.0)
    joint = Connection(0, "east", ((0, 4), (0, 4)), 1, "west", ((0, 4), (0, 4)), (1, 2))
    spoilt = perturbed(Grid((Block(large), Block(small)), (), (joint,)), 0.6)
    folded, mean, _ = figures(smooth_volumes(spoilt).grid)
    assert folded == 0
    assert mean < 0.5
