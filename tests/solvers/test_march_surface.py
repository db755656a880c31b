"""Volumes marched from surfaces, against shapes whose levels are known and determinants taken here."""

from typing import Any

import numpy as np
import pytest
from surface_shapes import (
    cube,
    cylinder,
    dented,
    ellipsoid,
    grid_of,
    half_sphere,
    plate,
    room_corner,
    sphere,
    star,
    wing,
)

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError, NoValidGridError
from meshonet.geometry.surface.surface import surface_of
from meshonet.geometry.threads import limited_to
from meshonet.solvers.hyperbolic.volume.march import VolumeMarch, march_surface
from meshonet.solvers.solution import Solution


def marched(
    patches: list[Floats], first: float = 1e-3, layers: int | None = 33, far: float = 5.0, **more: Any
) -> Solution:
    return march_surface(surface_of(grid_of(patches)), VolumeMarch(first, layers, far, **more))


def corner_jacobians(x: Floats) -> Floats:
    """The determinants (8, ni-1, nj-1, nk-1) at the corners of the cells of a block (ni, nj, nk, 3)."""
    u, v, w = (np.diff(x, axis=axis) for axis in range(3))
    values = []
    for a in (slice(None, -1), slice(1, None)):
        for b in (slice(None, -1), slice(1, None)):
            for c in (slice(None, -1), slice(1, None)):
                values.append((np.cross(u[:, b, c], v[a, :, c]) * w[a, b]).sum(axis=-1))
    return np.stack(values)


def first_cells(grid: Grid) -> Floats:
    return np.concatenate(
        [np.linalg.norm(b.nodes[:, :, 1] - b.nodes[:, :, 0], axis=-1).ravel() for b in grid.blocks]
    )


SHAPES = {
    "cube": lambda: cube(16),
    "cylinder": lambda: cylinder(12),
    "dented": lambda: dented(20),
    "ellipsoid": lambda: ellipsoid(20),
    "half sphere": lambda: half_sphere(8),
    "sphere": lambda: sphere(12),
    "star": lambda: star(20),
    "wing": wing,
}


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("first", [1e-3, 1e-5])
def test_no_cell_is_folded_and_every_first_cell_is_exact(shape: str, first: float) -> None:
    grid = marched(SHAPES[shape](), first, 49, 8.0).grid
    assert min(corner_jacobians(block.nodes).min() for block in grid.blocks) > 0.0
    assert np.abs(first_cells(grid) / first - 1.0).max() < 1e-6


def test_levels_around_a_sphere_are_spheres() -> None:
    grid = marched(sphere(16), 1e-3, 41, 4.0).grid
    for block in grid.blocks:
        radius = np.linalg.norm(block.nodes, axis=-1)
        assert (np.ptp(radius, axis=(0, 1)) < 0.06 * radius.mean(axis=(0, 1))).all()
    assert np.mean([np.linalg.norm(b.nodes[:, :, -1], axis=-1).mean() for b in grid.blocks]) == pytest.approx(
        5.0, rel=0.05
    )


def test_a_plate_between_planes_of_symmetry_is_extruded() -> None:
    solution = marched(plate(8), 1e-2, 17, 1.0)
    nodes = solution.grid.blocks[0].nodes
    assert np.abs(nodes[..., :2] - nodes[:, :, :1, :2]).max() < 1e-12
    assert nodes[..., -1, 2] == pytest.approx(1.0)
    assert {p.name for p in solution.grid.patches} == {"wall", "farfield", "symmetry"}


def test_half_a_sphere_gives_half_the_volume_of_a_sphere() -> None:
    whole, half = marched(sphere(16)).grid, marched(half_sphere(8)).grid
    top = next(b.nodes for b, p in zip(whole.blocks, sphere(16), strict=True) if p[..., 2].min() > 0.1)
    same = next(b.nodes for b, p in zip(half.blocks, half_sphere(8), strict=True) if p[..., 2].min() > 0.1)
    assert np.abs(top - same).max() < 4e-3  # linear systems are solved to a thousandth
    for patch in half.patches:
        if patch.name == "symmetry":
            assert (half.face(patch.block, patch.side)[..., 2] == 0.0).all()


