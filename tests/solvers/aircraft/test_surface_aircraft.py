"""Grids around patches of bodies and wings from a file: nodes lie on these, in the axes of the file."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from aircraft_shapes import unclaimed_faces, wall
from aircraft_surfaces import LENGTH, SPAN, TOML, body_patch, radius, wing_patches, written

from meshonet import read as read_grid
from meshonet.formats.stack import stack_of
from meshonet.geometry.aircraft.aircraft import Aircraft
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.wall_surface import wall_surface
from meshonet.geometry.quality.volumes import BEZIER, count_folded_solids, measure_volumes
from meshonet.geometry.shapes.airfoil.naca import naca_points
from meshonet.solvers.aircraft.aircraft_grid import aircraft_grid
from meshonet.solvers.aircraft.request import AircraftRequest

FIRST = 1e-3
SMALL = AircraftRequest(around=65, span=9, first_cell=FIRST, far_field=8.0, growth=1.3)


def read(folder: Path, **turned: object) -> Aircraft:
    written(folder / "jet.xyz", [body_patch(), *wing_patches()], **turned)  # type: ignore[arg-type]
    (folder / "jet.toml").write_text(TOML)
    jet = stack_of(str(folder / "jet.toml"))
    assert isinstance(jet, Aircraft)
    return jet


@pytest.fixture(scope="module")
def jet(tmp_path_factory: pytest.TempPathFactory) -> Aircraft:
    return read(tmp_path_factory.mktemp("jet"), axes=(0, 2, 1), sign=-1.0)


@pytest.fixture(scope="module")
def grid(jet: Aircraft) -> Grid:
    return aircraft_grid(jet, SMALL)[0]


def test_no_cell_is_folded_and_blocks_match(grid: Grid) -> None:
    assert sum(count_folded_solids(block.nodes, BEZIER) for block in grid.blocks) == 0
    assert measure_volumes(grid)["scaled_jacobian"].min > 0.1
    assert unclaimed_faces(grid) == 0


@pytest.mark.parametrize("name", ["fuselage", "wing", "tip"])
def test_first_cells_are_exact(grid: Grid, jet: Aircraft, name: str) -> None:
    for nodes, beside in wall(grid, name):
        assert np.linalg.norm(beside - nodes, axis=-1) == pytest.approx(FIRST * jet.wing.chord, rel=1e-9)


def test_nodes_are_on_the_body_and_on_the_side_of_the_file(grid: Grid) -> None:
    nodes = np.concatenate([nodes.reshape(-1, 3) for nodes, _ in wall(grid, "fuselage")])
    x, y, z = nodes.T
    assert np.abs(np.hypot(y, z) - radius(x)).max() < 1e-4
    assert (y.max(), y.min() < -0.59, z.max() > 0.59) == (0.0, True, True)


def test_nodes_are_on_the_wing(grid: Grid) -> None:
    (nodes, _), *_ = wall(grid, "wing")
    x, z, y = np.moveaxis(nodes * [1.0, -1.0, 1.0], -1, 0)
    chord = 2.0 - z / SPAN
    on = np.stack([(x - 3.4 - 0.4 * z) / chord, (y - 0.05 * z) / chord], axis=-1)[1:-1].reshape(-1, 2)
    assert np.abs(distances(on, naca_points("2415", 2001))).max() < 2e-5


def distances(points: Floats, curve: Floats) -> Floats:
    """Distances of points from a polygon."""
    begin, along = curve[:-1], np.diff(curve, axis=0)
    away = points[:, None] - begin
    part = np.clip((away * along).sum(axis=-1) / (along * along).sum(axis=-1), 0.0, 1.0)
    return np.asarray(np.linalg.norm(away - part[..., None] * along, axis=-1).min(axis=1))


def test_mirrored_files_have_mirrored_grids(grid: Grid, tmp_path: Path) -> None:
    other = aircraft_grid(read(tmp_path, axes=(0, 2, 1), sign=1.0), SMALL)[0]
    assert sum(count_folded_solids(block.nodes, BEZIER) for block in other.blocks) == 0
    assert unclaimed_faces(other) == 0
    for block, own in zip(other.blocks, grid.blocks, strict=True):
        assert np.array_equal(block.nodes[::-1] * [1.0, -1.0, 1.0], own.nodes)


def test_the_surface_has_its_plane_of_symmetry_in_the_axes_of_the_file(grid: Grid) -> None:
    surface = wall_surface(grid)
    edges = [surface.face(patch.block, patch.side) for patch in surface.patches]
    assert {patch.name for patch in surface.patches} == {"symmetry"}
    assert not any(edge[:, 1].any() for edge in edges)
    assert sum(np.abs(np.diff(edge[:, 0])).sum() for edge in edges) == pytest.approx(2.0 * LENGTH, rel=1e-3)


def test_blocks_are_named_after_what_they_are_beside(grid: Grid, tmp_path: Path) -> None:
    names = ["wing-collar", "wing-above", "wing-below", "fuselage-nose", "fuselage-nose-core"]
    names += ["fuselage-tail", "fuselage-tail-core", "tip-ring", "tip-core"]
    assert grid.provenance["zones"] == names
    grid.write(tmp_path / "jet.cgns")
    assert read_grid(str(tmp_path / "jet.cgns")).provenance["zones"] == names
    (collar, _), *_ = wall(grid, "wing")
    assert np.array_equal(collar, grid.blocks[0].nodes[:, 0, : collar.shape[1]])


def test_a_body_with_oval_sections_and_a_raised_tail_has_its_nodes_on_them(tmp_path: Path) -> None:
    def lift(x: Floats) -> Floats:
        return 0.25 * np.clip((x - 6.0) / 4.0, 0.0, 1.0) ** 2

    body = body_patch() * [1.0, 1.1, 0.95]
    body[..., 1] += lift(body[..., 0])
    written(tmp_path / "jet.xyz", [body, *wing_patches()], axes=(0, 2, 1), sign=-1.0)
    (tmp_path / "jet.toml").write_text(TOML)
    jet = stack_of(str(tmp_path / "jet.toml"))
    assert isinstance(jet, Aircraft)
    grid = aircraft_grid(jet, replace(SMALL, growth=1.4))[0]
    assert sum(count_folded_solids(block.nodes, BEZIER) for block in grid.blocks) == 0
    x, z, y = np.concatenate([nodes.reshape(-1, 3) for nodes, _ in wall(grid, "fuselage")]).T
    off = np.hypot((y - lift(x)) / 1.1, z / 0.95) - radius(x)
    assert np.abs(off).max() < 2e-3  # at the round nose; elsewhere it is as exact as its splines
    assert np.percentile(np.abs(off), 90) < 1e-5
