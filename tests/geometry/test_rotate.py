import numpy as np
import pytest

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.blocks.transform import turned
from meshonet.geometry.errors import InputError


def lattice(ni: int = 5, nj: int = 3) -> Grid:
    """Node (i, j) at (i, j), with a patch on a piece of every side."""
    nodes = np.stack(np.meshgrid(np.arange(ni), np.arange(nj), indexing="ij"), axis=-1).astype(float)
    patches = (
        Patch("s", "south", 1, 2),
        Patch("n", "north", 0, 3),
        Patch("w", "west", 0, 1),
        Patch("e", "east", 1, 2),
    )
    return Grid.from_nodes(nodes, "quad", patches, "lattice")


def ends(grid: Grid, patch: Patch) -> set[tuple[float, ...]]:
    """Return the two points where a patch ends."""
    edges: dict[str, Floats] = {
        "south": grid.nodes[:, 0], "north": grid.nodes[:, -1], "west": grid.nodes[0], "east": grid.nodes[-1]
    }  # fmt: skip
    return {tuple(edges[patch.side][k].tolist()) for k in (patch.start, patch.stop)}


def test_parts_stay_where_they_are_and_the_grid_stays_right_handed() -> None:
    grid = lattice()
    other = turned(grid)
    assert (other.ni, other.nj, other.name) == (3, 5, "lattice")
    for old, new in zip(grid.patches, other.patches, strict=True):
        assert old.name == new.name
        assert ends(grid, old) == ends(other, new)
    u, v = other.nodes[1, 0] - other.nodes[0, 0], other.nodes[0, 1] - other.nodes[0, 0]
    assert u[0] * v[1] - u[1] * v[0] == 1


def test_four_turns_are_none() -> None:
    grid = lattice()
    back = turned(turned(turned(turned(grid))))
    assert np.array_equal(back.nodes, grid.nodes)
    assert back.patches == grid.patches


def test_a_grid_around_a_body_is_not_turned() -> None:
    angle = -np.linspace(0, 2 * np.pi, 9)
    nodes = np.stack([np.cos(angle)[:, None] * [1, 2], np.sin(angle)[:, None] * [1, 2]], axis=-1)
    nodes[-1] = nodes[0]
    with pytest.raises(InputError, match="topology o has xi around the body; swap four-sided grids only"):
        turned(Grid.from_nodes(nodes, "o"))
