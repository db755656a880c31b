import numpy as np
import pytest

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.transform import normalised
from meshonet.geometry.errors import InputError


def ellipse() -> Grid:
    """An O grid around an ellipse of chord 1, its trailing edge at (1, 0)."""
    angle = -np.linspace(0, 2 * np.pi, 25)
    reach = np.linspace(1, 5, 6)
    nodes = np.stack([np.outer(np.cos(angle), reach), 0.2 * np.outer(np.sin(angle), reach)], -1)
    nodes[-1] = nodes[0]
    return Grid.from_nodes(0.5 * nodes + (0.5, 0), "o")


def c_shape() -> Grid:
    """A C grid around the same ellipse."""
    body = ellipse().nodes[:, 0]
    wake = np.stack([np.linspace(2, 1, 5), np.zeros(5)], axis=1)
    south = np.concatenate([wake[:-1], body, wake[-2::-1]])
    north = south + 2 * np.stack([south[:, 0] * 0, np.linspace(-1, 1, len(south))], 1)
    return Grid.from_nodes(np.stack([south, north], axis=1), "c")


@pytest.mark.parametrize("make", [ellipse, c_shape])
def test_a_body_moved_turned_and_scaled_comes_back(make: type[Grid]) -> None:
    grid = make()
    turn = np.array([[0.6, 0.8], [-0.8, 0.6]])
    moved = Grid.from_nodes(7 * grid.nodes @ turn + (100, -3), grid.topology, grid.patches)
    back = normalised(moved)
    assert np.abs(back.nodes - grid.nodes).max() < 1e-13
    assert (back.topology, back.patches) == (grid.topology, grid.patches)


@pytest.mark.parametrize("make", [ellipse, c_shape])
def test_seams_stay_shut_bitwise(make: type[Grid]) -> None:
    grid = make()
    back = normalised(Grid.from_nodes(np.pi * grid.nodes + 0.1, grid.topology))
    if grid.topology == "o":
        assert np.array_equal(back.nodes[0], back.nodes[-1])
    else:
        assert np.array_equal(back.nodes[:5, 0], back.nodes[-5:, 0][::-1])


def test_a_body_without_length_is_refused() -> None:
    nodes = ellipse().nodes.copy()
    nodes[:, 0] = 3.0
    with pytest.raises(InputError, match="the body has no length; check that its side is the south one"):
        normalised(Grid.from_nodes(nodes, "o"))
