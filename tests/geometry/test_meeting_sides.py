"""Interfaces of blocks in space found by position: faces, parts, seams, axes, copies, edges of surfaces."""

from dataclasses import replace

import numpy as np
import pytest
from space_grids import lattice, pipe, sphere_patches, turned

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import PLACES, Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.find_connections import find_connections
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.shared_nodes import shared_nodes, with_equal_nodes
from meshonet.geometry.errors import InputError


def joined(nodes: list[Floats]) -> Grid:
    """The grid of these blocks with what is found of connections; it checks that their nodes are the same."""
    blocks = [Block(each) for each in nodes]
    connections = find_connections(blocks)
    return Grid(with_equal_nodes(blocks, connections), (), connections)


@pytest.mark.slow
@pytest.mark.parametrize("first", range(24))
def test_a_face_is_joined_however_both_blocks_are_counted(first: int) -> None:
    own = turned(lattice((0, 1, 4), (0, 1, 3), (0, 1, 5)), first)
    for second in range(24):
        grid = joined([own, turned(lattice((1, 2, 3), (0, 1, 3), (0, 1, 5)), second)])
        (joint,) = grid.connections
        assert sorted(b - a + 1 for a, b in joint.range) == [3, 5]
        assert len(np.unique(np.concatenate(list(map(np.ravel, _numbers(grid)))))) == 60 + 45 - 15


def _numbers(grid: Grid) -> tuple[np.ndarray, ...]:
    return shared_nodes([block.counts for block in grid.blocks], grid.connections)


def test_eight_blocks_of_a_cube_share_twelve_faces_and_their_nodes() -> None:
    spans = [(0.0, 1.0, 4), (1.0, 2.5, 3)]
    nodes = [turned(lattice(a, b, c), 5 * k) for k, (a, b, c) in enumerate(
        (a, b, c) for a in spans for b in spans for c in spans
    )]  # fmt: skip
    grid = joined(nodes)
    assert len(grid.connections) == 12
    assert max(int(number.max()) for number in _numbers(grid)) + 1 == 6**3


def test_a_part_of_a_face_is_joined() -> None:
    grid = joined(
        [lattice((0, 4, 9), (0, 3, 7), (0, 1, 3)), turned(lattice((1, 2, 3), (1, 3, 5), (1, 2, 4)), 7)]
    )
    (joint,) = grid.connections
    assert (joint.block, joint.side, joint.range) == (0, "top", ((2, 4), (2, 6)))


def test_a_face_may_be_joined_to_several_blocks() -> None:
    over = [lattice((a, a + 1, 3), (0, 1, 3), (1, 2, 2)) for a in (0, 1, 3)]
    result = find_connections([Block(each) for each in (lattice((0, 4, 9), (0, 1, 3), (0, 1, 3)), *over)])
    assert [(c.range[0], c.donor) for c in result if c.block == 0] == [((0, 2), 1), ((2, 4), 2), ((6, 8), 3)]
    assert [(c.block, c.donor, c.side) for c in result if c.block] == [(1, 2, "east")]


def test_a_seam_joins_a_block_to_itself_and_an_axis_joins_nothing() -> None:
    seam = Connection(0, "south", ((0, 4), (0, 3)), 0, "north", ((0, 4), (0, 3)), (1, 2))
    for inner in (0.0, 0.2):
        assert joined([pipe(inner=inner)]).connections == (seam,)


def test_the_cut_of_a_c_block_is_joined_to_itself() -> None:
    x = np.array([3, 2, 1, 0, 1, 2, 3.0])
    around = np.array([[3, -1], [1, -1], [-1, -1], [-1, 0], [-1, 1], [1, 1], [3, 1.0]])
    plane = np.stack([np.stack([x, 0 * x], axis=-1), around], axis=1)
    z = np.linspace(0, 1, 3)[:, None]
    nodes = np.concatenate(
        [np.broadcast_to(plane[:, :, None], (7, 2, 3, 2)), np.broadcast_to(z, (7, 2, 3, 1))], -1
    )
    assert find_connections([Block(nodes)]) == (
        Connection(0, "south", ((0, 3), (0, 2)), 0, "south", ((3, 6), (0, 2)), (-1, 2)),
    )


