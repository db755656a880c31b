"""Grids that follow a changed boundary."""

import numpy as np
import pytest

import meshonet
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError, NoValidGridError
from meshonet.geometry.quality.measure import count_folded
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.solvers.deformation.deform import deform
from meshonet.solvers.deformation.outer import NodeTable, first_heights
from meshonet.solvers.solution import Outcome


@pytest.fixture(scope="module")
def c_grid() -> Grid:
    return meshonet.grid("naca:0012", te="wedge", res=(121, 49), topology="c", y_plus=1, reynolds=6e6)


def change_of_first_cells(before: Grid, after: Grid, name: str = "wall") -> float:
    pieces = [piece for piece in NodeTable.of(before).pieces if piece.patch.name == name]
    return float(np.abs(first_heights(after, pieces) / first_heights(before, pieces) - 1.0).max())


def channel(stretch: float = 4.0) -> Grid:
    """A duct 3 long and 1 high, with thin cells at its south."""
    away = np.expm1(stretch * np.linspace(0, 1, 31)) / np.expm1(stretch)
    x, y = np.meshgrid(np.linspace(0, 3, 61), away, indexing="ij")
    return Grid.from_nodes(np.stack([x, y], axis=-1))


def bump(height: float, up: float = 0.0) -> Floats:
    x = np.linspace(0, 3, 61)
    return np.stack([x, up + height * np.exp(-(((x - 1.5) / 0.4) ** 2))], axis=1)


def volume() -> Grid:
    away = np.expm1(4 * np.linspace(0, 1, 13)) / np.expm1(4)
    nodes = np.stack(np.meshgrid(np.linspace(0, 3, 21), np.linspace(0, 1, 9), away, indexing="ij"), axis=-1)
    return Grid.from_nodes(nodes)


def two_blocks() -> Grid:
    """The channel cut in two, the second block beginning at the cut."""
    nodes = channel().nodes
    parts = nodes[:31], nodes[30:]
    whole = ((0, 30),)
    joined = Connection(0, "east", whole, 1, "west", whole, (1,))
    patches = [Patch("floor", "south", 0, 30, block=number) for number in (0, 1)]
    blocks = tuple(Grid.from_nodes(part).blocks[0] for part in parts)
    return Grid(blocks, tuple(patches), (joined,))


def test_a_new_section_keeps_first_cells_and_the_far_field(c_grid: Grid) -> None:
    made = deform(c_grid, meshonet.read("naca:2411"))
    assert made.outcome is Outcome.DONE
    assert count_folded(made.grid.nodes) == 0
    assert change_of_first_cells(c_grid, made.grid) < 1e-6
    assert np.array_equal(made.grid.nodes[:, -1], c_grid.nodes[:, -1])
    wall = slice(c_grid.wake, c_grid.ni - c_grid.wake)
    curve = Airfoil.wedged(meshonet.read("naca:2411")).curve  # type: ignore[arg-type]
    points = curve.at(np.linspace(0, curve.length, 20_000))
    apart = np.hypot(*(made.grid.nodes[wall, :1] - points).transpose(2, 0, 1))
    assert apart.min(axis=1).max() < 1e-4


def test_both_sides_of_the_wake_stay_one_line(c_grid: Grid) -> None:
    nodes = meshonet.deform(c_grid, "naca:4412").nodes
    wake = c_grid.wake + 1
    assert np.array_equal(nodes[:wake, 0], nodes[::-1, 0][:wake])


def test_the_same_outline_moves_hardly_anything(c_grid: Grid) -> None:
    moved = np.abs(meshonet.deform(c_grid, "naca:0012").nodes - c_grid.nodes).max()
    assert moved < 2e-4


def test_a_rigid_motion_of_the_wall_turns_its_layers(c_grid: Grid) -> None:
    turn = meshonet.rotation(7, about=(0.25, 0))
    made = meshonet.deform(c_grid, turn)
    layers = (slice(c_grid.wake + 1, c_grid.ni - c_grid.wake - 1), slice(0, 10))
    assert made.nodes[layers] == pytest.approx(turn(c_grid.nodes[layers]), abs=1e-7)
    assert count_folded(made.nodes) == 0


def test_nodes_of_another_grid_are_taken_bit_by_bit(c_grid: Grid) -> None:
    other = meshonet.grid("naca:2412", te="wedge", res=(121, 49), topology="c", y_plus=1, reynolds=6e6)
    made = meshonet.deform(c_grid, {"wall": other})
    wall = slice(c_grid.wake, c_grid.ni - c_grid.wake)
    assert np.array_equal(made.nodes[wall, 0], other.nodes[wall, 0])
    whole = meshonet.deform(channel(), channel(stretch=3.0))
    assert np.array_equal(whole.nodes[0], channel(stretch=3.0).nodes[0])


