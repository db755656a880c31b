"""Pictures of grids of many blocks: every block, its outline, its irregular vertices."""

from pathlib import Path

import matplotlib.image
import numpy as np
import pytest
from block_grids import butterfly, duct, o_ring

from meshonet.formats.figure.figure import draw
from meshonet.formats.figure.layers import Colouring
from meshonet.formats.figure.picture import Picture, write
from meshonet.formats.figure.view import View
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.measure import per_cell_of_blocks


@pytest.mark.parametrize("make", [butterfly, duct, o_ring])
def test_blocks_are_drawn_twice_the_same(make: type[Grid], tmp_path: Path) -> None:
    for name in ("a.png", "b.png"):
        Picture(metric="skewness").draw("png", tmp_path / name, [make()])
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_each_block_has_the_colours_of_its_cells(tmp_path: Path) -> None:
    shade = Colouring((np.zeros((8, 4)), np.ones((4, 8))), "block", (0.0, 1.0))
    write(tmp_path / "two.png", duct(1), "png", shade, View(every=100))
    picture = np.asarray(matplotlib.image.imread(tmp_path / "two.png"))[..., :3]
    row = picture[len(picture) // 2]
    bright = row.sum(axis=1)
    assert np.median(bright[200:600]) > 2.5
    assert np.median(bright[800:1000]) < 1.0


def test_irregular_vertices_are_dots_and_every_side_is_a_line() -> None:
    (axes,) = draw(butterfly(core=0.4)).axes
    dots = axes.collections[-1].get_offsets()
    assert sorted(map(tuple, np.abs(np.asarray(dots)).tolist())) == [(0.4, 0.4)] * 4
    assert [len(each.get_paths()) for each in axes.collections[-3:-1]] == [20, 4]
    assert axes.get_title(loc="left") == "butterfly   5 blocks, 132 cells"


def test_lines_run_on_from_block_to_block() -> None:
    (axes,) = draw(duct(1, ni=8, nj=6), every=3).axes
    first, second = ({path.vertices[0, 1] for path in axes.collections[k].get_paths()
                      if np.ptp(path.vertices[:, 1]) == 0} for k in (0, 1))  # fmt: skip
    assert first == second


def test_a_body_small_in_its_far_field_gets_a_view_of_its_own() -> None:
    ring = o_ring()
    scale = [np.hypot(*np.moveaxis(block.nodes, -1, 0))[..., None] ** 3 for block in ring.blocks]
    blocks = tuple(type(b)(b.nodes * s) for b, s in zip(ring.blocks, scale, strict=True))
    assert len(draw(Grid(blocks, ring.patches)).axes) == 2
    assert len(draw(ring).axes) == 1


def test_a_zoom_shows_the_blocks_in_it() -> None:
    grid = butterfly()
    values = tuple(per_cell_of_blocks(grid, "max_angle"))
    axes = draw(grid, Colouring(values, "angle"), zoom=(0.2, 0.8, 0.2, 0.8)).axes[0]
    assert (*axes.get_xlim(), *axes.get_ylim()) == (0.2, 0.8, 0.2, 0.8)
    with pytest.raises(InputError, match="shows none of the grid; it spans x -1 to 1, y -1 to 1"):
        draw(grid, zoom=(2, 3, 2, 3))
