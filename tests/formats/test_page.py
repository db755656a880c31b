"""The page of a grid, its numbers unpacked here as the browser does; tests of it in a browser are beside."""

import base64
import json
import re
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from format_shapes import c_grid, channel, ring
from many_blocks import passage
from surface_grids import shell
from volume_grids import box, pipe

from meshonet.formats.figure.page import scene
from meshonet.formats.figure.page.page import write_page
from meshonet.formats.figure.slices import parse_slice
from meshonet.formats.figure.view import View
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.measure import per_cell_of_blocks

EVERY = [channel, ring, c_grid, passage, shell, box, pipe]
Make = Callable[[], Grid]


class Page:
    """A page that was written: its text, facts and numbers."""

    def __init__(self, path: Path) -> None:
        self.text = path.read_text(encoding="utf-8")
        match = re.search(r'id="facts">(.*?)</script>', self.text)
        assert match
        self.facts: dict[str, Any] = json.loads(match[1].replace("<\\/", "</"))

    def numbers(self, name: str) -> np.ndarray:
        """Unpack numbers: see formats/figure/page/document.py."""
        match = re.search(rf'id="{name}" data-count="(\d+)" data-width="(\d)">([^<]*)<', self.text)
        assert match
        count, width = int(match[1]), int(match[2])
        planes = np.frombuffer(zlib.decompress(base64.b64decode(match[3])), np.uint8).reshape(width, count)
        plain = sum(plane.astype(np.int64) << (8 * k) for k, plane in enumerate(planes))
        return np.cumsum(np.where(plain % 2, -(plain + 1) // 2, plain // 2))

    def metric(self, name: str) -> dict[str, Any]:
        """What the page says of a metric."""
        return next(metric for metric in self.facts["metrics"] if metric["name"] == name)


def page(grid: Grid, folder: Path, metric: str | None = "max_angle", view: View | None = None) -> Page:
    write_page(folder / "g.html", grid, metric, view)
    return Page(folder / "g.html")


def lattice(grid: Grid) -> np.ndarray:
    """All nodes of the blocks behind one another, (n, d)."""
    return np.concatenate([block.nodes.reshape(-1, block.nodes.shape[-1]) for block in grid.blocks])


@pytest.mark.parametrize("make", EVERY)
def test_a_page_has_every_node_to_a_part_of_the_shortest_edge(make: Make, tmp_path: Path) -> None:
    grid = make()
    made = page(grid, tmp_path)
    step, (low, _) = made.facts["step"], made.facts["box"]
    nodes = np.stack([low[k] + step * made.numbers("xyz"[k]) for k in range(len(low))], axis=-1)
    edges = [np.diff(block.nodes, axis=axis) for block in grid.blocks for axis in range(len(block.counts))]
    lengths = np.concatenate([np.sqrt((edge**2).sum(axis=-1)).ravel() for edge in edges])
    assert np.abs(nodes - lattice(grid)).max() <= lengths[lengths > 0].min() / 500


@pytest.mark.parametrize("make", EVERY)
def test_a_page_has_every_metric_of_every_cell(make: Make, tmp_path: Path) -> None:
    grid = make()
    made = page(grid, tmp_path)
    for name, summary in grid.quality().metrics.items():
        metric = made.metric(name)
        values = np.concatenate([cells.ravel() for cells in per_cell_of_blocks(grid, name)])
        low, high = (np.log(metric[end]) if metric["log"] else metric[end] for end in ("min", "max"))
        shown = low + made.numbers(name) / 65535 * (high - low)
        reached = np.log(values) if metric["log"] else values
        np.testing.assert_allclose(shown, reached, rtol=1e-9, atol=1e-5 * (high - low) + 1e-12)
        assert sum(metric["histogram"]) == len(values)
        first = metric["worst"][0]
        assert first["value"] == (summary.min if metric["low"] else summary.max)
        at = per_cell_of_blocks(grid, name)[first["block"]][tuple(first["at"])]
        assert at == first["value"]


def test_worst_places_are_apart_and_in_order(tmp_path: Path) -> None:
    worst = page(ring(121, 61), tmp_path).metric("aspect_ratio")["worst"]
    values = [cell["value"] for cell in worst]
    places = np.array([cell["at"] for cell in worst])
    assert values == sorted(values, reverse=True)
    apart = np.abs(places[:, None] - places[None]).max(axis=-1) + 99 * np.eye(len(places))
    assert len(places) > 3
    assert apart.min() > 3


def test_corners_of_a_worst_cell_are_its_nodes(tmp_path: Path) -> None:
    grid = box()
    cell = page(grid, tmp_path).metric("max_angle")["worst"][0]
    i, j, k = cell["at"]
    corners = grid.blocks[0].nodes[i : i + 2, j : j + 2, k : k + 2].reshape(8, 3)
    assert np.array_equal(cell["corners"], corners)


def test_a_page_asks_nothing_of_a_network(tmp_path: Path) -> None:
    text = page(ring(), tmp_path).text
    assert not re.search(r"\b(src|href)\s*=|@import|url\(|\bfetch\(|XMLHttpRequest|\bimport\s*\(", text)
    assert set(re.findall(r"https?://[^\"'\s)]+", text)) == {"http://www.w3.org/2000/svg"}


def test_names_cannot_break_out_of_a_page(tmp_path: Path) -> None:
    made = page(ring(name="</script><b>O&M"), tmp_path)
    assert made.facts["name"] == "</script><b>O&M"
    assert "<title>&lt;/script&gt;&lt;b&gt;O&amp;M</title>" in made.text
    assert "</script><b>" not in made.text


def test_names_of_patches_cannot_break_out_of_a_page(tmp_path: Path) -> None:
    names = ["</script>", "<!--<script>"]
    patches = tuple(Patch(name, side, 0, 4) for name, side in zip(names, ("south", "north"), strict=True))
    nodes = np.stack(np.meshgrid(np.arange(5.0), np.arange(4.0), indexing="ij"), axis=-1)
    made = page(Grid.from_nodes(nodes, "quad", patches), tmp_path)
    assert {edge["name"] for edge in made.facts["edges"]} >= set(names)
    assert "<!--<script>" not in made.text


def test_the_same_grid_gives_the_same_page(tmp_path: Path) -> None:
    assert page(pipe(), tmp_path).text == page(pipe(), tmp_path).text


def test_of_a_large_volume_a_page_has_the_outer_boundary_and_layers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    grid = box()
    whole = page(grid, tmp_path)
    monkeypatch.setattr(scene, "MOST_NODES", 100)
    outer = page(grid, tmp_path)
    patches = [sheet["part"] for sheet in outer.facts["sheets"] if sheet["kind"] != "slice"]
    assert [sheet["part"] for sheet in whole.facts["sheets"]] == patches
    layers = [(sheet["across"], sheet["at"]) for sheet in outer.facts["sheets"] if sheet["kind"] == "slice"]
    assert layers == sorted(layers)
    assert [sum(name == axis for name, _ in layers) for axis in "ijk"] == [3, 2, 3]  # of four along j
    assert (whole.facts["whole"], outer.facts["whole"]) == (True, False)
    values = per_cell_of_blocks(grid, "skewness")[0]
    metric, levels, cell = outer.metric("skewness"), outer.numbers("skewness"), 0
    for part in outer.facts["lattices"]:
        rows, columns = (count - 1 for count in part["counts"])
        at: list[Any] = [slice(first, None) for first in part["start"]]
        at[part["fixed"]] = part["start"][part["fixed"]]
        own = values[tuple(at)][:rows, :columns].ravel()
        shown = metric["min"] + levels[cell : cell + own.size] / 65535 * (metric["max"] - metric["min"])
        np.testing.assert_allclose(shown, own, atol=1e-5)
        cell += own.size
    assert cell == len(levels)


def test_of_a_large_volume_a_page_has_the_layer_asked_for_and_what_is_around_bad_cells(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(scene, "MOST_NODES", 100)
    grid = box()
    made = page(grid, tmp_path, view=View(slice=parse_slice("j=0")))
    (number,) = (
        each["lattice"] for each in made.facts["sheets"] if (each.get("across"), each["at"]) == ("j", 0)
    )
    before = sum(int(np.prod(each["counts"])) for each in made.facts["lattices"][:number])
    (low, _), step = made.facts["box"], made.facts["step"]
    layer = grid.blocks[0].nodes[:, 0].reshape(-1, 3)
    for axis, name in enumerate("xyz"):
        shown = low[axis] + step * made.numbers(name)[before : before + len(layer)]
        np.testing.assert_allclose(shown, layer[:, axis], atol=step)
    for cell in made.metric("max_angle")["worst"]:
        around = np.array(cell["around"])
        (i, j, k), (n, m) = cell["at"], around.shape[:2]
        assert n * m > 9
        assert (around == grid.blocks[0].nodes[i, j, k]).all(axis=-1).sum() == 1


@pytest.mark.parametrize(
    ("make", "view", "message"),
    [
        (ring, View(slice=parse_slice("k=0")), "slice: the grid is in the plane; leave slice out"),
        (ring, View(seen_from=(0, 0)), "seen_from: the grid is in the plane"),
        (ring, View(zoom=(8, 9, 8, 9)), "zoom: zoom (8, 9, 8, 9) shows none of the grid; it spans x -4 to 4"),
        (box, View(zoom=(0, 1, 0, 1)), "zoom: the box is not one of this grid; use x0,x1,y0,y1,z0,z1"),
        (box, View(slice=parse_slice("k=77")), "slice: no block has k = 77; use 0 to 5"),
        (box, View(slice=parse_slice("z=77")), "slice: the plane z = 77 cuts no cell"),
        (shell, View(slice=parse_slice("z=1")), "slice: a surface has no slices"),
    ],
)
def test_a_view_that_the_grid_does_not_have_is_refused(
    make: Make, view: View, message: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError) as refused:
        page(make(), tmp_path, view=view)
    assert str(refused.value).startswith(message)
    assert not list(tmp_path.iterdir())


def test_a_metric_of_other_cells_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="'bezier_ratio' is none of quadrilaterals"):
        page(ring(), tmp_path, "bezier_ratio")