@pytest.mark.parametrize("nodes", [bump(0.2), bump(0.2)[::-1]])
def test_nodes_of_an_open_wall_are_taken_in_either_direction(nodes: Floats) -> None:
    made = meshonet.deform(channel(), {"south": nodes})
    assert np.array_equal(made.nodes[:, 0], bump(0.2))


def test_points_that_are_not_nodes_are_a_curve() -> None:
    curve = np.stack([np.linspace(0, 3, 16), np.full(16, 0.1)], axis=1)
    made = deform(channel(), {"south": curve})
    assert made.grid.nodes[:, 0] == pytest.approx(channel().nodes[:, 0] + [0, 0.1], abs=1e-12)


def test_straight_sides_slide_along_themselves_and_say_so() -> None:
    made = deform(channel(), {"south": bump(0.2, 0.1)})
    assert np.abs(made.grid.nodes[0, :, 0]).max() < 1e-15
    assert np.abs(made.grid.nodes[-1, :, 0] - 3).max() < 1e-15
    assert any("west slide along" in note for note in made.notes)
    assert change_of_first_cells(channel(), made.grid, "south") < 0.01


def test_large_moves_go_in_steps() -> None:
    made = deform(channel(), {"south": bump(0.6, 0.2)})
    assert count_folded(made.grid.nodes) == 0
    assert made.path[0].endswith("steps")


def test_blocks_stay_joined_bit_by_bit() -> None:
    made = deform(two_blocks(), {"floor": bump(0.2)})
    left, right = (block.nodes for block in made.grid.blocks)
    assert np.array_equal(left[-1], right[0])  # the grid would refuse otherwise, too
    single = meshonet.deform(channel(), {"south": bump(0.2)})
    assert left == pytest.approx(single.nodes[:31], abs=1e-3)  # far sides are grouped otherwise


def test_periodic_sides_stay_and_match() -> None:
    passage = channel()
    whole = ((0, 60),)
    up = Connection(0, "south", whole, 0, "north", whole, (1,), Motion((0.0, 1.0)))
    nodes = passage.nodes.copy()
    nodes[:, :, 1] = np.linspace(0, 1, 31)
    start = Grid(Grid.from_nodes(nodes).blocks, (Patch("end", "west", 0, 30),), (up,))
    end = nodes[0] + np.stack([0.2 * np.sin(np.pi * nodes[0, :, 1]), 0 * nodes[0, :, 1]], axis=1)
    with pytest.raises(InputError, match="ends on a periodic side"):
        meshonet.deform(start, {"end": end + np.array([0.1, 0])})
    end[[0, -1]] = nodes[0, [0, -1]]
    made = meshonet.deform(start, {"end": end})
    assert np.array_equal(made.nodes[:, 0], nodes[:, 0])
    assert np.array_equal(made.nodes[:, -1], nodes[:, -1])
    assert made.nodes[1, 15, 0] > nodes[1, 15, 0] + 0.15


def test_a_volume_follows_its_floor_and_keeps_flat_sides() -> None:
    start = volume()
    floor = start.nodes[:, :, 0].copy()
    floor[..., 2] += 0.2 * np.exp(-((floor[..., 0] - 1.5) ** 2 + floor[..., 1] ** 2) / 0.2)
    made = deform(start, {"bottom": floor})
    assert count_folded(made.grid.nodes) == 0
    assert np.array_equal(made.grid.nodes[:, :, 0], floor)
    assert not made.grid.nodes[:, 0, :, 1].any()
    assert change_of_first_cells(start, made.grid, "bottom") < 0.01


def test_a_volume_shifted_with_its_wall_is_turned_nowhere() -> None:
    start = volume()
    lower = meshonet.deform(start, {"bottom": Motion((0.0, 0.0, -0.1))})
    first = lower.nodes[:, :, 1] - lower.nodes[:, :, 0]
    assert first == pytest.approx(start.nodes[:, :, 1] - start.nodes[:, :, 0], abs=1e-4)


def test_rounded_and_blunt_edges_stay_what_they_are() -> None:
    for te in ("round", "exact"):
        start = meshonet.grid("naca:0012", res=(121, 31), te=te, first_cell=1e-4)
        made = deform(start, meshonet.read("naca:1412"))
        assert count_folded(made.grid.nodes) == 0
        assert change_of_first_cells(start, made.grid) < 0.01
        assert not made.path