def test_copies_are_not_joined_and_a_gap_of_a_thousandth_of_a_cell_stays_open() -> None:
    cube = lattice((0, 1, 4), (0, 1, 4), (0, 1, 4))
    assert find_connections([Block(cube), Block(cube)]) == ()
    apart = [Block(cube), Block(cube + np.array([1.0003, 0, 0]))]
    assert find_connections(apart) == ()
    assert len(find_connections(apart, 1e-2)) == 1


@pytest.mark.parametrize("form", ["float32", "%.5e", "%.5f"])
def test_faces_that_were_computed_twice_and_rounded_become_equal(form: str) -> None:
    noise = np.random.default_rng(0)

    def written(nodes: Floats) -> Floats:
        values = (nodes * (1 + 1e-9 * noise.uniform(-1, 1, nodes.shape)) + 10 / 3).ravel()
        if form == "float32":
            return values.astype(np.float32).astype(float).reshape(nodes.shape)
        return np.array([float(form % value) for value in values]).reshape(nodes.shape)

    grid = joined([written(pipe(inner=0.2)), written(pipe(inner=0.2) + np.array([0, 0, 2]))])
    assert [(c.block, c.side, c.donor) for c in grid.connections] == [
        (0, "south", 0), (0, "top", 1), (1, "south", 1),
    ]  # fmt: skip


def test_parts_known_to_be_boundaries_are_left_out() -> None:
    blocks = [Block(lattice((a, a + 1, 3), (0, 1, 5), (0, 1, 3))) for a in (0, 1)]
    result = find_connections(blocks, without=[(1, "west", ((0, 2), (0, 2)))])
    assert [c.range for c in result] == [((2, 4), (0, 2))]
    whole = [(0, side, ((0, 2), (0, 2))) for side in PLACES]
    cube = Block(lattice(*[(0, 1, 3)] * 3))
    assert find_connections([cube], without=whole) == ()


def test_patches_of_a_closed_surface_share_all_edges() -> None:
    grid = joined(sphere_patches())
    assert len(grid.connections) == 12
    numbers = _numbers(grid)
    assert max(int(number.max()) for number in numbers) + 1 == 6 * 9 + 12 * 3 + 8
    assert grid.form == "surface"
    assert not grid.outer_patches()


def test_a_patch_may_meet_itself_and_end_in_a_point() -> None:
    r, t = np.meshgrid(np.linspace(0, 1, 4), np.linspace(0, 2 * np.pi, 9), indexing="ij")
    cone = np.stack([r * np.cos(t), r * np.sin(t), r], axis=-1)
    whole = ((0, 3),)
    assert find_connections([Block(cone)]) == (Connection(0, "south", whole, 0, "north", whole, (1,)),)


def test_reversed_connections_say_the_same() -> None:
    grid = joined([pipe(inner=0.2), turned(pipe(inner=0.2) + np.array([0, 0, 2]), 11)])
    assert replace(grid, connections=tuple(each.reversed() for each in grid.connections)).blocks


def test_patches_are_joined_to_patches_and_volumes_to_volumes() -> None:
    cubes = [Block(lattice((a, a + 1, 3), (0, 1, 3), (0, 1, 3))) for a in (0, 1)]
    patches = [Block(block.face("top")) for block in cubes]
    mixed = [cubes[0], patches[0], cubes[1], patches[1]]
    assert [(c.block, c.side, c.donor) for c in find_connections(mixed)] == [(0, "east", 2), (1, "east", 3)]
    with pytest.raises(InputError, match="block 0 is a volume and block 1 is a surface patch; keep them in"):
        Grid((cubes[0], patches[0]))
    with pytest.raises(InputError, match="block 1 has no z, others have; give all of them two coordinates"):
        find_connections([cubes[0], Block(patches[0].nodes[..., :2])])
