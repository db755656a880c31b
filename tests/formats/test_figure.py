import re
from pathlib import Path
from xml.etree import ElementTree

import matplotlib.image
import numpy as np
import pytest
from format_shapes import c_grid, channel, ring

from meshonet.formats.figure.figure import _drawn_lines, draw
from meshonet.formats.figure.layers import Colouring
from meshonet.formats.figure.picture import Picture, write
from meshonet.formats.figure.view import View
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError

NUMBER = re.compile(r"-?[0-9]+(\.[0-9]+)?")


def pixels(path: Path) -> np.ndarray:
    """(rows, columns, 3) of a picture, 0 to 1."""
    return np.asarray(matplotlib.image.imread(path))[..., :3]


def wide_ring(ni: int = 81, nj: int = 41) -> Grid:
    """An O grid whose body is small in its far field, as an airfoil's is."""
    grid = ring(ni, nj)
    angle = np.arctan2(grid.y, grid.x)
    radius = np.geomspace(1, 30, nj)
    nodes = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)
    nodes[-1] = nodes[0]
    return Grid.from_nodes(nodes, "o")


def values(grid: Grid) -> np.ndarray:
    return np.add.outer(np.arange(grid.ni - 1.0), np.arange(grid.nj - 1.0))


@pytest.mark.parametrize("level", [92.045454, -3.0, 0.0, 2e-7])
def test_the_scale_of_values_that_are_nearly_the_same_can_be_read(level: float, tmp_path: Path) -> None:
    grid = channel()
    same = level + 1e-9 * level * values(grid)
    write(tmp_path / "same.svg", grid, "svg", Colouring(same, "value"))
    root = ElementTree.parse(tmp_path / "same.svg").getroot()  # noqa: S314
    texts = [text.text or "" for text in root.iter("{http://www.w3.org/2000/svg}text")]
    numbers = [text.replace("\N{MINUS SIGN}", "-") for text in texts]
    bar = [float(text) for text in numbers[: numbers.index("value")] if NUMBER.fullmatch(text)]
    offsets = [text for text in numbers if "e" in text and "+" in text]
    assert not offsets
    if level > 1.0:
        assert any(abs(number - level) < 1.0 for number in bar)
    assert len({text for text in numbers if NUMBER.fullmatch(text)}) >= 3


@pytest.mark.parametrize("kind", ["png", "svg", "pdf"])
@pytest.mark.parametrize("make", [channel, ring, c_grid, wide_ring])
def test_every_topology_is_drawn_in_every_kind_and_twice_the_same(
    make: type[Grid], kind: str, tmp_path: Path
) -> None:
    grid = make()
    for name in ("a", "b"):
        write(tmp_path / name, grid, kind, Colouring(values(grid), "value"))
    data = (tmp_path / "a").read_bytes()
    assert data == (tmp_path / "b").read_bytes()
    write(
        tmp_path / "moved",
        Grid.from_nodes(2 * grid.nodes, grid.topology, grid.patches),
        kind,
        Colouring(values(grid), "v"),
    )
    assert data != (tmp_path / "moved").read_bytes()
    if kind == "svg":
        texts = [text.text for text in ElementTree.fromstring(data).iter("{http://www.w3.org/2000/svg}text")]  # noqa: S314
        assert {"value", f"{grid.name}   {grid.ni} × {grid.nj} nodes".strip()} <= set(texts)
    else:
        assert data.startswith({"png": b"\x89PNG", "pdf": b"%PDF"}[kind])