def test_a_round_body_says_that_its_start_was_guessed() -> None:
    angle = np.linspace(0, 2 * np.pi, 200, endpoint=False)
    circle, oval = (np.stack([np.cos(angle), b * np.sin(angle)], axis=1) for b in (1.0, 0.8))
    start = meshonet.grid(circle, topology="o", res=(81, 31))
    made = deform(start, oval[::-1])
    assert any("guessed" in note for note in made.notes)
    x, y = made.grid.nodes[:, 0].T
    assert x**2 + (y / 0.8) ** 2 == pytest.approx(np.ones(81), abs=1e-6)


def test_corners_stay_corners() -> None:
    square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    start = meshonet.grid(square, topology="o", res=(81, 31))
    made = deform(start, square * [1.2, 0.9] + [0.1, 0])
    for corner in square * [1.2, 0.9] + [0.1, 0]:
        assert np.hypot(*(made.grid.nodes[:, 0] - corner).T).min() < 1e-12
    assert not any("guessed" in note for note in made.notes)


@pytest.mark.parametrize(
    ("wall", "says"),
    [
        ({"roof": bump(0.1)}, "has no 'roof'; name one of its boundary: south, east"),
        ({}, "no wall is named"),
        ({"south": Motion((0.0, 0.0, 1.0))}, "not in the plane of the grid; give 2 coordinates"),
        ({"south": bump(np.nan)}, "not finite"),
        ({"south": np.zeros((4, 3))}, "nodes of shape"),
        ({"south": bump(0.0, 0.1), "west": channel().nodes[0]}, "two walls put the node"),
        (bump(0.1), "2 walls: south, north; name one"),
    ],
)
def test_what_cannot_be_done_is_refused(wall: object, says: str) -> None:
    with pytest.raises(InputError, match=says):
        meshonet.deform(channel(), wall)  # type: ignore[arg-type]


def test_an_outline_that_crosses_itself_is_refused() -> None:
    loop = bump(0.2)
    loop[20:40] = loop[39:19:-1]
    with pytest.raises(InputError, match="crosses itself"):
        meshonet.deform(channel(), {"south": loop})


def test_a_base_with_a_block_behind_it_stays_a_base() -> None:
    start = meshonet.grid("naca:0012", res=(121, 31), topology="c", first_cell=1e-4)
    made = meshonet.deform(start, "naca:2412")
    base = made.blocks[1].nodes[0]
    (x, y), width = (base - base[0]).T, base[-1] - base[0]
    assert np.abs(x * width[1] - y * width[0]).max() < 1e-9  # straight
    assert np.hypot(*width) == pytest.approx(0.00252, rel=1e-3)


def test_a_sharp_outline_for_a_blunt_wall_is_refused(c_grid: Grid) -> None:
    start = meshonet.grid("naca:0012", res=(121, 31), te="exact")
    sharp = c_grid.nodes[c_grid.wake : c_grid.ni - c_grid.wake, 0]
    with pytest.raises(InputError, match="blunt trailing edge"):
        meshonet.deform(start, sharp[::2])


def test_a_folded_start_and_surfaces_are_refused() -> None:
    nodes = channel().nodes.copy()
    nodes[3, 5] = nodes[6, 5]
    with pytest.raises(InputError, match="starting grid are folded"):
        meshonet.deform(Grid.from_nodes(nodes), {"south": bump(0.1)})
    surface = Grid.from_nodes(np.pad(channel().nodes, ((0, 0), (0, 0), (0, 1))))
    with pytest.raises(InputError, match="surface"):
        meshonet.deform(surface, {"south": bump(0.1)})


def test_a_wall_through_the_other_one_is_refused_with_the_place() -> None:
    with pytest.raises(InputError, match=r"south and north cross at \(1\.2\d+, 1\); keep them apart"):
        meshonet.deform(channel(), {"south": bump(1.4)})


def test_moves_that_no_grid_follows_end_in_an_error_with_places() -> None:
    coarse = Grid.from_nodes(channel().nodes[::6, ::6])
    with pytest.raises(NoValidGridError, match=r"folded; go part of the way .* worst cells"):
        meshonet.deform(coarse, {"south": meshonet.rotation(180, about=(1.5, 0))})


def test_chains_of_small_moves_hold(c_grid: Grid) -> None:
    made = c_grid
    for camber in (1, 2, 3):
        made = meshonet.deform(made, f"naca:{camber}412")
    assert change_of_first_cells(c_grid, made) < 1e-5
    assert count_folded(made.nodes) == 0
