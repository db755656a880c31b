import numpy as np
import pytest
from format_shapes import c_grid, channel, ring

from meshonet.formats.mesh.recover_topology import boundary_of, recovered
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError


def area(nodes: Floats) -> Floats:
    """Signed area of each cell by the shoelace formula."""
    a, b, c, d = nodes[:-1, :-1], nodes[1:, :-1], nodes[1:, 1:], nodes[:-1, 1:]
    total = np.zeros(a.shape[:2])
    for p, q in ((a, b), (b, c), (c, d), (d, a)):
        total += 0.5 * (p[..., 0] * q[..., 1] - q[..., 0] * p[..., 1])
    return total


@pytest.mark.parametrize("make", [channel, ring, c_grid])
def test_edges_are_the_outer_nodes_and_keep_topology_parts_and_name(make: type[Grid]) -> None:
    grid = make()
    edges = boundary_of(grid)
    assert np.array_equal(edges.south, grid.nodes[:, 0])
    assert np.array_equal(edges.north, grid.nodes[:, -1])
    assert np.array_equal(edges.west, grid.nodes[0])
    assert np.array_equal(edges.east, grid.nodes[-1])
    assert (edges.topology, edges.patches, edges.name) == (grid.topology, grid.patches, grid.name)


@pytest.mark.parametrize("turns", range(4))
@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("make", [channel, ring, c_grid])
def test_any_index_order_is_recovered(make: type[Grid], turns: int, mirrored: bool) -> None:
    grid = make()
    nodes = np.rot90(grid.nodes, turns, axes=(0, 1))
    nodes = nodes.swapaxes(0, 1) if mirrored else nodes
    back = recovered(nodes)
    assert back.topology == grid.topology
    assert (area(back.nodes) > 0).all()
    if grid.topology == "quad":
        return
    assert back.nodes.shape == grid.nodes.shape
    # a mirrored C or O grid may start at the other end of the body, but its body is the south side
    assert np.array_equal(np.unique(back.nodes[:, 0], axis=0), np.unique(grid.nodes[:, 0], axis=0))
    if grid.topology == "c":
        assert [part.name for part in back.patches].count("wake") == 2
        assert back.wake == 3


def test_a_right_handed_grid_keeps_its_index_order() -> None:
    for grid in (channel(), ring(), c_grid()):
        assert np.array_equal(recovered(grid.nodes).nodes, grid.nodes)


def test_a_seam_closed_to_rounding_is_closed_bitwise() -> None:
    nodes = ring().nodes.copy()
    nodes[-1] += 1e-9
    back = recovered(nodes)
    assert back.topology == "o"
    assert np.array_equal(back.nodes[-1], back.nodes[0])


def test_a_gap_is_no_seam() -> None:
    nodes = ring().nodes.copy()
    nodes[-1] += 1e-3
    assert recovered(nodes).topology == "quad"


@pytest.mark.parametrize("value", [np.nan, np.inf, -1e200])
def test_an_unusable_coordinate_is_named_with_its_node(value: float) -> None:
    nodes = channel().nodes.copy()
    nodes[2, 3, 1] = value
    with pytest.raises(InputError, match=r"node i=2, j=3 has y = .*; check the file"):
        recovered(nodes)
