import numpy as np
import pytest
from format_shapes import c_grid, channel, ring

from meshonet.formats.mesh.unstructured import unstructured
from meshonet.geometry.blocks.grid import Grid

# nodes without doubles: all; one column less; the wake's nodes once less (its last node is the trailing edge)
EXPECTED = {"quad": 7 * 5, "o": 12 * 5, "c": (4 + 7 + 4) * 4 - 4}


@pytest.mark.parametrize("make", [channel, ring, c_grid])
def test_no_two_nodes_are_the_same_point(make: type[Grid]) -> None:
    mesh = unstructured(make())
    assert len(np.unique(mesh.points, axis=0)) == len(mesh.points) == EXPECTED[make().topology]


@pytest.mark.parametrize("make", [channel, ring, c_grid])
def test_the_quads_are_the_cells_in_order(make: type[Grid]) -> None:
    grid = make()
    mesh = unstructured(grid)
    corner = mesh.points[mesh.cells]
    cells = [grid.nodes[:-1, :-1], grid.nodes[1:, :-1], grid.nodes[1:, 1:], grid.nodes[:-1, 1:]]
    for k, cell in enumerate(cells):
        assert np.array_equal(corner[:, k], cell.swapaxes(0, 1).reshape(-1, 2))


@pytest.mark.parametrize("make", [channel, ring, c_grid])
def test_the_named_edges_are_all_edges_that_one_cell_has(make: type[Grid]) -> None:
    mesh = unstructured(make())
    sides = np.concatenate([mesh.cells[:, [k, (k + 1) % 4]] for k in range(4)])
    every, counts = np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)
    outer = {tuple(edge) for edge in every[counts == 1].tolist()}
    named = np.concatenate(list(mesh.faces.values()))
    assert {tuple(sorted(edge)) for edge in named.tolist()} == outer
    assert len(named) == len(outer)
    # as in its cell: the domain lies on the left
    assert {tuple(edge) for edge in named.tolist()} <= {tuple(edge) for edge in sides.tolist()}


def test_parts_keep_their_names_and_what_has_none_is_called_by_its_side() -> None:
    edges = unstructured(channel()).faces
    assert {name: len(edge) for name, edge in edges.items()} == {
        "no-slip wall": 3, "south": 3, "out let": 4, "north": 6, "inlet": 4,
    }  # fmt: skip


def test_the_cut_and_the_wake_belong_to_no_part() -> None:
    assert set(unstructured(ring()).faces) == {"airfoil", "far"}
    edges = unstructured(c_grid()).faces
    assert set(edges) == {"plate", "far side"}
    assert len(edges["plate"]) == 8
