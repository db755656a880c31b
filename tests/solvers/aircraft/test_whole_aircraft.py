"""Grids around a whole aircraft: the half and its mirror image, joined in the plane of symmetry."""

from dataclasses import replace

import numpy as np
import pytest
from aircraft_shapes import aircraft, unclaimed_faces

from meshonet.geometry.blocks.block import face_of
from meshonet.geometry.blocks.find_connections import find_connections
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.handedness import signed_volume
from meshonet.geometry.blocks.wall_surface import wall_surface
from meshonet.geometry.quality.volumes import BEZIER, count_folded_solids
from meshonet.solvers.aircraft.aircraft_grid import aircraft_grid
from meshonet.solvers.aircraft.request import AircraftRequest

SMALL = AircraftRequest(around=49, span=9, first_cell=2e-3, growth=1.4, far_field=8.0)


@pytest.fixture(scope="module")
def half() -> Grid:
    return aircraft_grid(aircraft(), SMALL)[0]


@pytest.fixture(scope="module")
def whole() -> Grid:
    return aircraft_grid(replace(aircraft(), half=False), SMALL)[0]


def volume(grid: Grid) -> float:
    return sum(signed_volume([block.nodes[..., axis] for axis in range(3)]) for block in grid.blocks)


def test_no_cell_is_folded_and_the_volume_is_twice_that_of_the_half(half: Grid, whole: Grid) -> None:
    assert sum(count_folded_solids(block.nodes, BEZIER) for block in whole.blocks) == 0
    assert volume(whole) == pytest.approx(2.0 * volume(half), rel=1e-12)


def test_the_first_half_is_the_half_and_the_second_its_mirror_image(half: Grid, whole: Grid) -> None:
    count = len(half.blocks)
    assert len(whole.blocks) == 2 * count
    for own, first, second in zip(half.blocks, whole.blocks, whole.blocks[count:], strict=False):
        assert np.array_equal(own.nodes, first.nodes)
        assert np.array_equal(own.nodes[::-1] * [1.0, 1.0, -1.0], second.nodes)


def test_both_halves_are_joined_by_exactly_equal_nodes_where_the_half_ended(half: Grid, whole: Grid) -> None:
    for connection in whole.connections:
        connection.check(whole.face)
    count = len(half.blocks)
    across = [each for each in whole.connections if each.block < count <= each.donor]
    plane = [(patch.block, patch.side) for patch in half.patches if patch.name == "symmetry"]
    assert [(each.block, each.side) for each in across] == plane
    zeros = [face_of(whole.blocks[block].nodes[..., 2], side) for block, side in plane]
    assert not any(np.signbit(face).any() or face.any() for face in zeros)


def test_the_connections_are_those_that_a_search_finds(whole: Grid) -> None:
    def ends(connections: object) -> set[frozenset[object]]:
        return {frozenset(each.ends) for each in connections}  # type: ignore[attr-defined]

    assert ends(whole.connections) == ends(find_connections(whole.blocks))


def test_every_face_is_in_a_patch_or_joined_to_another(whole: Grid) -> None:
    assert unclaimed_faces(whole) == 0
    assert {patch.name for patch in whole.patches} == {"fuselage", "wing", "tip", "farfield"}


def test_patches_of_the_same_name_are_on_both_sides(half: Grid, whole: Grid) -> None:
    for name in ("fuselage", "wing", "tip", "farfield"):
        own, both = (
            [grid.at(patch).reshape(-1, 3) for patch in grid.patches if patch.name == name]
            for grid in (half, whole)
        )
        nodes = np.concatenate(own)
        expected = np.concatenate([nodes, nodes * [1.0, 1.0, -1.0]])
        made = np.concatenate(both)
        assert np.array_equal(*(np.sort(each + 0.0, axis=0) for each in (expected, made)))


def test_first_cells_are_exact_on_both_sides(whole: Grid) -> None:
    for patch in whole.patches:
        if patch.kind == "wall":
            nodes = whole.blocks[patch.block].nodes
            if patch.side == "south":
                assert patch.across is not None
                nodes = np.moveaxis(nodes[:, :, patch.across[0] : patch.across[1] + 1], 1, 2)
            first = np.linalg.norm(nodes[:, :, 1] - nodes[:, :, 0], axis=-1)
            assert first == pytest.approx(SMALL.height() * 2.0, rel=1e-9)


def test_its_surface_is_closed(whole: Grid) -> None:
    surface = wall_surface(whole)
    assert not surface.patches
    edges = sum(2 * (a - 1 + b - 1) for a, b in (block.counts for block in surface.blocks))
    assert sum(2 * (b - a) for each in surface.connections for a, b in each.range) == edges
    assert set(surface.provenance["zones"]) == {"fuselage", "wing", "tip"}


def test_the_number_of_cells_is_that_of_both_halves() -> None:
    request = AircraftRequest.of(cells=400_000, span=9, first_cell=1e-2, growth=1.4, far_field=8.0)
    made, _, notes = aircraft_grid(replace(aircraft(), half=False), request)
    cells = sum(int(np.prod([count - 1 for count in block.counts])) for block in made.blocks)
    assert cells == pytest.approx(400_000, rel=0.2), notes
