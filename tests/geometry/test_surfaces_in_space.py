"""Surfaces: one node table, which way is out, and faults refused with their place."""

import sys
from pathlib import Path

import numpy as np
import pytest

from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError
from meshonet.geometry.surface.surface import Surface, surface_of

sys.path.append(str(Path(__file__).parents[1] / "solvers"))
from surface_shapes import cube, cylinder, grid_of, half_sphere, plate, room_corner, sphere, wing


def enclosed(surface: Surface) -> float:
    """Volume by the divergence theorem, of two triangles a face."""
    a, b, c, d = (surface.nodes[surface.quads[:, k]] for k in range(4))
    return float(sum((np.cross(q - p, r - p) * p).sum() for p, q, r in ((a, b, c), (a, c, d))) / 6.0)


def euler(surface: Surface) -> int:
    quads = np.sort(np.stack([surface.quads, np.roll(surface.quads, -1, axis=1)], axis=-1), axis=-1)
    return len(surface.nodes) - len(np.unique(quads.reshape(-1, 2), axis=0)) + len(surface.quads)


@pytest.mark.parametrize("patches", [cube(6), sphere(6), cylinder(8)])
def test_a_closed_surface_has_the_characteristic_of_a_ball_and_no_open_edges(patches: list[Floats]) -> None:
    surface = surface_of(grid_of(patches))
    assert euler(surface) == 2
    assert not len(surface.open_edges)
    assert surface.notes == ()


def test_nodes_on_edges_and_corners_are_one() -> None:
    surface = surface_of(grid_of(cube(6)))
    assert len(surface.nodes) == 6 * 7 * 7 - 12 * 7 + 8
    assert np.bincount(surface.valence).tolist() == [0, 0, 0, 8, len(surface.nodes) - 8]


def test_neighbours_are_in_order_counter_clockwise_from_outside() -> None:
    surface = surface_of(grid_of(sphere(6)))
    for node, ring in enumerate(surface.ring):
        x = surface.nodes[node]
        around = surface.nodes[ring[ring >= 0]] - x
        turns = np.cross(around, np.roll(around, -1, axis=0)) @ x
        assert (turns > 0).all()


def test_edge_nodes_within_a_hundred_millionth_of_the_size_are_one() -> None:
    patches = cube(6)
    patches[0] = patches[0] + 1e-9 * np.random.default_rng(0).uniform(-1.0, 1.0, patches[0].shape)
    assert euler(surface_of(grid_of(patches))) == 2


@pytest.mark.parametrize("flipped", [(), (2,), (0, 3, 5), (0, 1, 2, 3, 4, 5)])
def test_patches_that_face_inwards_are_turned_round(flipped: tuple[int, ...]) -> None:
    patches = [p[:, ::-1] if k in flipped else p for k, p in enumerate(cube(4))]
    surface = surface_of(grid_of(patches))
    assert enclosed(surface) == pytest.approx(8.0, rel=1e-12)
    assert bool(surface.notes) == bool(flipped)
    for k in flipped if len(flipped) < 6 else ():
        assert str(k) in surface.notes[0]


def test_half_a_body_on_a_plane_faces_outwards_and_shows_its_plane() -> None:
    surface = surface_of(grid_of([patch[::-1] for patch in half_sphere(6)]))
    assert [str(plane) for plane in surface.planes] == ["z = 0"]
    assert enclosed(surface) > 0.0


@pytest.mark.parametrize("sweep", [0.5, 0.0, -0.2])
def test_a_wing_shows_the_plane_of_its_root_and_not_that_of_its_blunt_edge(sweep: float) -> None:
    surface = surface_of(grid_of(wing(sweep=sweep)))
    assert [str(plane) for plane in surface.planes] == ["z = 0"]
    assert set(np.bincount(surface.valence).nonzero()[0]) <= {2, 3, 4, 5}


def test_what_encloses_nothing_faces_as_its_patches_do() -> None:
    for patches, normal in ((plate(4), 1.0), ([plate(4)[0][::-1]], -1.0)):
        surface = surface_of(grid_of(patches))
        a, b, _, d = (surface.nodes[surface.quads[0, k]] for k in range(4))
        assert np.sign(np.cross(b - a, d - a)[2]) == normal
        assert "encloses nothing" in surface.notes[0]


def test_a_room_keeps_the_side_its_walls_face() -> None:
    surface = surface_of(grid_of(room_corner(4, 3)))
    a, b, _, d = (surface.nodes[surface.quads[:, k]] for k in range(4))
    assert (np.cross(b - a, d - a) >= 0.0).all()


def refused(patches: list[Floats]) -> str:
    with pytest.raises(InputError) as error:
        surface_of(grid_of(patches))
    text = str(error.value)
    assert "\n" not in text
    return text


def test_a_gap_is_refused_with_both_patches() -> None:
    patches = cube(6)
    patches[2] = patches[2] + np.array([0.0, 1e-6, 0.0])
    text = refused(patches)
    assert "gap of 1e-06" in text
    assert "patch 2" in text
    assert "x=" in text


def test_an_edge_of_three_faces_is_refused_with_its_place() -> None:
    s, t = np.meshgrid(np.linspace(-1.0, 1.0, 7), np.linspace(1.0, 2.0, 4), indexing="ij")
    fin = np.stack([s, t, np.ones_like(s)], axis=-1)  # on the edge y = z = 1
    text = refused([*cube(6), fin])
    assert "three faces" in text
    assert "patches 0, 3, 5, 6" in text
    assert "y=1, z=1" in text


def test_a_patch_that_is_there_twice_is_refused() -> None:
    assert "three faces" in refused([*cube(4), cube(4)[1]])


def test_a_pole_is_refused_with_its_side() -> None:
    angle, height = np.meshgrid(np.linspace(0, 2 * np.pi, 13), np.linspace(0, 1, 5), indexing="ij")
    cone = np.stack([(1 - height) * np.cos(angle), (1 - height) * np.sin(angle), height], axis=-1)
    cone[-1] = cone[0]
    with pytest.raises(InputError) as error:
        surface_of(grid_of([cone]), poles="refuse")
    text = str(error.value)
    assert "north side of patch 0 is a single point" in text


def test_an_edge_of_no_length_is_refused() -> None:
    patch = plate(6)[0]
    patch[3, 0] = patch[2, 0]
    assert "no length" in refused([patch])


def test_a_patch_inside_that_touches_edges_in_nodes_is_refused() -> None:
    s, t = np.meshgrid(np.linspace(-1, 1, 7), np.linspace(-1, 1, 7), indexing="ij")
    assert "single node" in refused([*cube(6), np.stack([s, t, 0.0 * s], axis=-1)])


def test_sheets_that_touch_in_a_node_are_refused() -> None:
    patch = plate(4)[0]
    text = refused([patch, patch - np.array([1.0, 1.0, 0.0])])
    assert "single node" in text


def test_a_band_with_one_side_is_refused() -> None:
    t, s = np.meshgrid(np.linspace(0, 2 * np.pi, 25), np.linspace(-0.3, 0.3, 5), indexing="ij")
    r = 1 + s * np.cos(t / 2)
    band = np.stack([r * np.cos(t), r * np.sin(t), s * np.sin(t / 2)], axis=-1)
    band[-1] = band[0, ::-1]
    assert "one side only" in refused([band[:13], band[12:]])


def test_blocks_that_are_no_patches_are_refused() -> None:
    from meshonet.geometry.blocks.grid import Grid

    with pytest.raises(InputError, match="made of patches"):
        surface_of(Grid.from_nodes(np.random.default_rng(0).random((4, 4, 2))))