def test_blocks_are_connected_wherever_patches_share_edges() -> None:
    grid = marched(cube(8)).grid
    assert len(grid.connections) == 12
    assert {(p.name, p.side) for p in grid.patches} == {("wall", "bottom"), ("farfield", "top")}
    seam = marched(cylinder(8)).grid.connections
    assert any(c.block == c.donor == 0 and {c.side, c.donor_side} == {"west", "east"} for c in seam)


def test_the_wall_is_the_surface() -> None:
    patches = sphere(6)
    for patch, block in zip(patches, marched(patches).grid.blocks, strict=True):
        assert np.abs(block.nodes[:, :, 0] - patch).max() < 1e-12


def test_results_are_the_same_to_the_bit_for_any_number_of_threads(eager_threads: None) -> None:
    grids = []
    for threads in (1, 2, 3):
        with limited_to(threads):
            grids.append(marched(wing(), 1e-4, 33, 10.0).grid)
    for other in grids[1:]:
        for a, b in zip(grids[0].blocks, other.blocks, strict=True):
            assert np.array_equal(a.nodes, b.nodes)


def test_free_edges_are_noted_with_their_place_and_named() -> None:
    solution = marched(plate(8), 1e-2, 17, 0.5, symmetry="none")
    assert any("32 open edges" in note and "patch 0, i=0, j=0" in note for note in solution.notes)
    assert {p.name for p in solution.grid.patches} == {"wall", "farfield", "free"}


def test_a_hole_in_no_plane_is_free() -> None:
    patches = sphere(8)
    patches[5] = patches[5][:5]
    solution = marched(patches, far=0.3, layers=21)
    assert any("open edges" in note for note in solution.notes)


def test_layers_follow_from_the_growth() -> None:
    grid = marched(sphere(8), 1e-3, None, 5.0, growth=1.3).grid
    steps = 1e-3 * 1.3 ** np.arange(grid.blocks[0].counts[2] - 1)
    assert steps[:-1].sum() < 5.5 <= steps.sum()  # lines may be a tenth longer than the far field is away


def test_cells_along_lines_grow_by_no_more_than_asked() -> None:
    patches = sphere(8)
    stretched = [patch * np.array([1.0, 0.1, 3.0]) for patch in patches]
    grid = marched(stretched, 1e-3, None, 5.0, growth=1.2).grid
    for block in grid.blocks:
        steps = np.linalg.norm(np.diff(block.nodes, axis=2), axis=-1)
        ratio = steps[:, :, 1:] / steps[:, :, :-1]
        assert np.maximum(ratio, 1.0 / ratio).max() <= 1.2
        assert steps[:, :, 0] == pytest.approx(np.full(steps.shape[:2], 1e-3), rel=1e-9)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"first_cell": -1.0}, "no length"),
        ({"first_cell": 1e-3, "layers": 2}, "too few"),
        ({"first_cell": 1e-3, "far_field": 1e-3}, "nearer than two first cells"),
        ({"first_cell": 1e-3, "symmetry": "x"}, "no open edge"),
        ({"first_cell": 1e-3, "layers": 10, "growth": 1.1}, "grow by more than"),
    ],
)
def test_settings_that_no_march_can_meet_are_refused(settings: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        march_surface(surface_of(grid_of(sphere(4))), VolumeMarch(**settings))


def test_folds_are_refused_with_the_worst_cells() -> None:
    walls = room_corner(8, 3)
    across = walls[0][::-1] + np.array([0.3, 0.0, 0.0])  # a fourth wall faces the first one
    walls[1], walls[2] = (wall[:, :9] * np.array([0.3, 1.0, 1.0]) for wall in walls[1:])
    with pytest.raises(NoValidGridError) as error:
        marched([*walls, across], 1e-2, 33, 2.0, symmetry="none")
    text = str(error.value)
    assert "block=" in text
    assert "z=" in text


@pytest.mark.parametrize(("far", "overlap"), [(5.0, True), (0.9, False)])
def test_parts_whose_grids_would_overlap_are_refused(far: float, overlap: bool) -> None:
    two = [*sphere(6), *(patch + np.array([4.0, 0.0, 0.0]) for patch in sphere(6))]
    if not overlap:
        assert len(marched(two, layers=9, first=1e-2, far=far).grid.blocks) == 12
        return
    with pytest.raises(InputError, match=r"parts of the surface, .*, are 2 apart") as refused:
        marched(two, layers=9, first=1e-2, far=far)
    assert "far_field} below 1" in str(refused.value.remedy)
