"""Planar blocks repeated in z: their volume, their patches and connections, and the way back."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from block_grids import butterfly, duct, o_ring

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.extrude import extruded, plane_of_extruded
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.blocks.screw import screw_of
from meshonet.geometry.errors import InputError

HEIGHTS = (0.5, 1.0, 3.0)


def ring(*patches: Patch) -> Grid:
    """An O grid of 12 x 4 cells between circles of radius 1 and 4."""
    angle = -np.linspace(0, 2 * np.pi, 13)
    nodes = np.geomspace(1, 4, 5)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)[:, None]
    nodes[-1] = nodes[0]
    return Grid.from_nodes(nodes, "o", patches)


@pytest.mark.parametrize("make", [butterfly, duct, o_ring, ring])
def test_every_block_is_its_plane_at_each_height_and_right_handed(make: Callable[[], Grid]) -> None:
    grid = make()
    made = extruded(grid, HEIGHTS)
    assert len(made.blocks) == len(grid.blocks)
    for block, plane in zip(made.blocks, grid.blocks, strict=True):
        assert block.counts == (*plane.counts, 3)
        for k, z in enumerate(HEIGHTS):
            assert np.array_equal(block.nodes[:, :, k, :2], plane.nodes)
            assert (block.nodes[:, :, k, 2] == z).all()
        base, ends = (
            block.nodes[:-1, :-1, :-1],
            (np.s_[1:, :-1, :-1], np.s_[:-1, 1:, :-1], np.s_[:-1, :-1, 1:]),
        )
        a, b, c = (block.nodes[end] - base for end in ends)
        assert (np.cross(a, b) * c).sum(axis=-1).min() > 0


@pytest.mark.parametrize("make", [butterfly, duct, o_ring, ring])
def test_the_outer_cells_are_those_of_the_plane_times_layers_and_two_planes(make: Callable[[], Grid]) -> None:
    grid = make()
    sizes: dict[str, int] = {}
    for patch in extruded(grid, HEIGHTS).outer_patches():
        assert patch.across is not None
        cells = (patch.stop - patch.start) * (patch.across[1] - patch.across[0])
        sizes[patch.name] = sizes.get(patch.name, 0) + cells
    plane: dict[str, int] = {}
    for patch in grid.outer_patches():
        plane[patch.name] = plane.get(patch.name, 0) + 2 * (patch.stop - patch.start)
    whole = sum(int(np.prod([n - 1 for n in block.counts])) for block in grid.blocks)
    assert sizes == {**plane, "back": whole, "front": whole}


@pytest.mark.parametrize("make", [butterfly, duct, o_ring, ring])
def test_the_way_back_gives_the_plane(make: Callable[[], Grid]) -> None:
    grid = make()
    flat = plane_of_extruded(extruded(grid, HEIGHTS))
    assert flat is not None
    assert (flat.connections, flat.patches, flat.topology) == (grid.connections, grid.patches, grid.topology)
    for block, plane in zip(flat.blocks, grid.blocks, strict=True):
        assert np.array_equal(block.nodes, plane.nodes)


def test_a_volume_that_is_no_copy_of_a_plane_has_no_way_back() -> None:
    made = extruded(duct(), HEIGHTS)
    assert plane_of_extruded(Grid(made.blocks, made.patches[:-2], made.connections)) is None
    nodes = [block.nodes.copy(order="K") for block in made.blocks]
    for each in nodes:
        each[..., 0] += 0.1 * each[..., 2]
    sheared = Grid(tuple(Block(each) for each in nodes), made.patches, made.connections)
    assert plane_of_extruded(sheared) is None
    assert plane_of_extruded(duct()) is None


def test_bodies_stay_walls_and_names_of_the_planes_stay_theirs() -> None:
    made = extruded(ring(Patch("front", "south", 0, 12), Patch("far", "north", 0, 12)), HEIGHTS)
    assert {(p.name, p.side, p.kind) for p in made.patches} == {
        ("front-2", "south", "wall"), ("far", "north", "farfield"),
        ("back", "bottom", "symmetry"), ("front", "top", "symmetry"),
    }  # fmt: skip


def test_periodic_sides_are_moved_as_in_the_plane() -> None:
    c, s = float(np.cos(0.5)), float(np.sin(0.5))
    motion = Motion((0.25, -1.0), ((c, -s), (s, c)))
    grid = ring()
    (seam,) = grid.connections
    nodes = grid.nodes[:4].copy()
    nodes[-1] = motion(nodes[0])
    sector = Grid((Block(nodes),), (), (replace(seam, transform=motion),))
    (thick,) = extruded(sector, HEIGHTS).connections
    assert thick.transform is not None
    point = np.array([[0.3, 0.4, 0.7]])
    np.testing.assert_array_equal(thick.transform(point)[:, :2], motion(point[:, :2]))
    assert thick.transform(point)[0, 2] == 0.7
    angle, axis, centre, shift, angles = screw_of(thick.transform)
    assert not shift.any()
    assert angles.tolist() == [0.0, 0.0, angle]
    assert (angle, axis.tolist()) == (pytest.approx(0.5), [0.0, 0.0, 1.0])
    np.testing.assert_allclose(centre[:2], motion.rotation[1], atol=1e-14)


def rotation(axis: Floats, angle: float) -> Floats:
    """Return Rodrigues' formula."""
    cross = np.cross(np.eye(3), axis)  # times a vector: the axis times it
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


@pytest.mark.parametrize("angle", [0.3, 2.0, np.pi])
def test_the_axis_of_a_motion_is_what_it_leaves_in_place(angle: float) -> None:
    rng = np.random.default_rng(1)
    axis, centre = rng.normal(size=3), rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    turn = rotation(axis, angle)
    shift = centre - turn @ centre
    motion = Motion(tuple(shift.tolist()), tuple(map(tuple, turn.tolist())))
    result, along, place, rest, angles = screw_of(motion)
    sign = np.sign(along @ axis)
    assert sign * result == pytest.approx(angle) or abs(result) == pytest.approx(np.pi)
    assert along[np.argmax(np.abs(along))] > 0
    np.testing.assert_allclose(motion(place[None])[0], place, atol=1e-12)
    np.testing.assert_allclose(sign * along, axis, atol=1e-7)
    np.testing.assert_allclose(rest, 0, atol=1e-12)
    x, y, z = (rotation(np.eye(3)[k], each) for k, each in enumerate(angles))
    np.testing.assert_allclose(z @ y @ x, turn, atol=1e-12)


@pytest.mark.parametrize("heights", [(), (1.0,), (0.0, 0.0), (1.0, 0.0), (0.0, float("nan"))])
def test_heights_that_do_not_increase_are_refused(heights: tuple[float, ...]) -> None:
    with pytest.raises(InputError, match="do not increase; give two or more"):
        extruded(duct(), heights)


def test_only_planar_blocks_are_extruded() -> None:
    with pytest.raises(InputError, match=r"block 0 of .* is not in the plane"):
        extruded(extruded(duct(), HEIGHTS), HEIGHTS)