@pytest.mark.parametrize("make", [channel, ring, c_grid])
def test_each_cell_has_the_colour_of_its_value_at_its_place(make: type[Grid], tmp_path: Path) -> None:
    grid = make()
    cells = (grid.ni - 1, grid.nj - 1)
    ranks = np.random.default_rng(0).permutation(cells[0] * cells[1]).astype(float)
    shade = Colouring(ranks.reshape(cells), "v")
    write(tmp_path / "a.png", grid, "png", shade, View(every=1000))
    axes = draw(grid, shade, every=1000).axes[-2]  # the view of the whole; the last one is the colour bar
    nodes = grid.nodes
    middles = 0.25 * (nodes[:-1, :-1] + nodes[1:, :-1] + nodes[1:, 1:] + nodes[:-1, 1:])
    columns, rows = axes.transData.transform(middles.reshape(-1, 2)).astype(int).T
    light = pixels(tmp_path / "a.png")[::-1][rows, columns].sum(axis=-1)
    in_order = light[np.argsort(ranks)][:: len(ranks) // 8]  # neighbours in rank may have the same colour
    assert (np.diff(in_order) < 0).all()


def test_a_small_body_gets_a_view_of_its_own() -> None:
    assert len(draw(wide_ring()).axes) == 2
    assert len(draw(ring()).axes) == 1
    assert len(draw(channel()).axes) == 1
    near, whole = draw(wide_ring()).axes
    assert near.get_xlim()[1] < 2 < 30 < whole.get_xlim()[1]


def test_a_zoom_shows_just_that() -> None:
    (axes,) = draw(wide_ring(), zoom=(0.9, 1.1, -0.05, 0.05)).axes
    assert (*axes.get_xlim(), *axes.get_ylim()) == (0.9, 1.1, -0.05, 0.05)


def test_one_bad_cell_among_a_million_is_seen(tmp_path: Path) -> None:
    s, t = np.meshgrid(np.linspace(0, 1, 1200), np.linspace(0, 1, 900), indexing="ij")
    grid = Grid.from_nodes(np.stack([s, t], axis=-1))
    flat = np.zeros((1199, 899))
    write(tmp_path / "good.png", grid, "png", Colouring(flat, "v", (0.0, 1.0)), View(every=2000))
    flat[617, 411] = 1.0
    write(tmp_path / "bad.png", grid, "png", Colouring(flat, "v", (0.0, 1.0)), View(every=2000))
    change = np.abs(pixels(tmp_path / "good.png") - pixels(tmp_path / "bad.png")).max(axis=-1)
    rows, columns = np.nonzero(change > 0.3)
    assert 1 <= len(rows) <= 12
    low = Colouring(1 - flat, "v", (0.0, 1.0), worst_is_low=True)
    write(tmp_path / "low.png", grid, "png", low, View(every=2000))
    dark = pixels(tmp_path / "low.png")[rows[0], columns[0]].sum()
    assert dark < pixels(tmp_path / "low.png")[rows[0] + 9, columns[0]].sum()


def test_colours_stay_in_their_cells_when_a_ring_leaves_the_view(tmp_path: Path) -> None:
    grid = wide_ring(401, 201)
    zoom = (0.9, 1.1, -0.1, 0.1)
    shade = Colouring(np.tile(np.sign(np.arange(400) - 199.5)[:, None], (1, 200)), "side", (-1.0, 1.0))
    write(tmp_path / "a.png", grid, "png", shade, View(zoom, 1000))
    figure = draw(grid, shade, zoom, every=1000)
    box = figure.axes[0].get_window_extent()
    picture = pixels(tmp_path / "a.png")[::-1]
    inside = picture[int(box.y0) + 4 : int(box.y1) - 4, int(box.x0) + 4 : int(box.x1) - 4]
    # i runs clockwise from the positive x axis: cells below it have -1 (light), above it +1 (dark)
    right = inside[:, int(0.7 * inside.shape[1]) :]
    middle = right.shape[0] // 2  # and the lowest 60 rows hold the note on lines
    assert right[60 : middle - 4].sum(axis=-1).min() > 2.5
    assert right[middle + 4 :].sum(axis=-1).max() < 1.5


def test_lines_are_as_many_as_asked_for() -> None:
    for every, lines in ((1, 9 + 6), (3, 4 + 3), (100, 2 + 2)):
        (axes,) = draw(channel(9, 6), every=every).axes
        assert len(axes.collections[0].get_paths()) == lines


def test_so_many_lines_are_left_out_that_the_rest_can_be_told_apart() -> None:
    s, t = np.meshgrid(np.linspace(0, 1, 1500), np.linspace(0, 1, 1500), indexing="ij")
    (axes,) = draw(Grid.from_nodes(np.stack([s, t], axis=-1))).axes
    drawn = len(axes.collections[0].get_paths())
    assert drawn / 2 * 5 < axes.get_window_extent().width
    assert drawn > 100
    assert axes.texts[0].get_text() == "every 10th line"


def test_values_that_are_not_finite_are_left_blank(tmp_path: Path) -> None:
    grid, some = channel(), np.ones((6, 4))
    some[:3] = np.nan
    write(tmp_path / "a.png", grid, "png", Colouring(some, "v", (0.0, 1.0)), View(every=1000))
    picture = pixels(tmp_path / "a.png")[::-1]
    axes = draw(grid, Colouring(some, "v", (0.0, 1.0)), every=1000).axes[0]
    (left, row), (right, _) = axes.transData.transform([(0.5, 0.5), (1.6, 0.5)]).astype(int)
    assert picture[row, left].tolist() == [1.0, 1.0, 1.0]
    assert picture[row, right].sum() < 1.0


CASES = {
    "every": ({"every": 0}, "every 0-th line cannot be drawn; use 1 or more"),
    "empty": ({"zoom": (1.0, 1.0, 0.0, 1.0)}, "zoom: '1,1,0,1' is not a box; use x0,x1,y0,y1"),
    "nan": ({"zoom": (np.nan, 1.0, 0.0, 1.0)}, "is not a box"),
    "infinite": ({"zoom": (0.0, np.inf, 0.0, 1.0)}, "is not a box"),
}


@pytest.mark.parametrize("case", CASES)
def test_what_cannot_be_drawn_is_refused(case: str) -> None:
    settings, message = CASES[case]
    with pytest.raises(InputError, match=message):
        Picture(**settings)  # type: ignore[arg-type]


def test_a_box_beside_the_grid_is_refused() -> None:
    with pytest.raises(InputError, match=r"shows none of the grid; it spans x 0 to 2\.1, y"):
        draw(channel(), zoom=(9.0, 10.0, 0.0, 1.0))


@pytest.mark.parametrize(
    ("steps", "words"),
    [
        ((1, 5), "every xi and 5th eta line"),
        ((12, 21), "every 12th xi and 21st eta line"),
        ((4, 3), "every 4th xi and 3rd eta line"),
    ],
)
def test_lines_left_out_are_told_in_words(steps: tuple[int, int], words: str) -> None:
    assert _drawn_lines(*steps) == words


@pytest.mark.parametrize("nodes", [np.zeros((5, 4, 2)), np.ones((3, 3, 3, 3))])
def test_a_grid_of_one_point_is_refused(nodes: np.ndarray, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="the points have no extent"):
        Picture().draw("png", tmp_path / "a.png", [Grid.from_nodes(nodes)])
