"""Blocks, patches and connections: one block, several, and three directions with the same types."""

import numpy as np
import pytest

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import Block, face_counts
from meshonet.geometry.blocks.connection import Connection, c_wake, o_seam
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError


def lattice(*counts: int, start: tuple[float, ...] = ()) -> Floats:
    """Nodes at whole numbers from `start` on."""
    nodes = np.stack(np.meshgrid(*(np.arange(float(n)) for n in counts), indexing="ij"), axis=-1)
    return nodes + np.array(start or (0.0,) * len(counts))


def two_blocks() -> Grid:
    """Beside each other in x; xi of the second runs along y, eta against x."""
    left = Block(lattice(5, 4))
    right = Block(lattice(3, 4, start=(4.0, 0.0)).swapaxes(0, 1)[:, ::-1])
    joint = Connection(0, "east", ((0, 3),), 1, "north", ((0, 3),), (1,))
    patches = Patch("inlet", "west", 0, 3), Patch("outlet", "south", 0, 3, block=1)
    return Grid((left, right), patches, (joint,), "pair")


def test_two_blocks_are_a_grid_whose_topology_is_its_connections() -> None:
    grid = two_blocks()
    assert (grid.topology, [patch.kind for patch in grid.patches]) == ("blocks", ["inlet", "outlet"])
    own, donor = grid.connections[0].nodes(grid.face)
    np.testing.assert_array_equal(own, donor)
    with pytest.raises(InputError, match="a grid of 2 blocks; take the nodes of its blocks one by one"):
        _ = grid.nodes


def test_a_connection_that_is_open_names_the_node() -> None:
    grid = two_blocks()
    moved = grid.blocks[1].nodes.copy()
    moved[2, -1] += 1e-12
    with pytest.raises(InputError, match=r"east of block 0 to north of block 1 is open.* at node 2 of east"):
        Grid((grid.blocks[0], Block(moved)), grid.patches, grid.connections)


def test_connections_of_unequal_counts_are_refused() -> None:
    grid = two_blocks()
    joint = Connection(0, "east", ((0, 3),), 1, "north", ((0, 2),), (1,))
    with pytest.raises(InputError, match=r"joins \(4,\) nodes to \(3,\)"):
        Grid(grid.blocks, (), (joint,))


@pytest.mark.parametrize(
    ("patch", "problem"),
    [
        (Patch("a", "south", 0, 5), "patch 'a' runs from node 0 to 5 of a side with 5 nodes"),
        (Patch("a", "south", 0, 2, block=2), "patch 'a' is on block 2 of 2"),
        (Patch("a", "top", 0, 2), "patch 'a' on side 'top' is not usable; name it and use west/east/south/"),
        (Patch("", "south", 0, 2), "patch '' on side 'south' is not usable"),
    ],
)
def test_patches_outside_their_side_are_refused(patch: Patch, problem: str) -> None:
    with pytest.raises(InputError, match=problem):
        Grid(two_blocks().blocks, (patch,))


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("swapped", [False, True])
def test_three_directions_use_the_same_types(swapped: bool, direction: int) -> None:
    low = lattice(4, 3, 5)
    high = lattice(4, 3, 2, start=(0.0, 0.0, 4.0))
    orientation = (1, 2)
    if swapped:
        high, orientation = high.swapaxes(0, 1), (2, 1)
    if direction < 0:
        high, orientation = high[::-1], tuple(-d if d == 1 else d for d in orientation)
    span = ((0, high.shape[0] - 1), (0, high.shape[1] - 1))
    joint = Connection(0, "top", ((0, 3), (0, 2)), 1, "bottom", span, orientation)
    patch = Patch("floor", "bottom", 1, 3, across=(0, 2))
    grid = Grid((Block(low), Block(high)), (patch,), (joint,))
    assert (grid.topology, grid.blocks[0].counts) == ("blocks", (4, 3, 5))
    assert patch.range(face_counts((4, 3, 5), "bottom")) == ((1, 3), (0, 2))
    assert patch.place == (2, 0)


def test_a_surface_in_space_is_a_block_of_two_directions() -> None:
    flat = lattice(4, 3)
    block = Block(np.concatenate([flat, flat[..., :1] ** 2], axis=-1))
    assert block.counts == (4, 3)
    assert block.face("north").shape == (4, 3)


@pytest.mark.parametrize("shape", [(3, 2), (4, 3, 4), (4, 3, 2, 2), (1, 3, 2), (4, 3, 1, 3)])
def test_other_shapes_are_no_blocks(shape: tuple[int, ...]) -> None:
    with pytest.raises(InputError, match="grid nodes have shape"):
        Block(np.zeros(shape))


def test_a_node_that_is_not_finite_is_named_in_three_directions() -> None:
    nodes = lattice(4, 3, 5)
    nodes[1, 2, 3, 0] = np.nan
    with pytest.raises(InputError, match="node i=1, j=2, k=3 is not finite"):
        Block(nodes)


@pytest.mark.parametrize(
    "motion", [Motion(shift=(3.0, 0.0)), Motion(shift=(3.0, 0.0), turn=((1.0, 0.0), (0.0, 1.0)))]
)
def test_periodic_sides_are_the_same_after_their_motion(motion: Motion) -> None:
    whole = ((0, 2),)
    joint = Connection(0, "west", whole, 0, "east", whole, (1,), motion)
    assert Grid((Block(lattice(4, 3)),), (), (joint,)).topology == "blocks"
    with pytest.raises(InputError, match="is open"):
        Grid((Block(lattice(5, 3)),), (), (joint,))


def test_o_and_c_are_names_of_connections() -> None:
    turn = -np.linspace(0, 2 * np.pi, 9)
    ring = np.array([1.0, 2.0])[None, :, None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1)[:, None]
    ring[-1] = ring[0]
    assert Grid.from_nodes(ring, "o").connections == (o_seam(2),)
    south = np.array([[2.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 0.0], [2.0, 0.0]])
    nodes = np.stack([south, south + np.linspace([0, -1], [0, 3], 5)], axis=1)
    grid = Grid.from_nodes(nodes, "c")
    assert (grid.connections, grid.topology, grid.wake) == ((c_wake(5, 1),), "c", 1)
    assert [(p.name, p.start, p.stop) for p in grid.outer_patches()][:1] == [("wall", 1, 3)]
    assert [patch.name for patch in grid.walls()] == ["wall"]


def test_a_side_that_cannot_be_printed_is_named_in_ascii() -> None:
    words = str(Connection(0, "west", ((0, 1),), 0, "\x85\ufffd", ((0, 1),), (1,)))  # type: ignore[arg-type]
    assert words == "the connection of west of block 0 to \\x85\\ufffd of block 0"
