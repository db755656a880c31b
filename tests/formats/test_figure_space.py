"""Pictures of volumes and surfaces: what they show, and what is refused."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meshonet.api.plot import plot
from meshonet.formats.figure.figure import draw
from meshonet.formats.figure.painting import Painted, painted
from meshonet.formats.figure.slices import CellSheet, Slice, cut, layers, parse_slice
from meshonet.formats.figure.space import draw_in_space
from meshonet.formats.figure.view import View
from meshonet.geometry.arrays import Floats, Side
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError

sys.path.append(str(Path(__file__).parents[1] / "geometry"))
from space_grids import lattice, pipe, sphere_patches


def polygon_area(points: Floats) -> float:
    x, y = np.moveaxis(points, -1, 0)
    return float(0.5 * np.abs((x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)).sum())


@pytest.mark.parametrize(
    ("text", "slice_"),
    [
        ("i=10", Slice(0, 10)),
        (" k = -1", Slice(2, -1)),
        ("x=.5", Slice(0, None, 0.5)),
        ("z=-1e2", Slice(2, None, -100.0)),
    ],
)
def test_slices_are_an_index_or_a_coordinate(text: str, slice_: Slice) -> None:
    assert parse_slice(text) == slice_


@pytest.mark.parametrize("text", ["", "w=1", "i=.5", "x=nan", "x", "i=10,k=2"])
def test_other_words_are_no_slice(text: str) -> None:
    with pytest.raises(InputError, match="is no slice; use i, j or k and an index"):
        parse_slice(text)


def test_a_cut_has_the_area_of_the_section() -> None:
    box = Grid.from_nodes(lattice((0, 4, 5), (0, 3, 4), (0, 2, 6)))
    assert polygon_area(cut(box, Slice(0, None, 1.3), None).polygons) == pytest.approx(6)
    assert polygon_area(cut(box, Slice(1, None, 1.0), None).polygons) == pytest.approx(8)
    around = Grid.from_nodes(pipe(5, 241, 4, 0.5))
    assert polygon_area(cut(around, Slice(2, None, 0.9), None).polygons) == pytest.approx(
        0.75 * np.pi, rel=1e-3
    )
    assert polygon_area(cut(around, Slice(0, None, 0.0), None).polygons) == pytest.approx(2, rel=1e-3)
    turn = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    cube = Grid.from_nodes((lattice(*[(-0.5, 0.5, 5)] * 3)) @ turn)
    heights = np.arange(-0.995, 1, 0.01)
    within = heights[np.abs(heights) < cube.nodes[..., 2].max()]
    areas = [polygon_area(cut(cube, Slice(2, None, z), None).polygons) for z in within.tolist()]
    assert 0.01 * sum(areas) == pytest.approx(1.0, rel=0.01)  # its volume


@pytest.mark.parametrize("z", [0.0, 2.0])
def test_a_plane_that_is_the_boundary_shows_its_cells(z: float) -> None:
    box = Grid.from_nodes(lattice((0, 4, 5), (0, 3, 4), (0, 2, 3)))
    assert polygon_area(cut(box, Slice(2, None, z), None).polygons) == pytest.approx(12.0)


def test_cells_keep_their_values_in_slices() -> None:
    grid = Grid.from_nodes(lattice((0, 3, 4), (0, 3, 4), (0, 3, 4)))
    values = [np.arange(27.0).reshape(3, 3, 3)]
    (sheet,) = layers(grid, Slice(2, -1), values)
    np.testing.assert_array_equal(sheet.values, values[0][:, :, 2])
    np.testing.assert_array_equal(sheet.nodes, grid.nodes[:, :, 3])
    across = cut(grid, Slice(0, None, 1.5), values)
    assert sorted(across.values.tolist()) == list(range(9, 18))


def test_walls_are_drawn_and_the_outer_boundary_without_any() -> None:
    box = Grid.from_nodes(lattice((0, 4, 5), (0, 3, 4), (0, 2, 3)))
    walls = Grid(box.blocks, (Patch("wall", "bottom", 0, 4),))
    counts = []
    for grid in (box, walls):
        figure = draw_in_space(grid, None, View(every=1))
        (collection,) = figure.axes[0].collections
        counts.append(len(collection.get_facecolors()))
    quads, rims = 2 * (12 + 8 + 6), 2 * 2 * (7 + 6 + 5)
    assert counts == [quads + rims, 12 + 14]


def test_what_is_in_front_is_drawn_last() -> None:
    near, far = (
        lattice((0, 1, 2), (0, 1, 2), (0, 1, 2))[:, :, 1],
        lattice((0, 1, 2), (0, 1, 2), (0, 1, 2))[:, :, 0],
    )
    grid = Grid((Block(near), Block(far)))
    (collection,) = draw_in_space(grid, None, View(seen_from=(0, 90))).axes[0].collections
    assert collection.get_paths()[0].vertices.tolist() != collection.get_paths()[1].vertices.tolist()
    faces = [k for k, colour in enumerate(collection.get_facecolors()) if colour[3] == 1]
    rims = [k for k, colour in enumerate(collection.get_facecolors()) if colour[3] == 0]
    assert faces == [0, 5]
    assert rims == [1, 2, 3, 4, 6, 7, 8, 9]


@pytest.mark.parametrize("up", ["x", "y", "z", None])
def test_the_axis_that_is_up_points_upwards(up: str | None) -> None:
    right, upwards, towards = View(seen_from=(0, 0), up=up).axes
    axis = "xyz".index(up or "z")
    np.testing.assert_allclose(upwards, np.eye(3)[axis], atol=1e-15)
    np.testing.assert_allclose(towards, np.eye(3)[(axis + 1) % 3], atol=1e-15)
    np.testing.assert_allclose(np.cross(right, upwards), towards, atol=1e-15)


def test_a_flat_layer_is_drawn_as_grids_in_the_plane_are() -> None:
    grid = Grid.from_nodes(lattice((0, 4, 5), (0, 3, 4), (0, 2, 3)))
    axes = draw_in_space(grid, None, View(slice=Slice(2, 1))).axes[0]
    flat = draw(Grid.from_nodes(grid.nodes[:, :, 1, :2])).axes[0]
    assert [len(c.get_paths()) for c in axes.collections][:1] == [
        len(c.get_paths()) for c in flat.collections
    ][:1]
    assert axes.get_xlim() == flat.get_xlim()


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"slice": "k=9"}, "slice: no block has k = 9; use 0 to 2, or -1 for the last"),
        ({"slice": "z=7"}, "slice: the plane z = 7 cuts no cell; the grid is from z = 0 to 2"),
        (
            {"zoom": (0, 1, 0, 1)},
            "zoom: a picture in space is zoomed by a box in space; use x0,x1,y0,y1,z0,z1",
        ),
        ({"zoom": (9, 10, 0, 1, 0, 1)}, "shows none of the grid; it spans x 0 to 4, y 0 to 3, z 0 to 2"),
        ({"seen_from": (np.nan, 0)}, "is no direction; use azimuth and elevation in degrees"),
        ({"up": "k"}, "'k' is no axis; use x, y or z"),
        ({"metric": "area_ratio"}, "metric 'area_ratio' is none of volumes"),
    ],
)
def test_what_cannot_be_shown_is_refused(tmp_path: Path, settings: dict, message: str) -> None:
    grid = Grid.from_nodes(lattice((0, 4, 5), (0, 3, 4), (0, 2, 3)))
    with pytest.raises(InputError) as error:
        plot(grid, tmp_path / "made.png", **settings)
    assert message in str(error.value)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("at", "across", "box"), [("k=0", 2, (0, 1, 0, 2)), ("x=2", 0, (0, 2, 0, 1)), ("j=1", 1, (0, 1, 0, 1))]
)
def test_a_slice_is_zoomed_by_a_box_in_space_or_in_its_plane(
    tmp_path: Path, at: str, across: int, box: tuple[float, ...]
) -> None:
    grid = Grid.from_nodes(lattice((0, 4, 5), (0, 3, 4), (0, 2, 3)))
    in_space = (*box[: 2 * across], 0, 9, *box[2 * across :])
    plot(grid, tmp_path / "plane.svg", slice=at, zoom=box)
    plot(grid, tmp_path / "space.svg", slice=at, zoom=in_space)
    plot(grid, tmp_path / "whole.svg", slice=at)
    plane, space, whole = ((tmp_path / f"{name}.svg").read_bytes() for name in ("plane", "space", "whole"))
    assert plane == space != whole


def test_slices_are_of_volumes(tmp_path: Path) -> None:
    plane = Grid.from_nodes(lattice((0, 1, 3), (0, 1, 3), (0, 1, 2))[:, :, 0, :2])
    surface = Grid(tuple(Block(patch) for patch in sphere_patches()))
    with pytest.raises(InputError, match="slice: the grid is in the plane; leave slice out"):
        plot(plane, tmp_path / "made.png", slice="k=0")
    with pytest.raises(InputError, match="seen_from: the grid is in the plane"):
        plot(plane, tmp_path / "made.png", seen_from=(0, 0))
    with pytest.raises(InputError, match="slice: a surface has no slices"):
        plot(surface, tmp_path / "made.png", slice="k=0")
    plot(surface, tmp_path / "made.svg", metric="area_ratio", zoom=(0, 2, -2, 2, -2, 2))
    assert (tmp_path / "made.svg").read_bytes().startswith(b"<?xml")


@pytest.mark.parametrize("flipped", [False, True])
def test_cells_of_the_far_side_of_a_thin_wall_are_drawn_first(flipped: bool) -> None:
    """Cells are longer than the wall is thick, so that a cell of the far side may have the nearer centre."""
    axes = np.array([[1.0, 0.0, 0.0], [0.0, np.sqrt(0.5), -np.sqrt(0.5)], [0.0, np.sqrt(0.5), np.sqrt(0.5)]])
    x, y = np.meshgrid([0.0, 1.0], np.arange(0.0, 9.0, 2.0), indexing="ij")
    near = np.stack([x, y, np.full_like(x, 0.05)], axis=-1)
    far = np.stack([x, y + 0.9, np.full_like(x, -0.05)], axis=-1)
    depths = []
    for nodes, outside in ((near, 1), (far, -1)):
        shown = nodes[::-1] if flipped else nodes
        sheet = CellSheet(shown, None, -outside if flipped else outside)
        depths.append(painted(sheet, np.ones((1, 4), dtype=bool), (1, 1), axes, None, (0.0, 1.0)).depth)
    assert (depths[1] < depths[0]).all()


def test_the_flow_is_on_the_side_of_walls_that_blocks_are_on(monkeypatch: pytest.MonkeyPatch) -> None:
    sheets: list[CellSheet] = []

    def kept(sheet: CellSheet, *more: Any) -> Painted:
        sheets.append(sheet)
        return painted(sheet, *more)

    monkeypatch.setattr("meshonet.formats.figure.space.painted", kept)
    block = lattice(*[(0.0, 1.0, 3)] * 3)
    middle = block.reshape(-1, 3).mean(axis=0)
    sides: tuple[Side, ...] = ("south", "north", "west", "east", "bottom", "top")
    grid = Grid((Block(block),), tuple(Patch(side, side, 0, 2, kind="wall") for side in sides))
    draw_in_space(grid, None, View())
    assert len(sheets) == len(sides)
    for sheet in sheets:
        normal = np.cross(sheet.nodes[-1, 0] - sheet.nodes[0, 0], sheet.nodes[0, -1] - sheet.nodes[0, 0])
        assert sheet.outside * float(normal @ (middle - sheet.nodes[0, 0])) > 0.0
