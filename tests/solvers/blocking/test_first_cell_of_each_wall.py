"""Walls with first cells of their own, measured on grids: rings, sides, corners where two of them meet."""

from typing import Any

import numpy as np
import pytest

import meshonet
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.errors import InputError
from meshonet.solvers.blocking.decomposition.symmetry.mirrors import mirrors_of

BOX = np.array([[0.0, 0.0], [6.0, 0.0], [6.0, 3.0], [0.0, 3.0]])
SIDES = ["floor", "outlet", "roof", "inlet"]


def tube(x: float, y: float, radius: float = 0.5) -> np.ndarray:
    turn = 2 * np.pi * np.arange(60) / 60
    return np.stack([x + radius * np.cos(turn), y + radius * np.sin(turn)], axis=1)


CHANNEL = Domain.of_polygons([BOX, tube(2, 1.5), tube(4, 1.5)], names=[SIDES, "one", "two"])


def heights(grid: meshonet.Grid) -> dict[str, np.ndarray]:
    """Distances of the nodes next to each patch from its own ones, by its name."""
    results: dict[str, list[np.ndarray]] = {}
    for patch in grid.patches:
        nodes = grid.blocks[patch.block].nodes
        rows = {"south": (0, 1), "north": (-1, -2)}.get(patch.side)
        wall, beside = (nodes[:, rows[0]], nodes[:, rows[1]]) if rows else (
            (nodes[0], nodes[1]) if patch.side == "west" else (nodes[-1], nodes[-2])
        )  # fmt: skip
        part = slice(patch.start, patch.stop + 1)
        results.setdefault(patch.name, []).append(np.hypot(*(beside - wall)[part].T))
    return {name: np.concatenate(each) for name, each in results.items()}


@pytest.mark.parametrize(
    "given",
    [
        {"one": 1e-3, "two": 5e-3},
        {"one": 2e-3, "floor": 1e-3, "roof": 4e-3},
        {"floor": 1e-3, "inlet": 6e-3},
    ],
    ids=["tubes", "a tube and two sides", "sides that meet at a corner"],
)
def test_each_wall_has_the_first_cells_given_for_it(given: dict[str, float]) -> None:
    grid = meshonet.grid(CHANNEL, first_cell=given, cells=4000)
    assert grid.quality().folded == 0
    result = heights(grid)
    for name, first in given.items():
        np.testing.assert_allclose(result[name], first, rtol=1e-6)
    assert min(result["outlet"]) > 2 * max(given.values())  # which has none


def test_without_holes_the_walls_are_the_sides_that_no_name_says_are_none() -> None:
    duct = Domain.of_polygons([BOX], names=[SIDES])
    grid = meshonet.grid(duct, first_cell=1e-3, cells=2000)
    result = heights(grid)
    for name in ("floor", "roof"):
        np.testing.assert_allclose(result[name], 1e-3, rtol=1e-6)
    assert min(*result["inlet"], *result["outlet"]) > 1e-2
    assert {patch.name for patch in grid.walls()} == {"floor", "roof"}
    with pytest.raises(InputError, match="name the walls"):
        meshonet.grid(Domain.of_polygons([BOX]), first_cell=1e-3, cells=2000)


@pytest.mark.parametrize(
    "layers",
    [
        {"first_cell": {"floor": 1e-2, "inlet": 2e-2}},
        {"first_cell": 1e-2, "walls": ("floor", "inlet")},
    ],
    ids=["heights", "walls"],
)
def test_a_side_with_layers_is_a_wall_unless_its_name_says_otherwise(layers: dict[str, Any]) -> None:
    grid = meshonet.grid(CHANNEL, **layers, cells=3000)
    kinds = {patch.name: patch.kind for patch in grid.outer_patches()}
    tubes = {"one": "wall", "two": "wall"}
    assert kinds == {"floor": "wall", "roof": "other", "inlet": "inlet", "outlet": "outlet", **tubes}


def test_mirror_images_keep_unlike_first_cells_and_share_like_ones() -> None:
    tops = Domain.of_polygons([BOX, tube(3, 0.8), tube(3, 2.2)], names=[SIDES, "low", "high"])
    unlike = heights(meshonet.grid(tops, first_cell={"low": 1e-3, "high": 4e-3}, cells=4000))
    np.testing.assert_allclose(unlike["low"], 1e-3, rtol=1e-6)
    np.testing.assert_allclose(unlike["high"], 4e-3, rtol=1e-6)
    marked = Domain(tops.loops, heights={"low": 1e-3, "high": 4e-3})
    assert len(mirrors_of(tops)) == 2
    assert len(mirrors_of(marked)) == 1  # each tube is its own image in the line across the channel
    assert len(mirrors_of(Domain(tops.loops, heights={"low": 1e-3, "high": 1e-3}))) == 2


def test_y_plus_of_each_wall_is_converted_with_one_reynolds_number() -> None:
    grid = meshonet.grid(CHANNEL, y_plus={"one": 1, "two": 30}, reynolds=1e5, length=2.0, cells=4000)
    result = heights(grid)
    np.testing.assert_allclose(result["two"].mean() / result["one"].mean(), 30, rtol=1e-6)


def test_a_name_that_no_wall_has_is_refused_with_the_names_there_are() -> None:
    with pytest.raises(InputError, match=r"'tub'.*floor, outlet, roof, inlet, one, two"):
        meshonet.grid(CHANNEL, first_cell={"tub": 1e-3}, cells=900)


def test_parts_of_one_wall_have_one_first_cell() -> None:
    bent = Domain.of_polygons(
        [np.array([[0.0, 0.0], [2.0, 0.0], [4.0, 1.5], [4.0, 3.0], [0.0, 3.0]])],
        names=[["floor", "ramp", "outlet", "roof", "inlet"]],
    )
    with pytest.raises(InputError, match="parts of one wall"):
        meshonet.grid(bent, first_cell={"floor": 1e-2, "ramp": 2e-2}, cells=900)


def test_walls_are_not_named_twice_over() -> None:
    with pytest.raises(InputError, match="walls"):
        meshonet.grid(CHANNEL, first_cell={"one": 1e-3}, walls=("one",))


def test_grids_without_named_walls_take_one_height() -> None:
    with pytest.raises(InputError, match="without a name"):
        meshonet.grid("naca:0012", first_cell={"blade": 1e-3}, pitch=(0.0, 1.0))
