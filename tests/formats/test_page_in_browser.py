"""The page of a grid in a real browser: what is drawn, and what the mouse and the controls do to it."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from browser import Browser
from format_shapes import ring
from many_blocks import passage
from volume_grids import box

from meshonet.formats.figure.page import scene
from meshonet.formats.figure.page.page import write_page
from meshonet.formats.figure.slices import parse_slice
from meshonet.formats.figure.view import View
from meshonet.geometry.blocks.grid import Grid

pytestmark = pytest.mark.browser
CANVAS = np.s_[60:640, 20:860]
"""Rows and columns of the window that have nothing but the grid in them."""
CAMERA = "const c = meshonet.camera; return [c.target, c.scale, c.azimuth]"
CORNER = "return meshonet.camera.seen([arguments[0], arguments[1], 0])"
CHOOSE = """
const [selector, value] = arguments, control = document.querySelector(selector);
control.value = value;
control.dispatchEvent(new Event("change"));
"""


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    browser = Browser(tmp_path_factory.mktemp("profile"))
    yield browser
    browser.close()


def opened(browser: Browser, grid: Grid, folder: Path, view: View | None = None) -> Browser:
    write_page(folder / "g.html", grid, "max_angle", view)
    browser.open(folder / "g.html")
    return browser


def choose(browser: Browser, selector: str, value: str) -> None:
    browser.run(CHOOSE, selector, value)
    browser.settle()


def inked(picture: np.ndarray) -> float:
    """Part of the picture that is dark."""
    return float((picture[CANVAS].max(axis=-1) < 0.5).mean())


def white(picture: np.ndarray) -> float:
    """Part of the picture that is empty."""
    return float((picture[CANVAS].min(axis=-1) > 0.99).mean())


def coloured(picture: np.ndarray) -> float:
    """Part of the picture that is neither grey nor white."""
    return float((np.ptp(picture[CANVAS], axis=-1) > 0.12).mean())


def test_cells_and_lines_are_drawn_and_controls_change_them(browser: Browser, tmp_path: Path) -> None:
    opened(browser, ring(61, 31), tmp_path)
    first = browser.picture()
    assert coloured(first) > 0.3
    assert 0.2 < white(first) < 0.8  # around the disc, and the body in it
    choose(browser, "#metric", "")
    plain = browser.picture()
    assert coloured(plain) < 0.01
    browser.click("#lines")
    assert inked(browser.picture()) < 0.3 * inked(plain)
    choose(browser, "#metric", "aspect_ratio")
    assert coloured(browser.picture()) > 0.3
    assert browser.run("return document.querySelector('#least').value") != ""
    assert browser.complaints() == []


def test_limits_of_the_scale_can_be_set(browser: Browser, tmp_path: Path) -> None:
    opened(browser, passage(), tmp_path)
    before = browser.picture()
    choose(browser, "#most", "3000")
    assert np.abs(browser.picture() - before)[CANVAS].mean() > 0.05
    choose(browser, "#most", "nonsense")  # is put right
    assert float(browser.run("return document.querySelector('#most').value")) < 3000


def test_the_wheel_enlarges_what_is_under_it_and_a_drag_moves(browser: Browser, tmp_path: Path) -> None:
    opened(browser, ring(), tmp_path)
    place = browser.run("return meshonet.camera.under(200, 100)")
    middle = browser.run(
        "const c = document.querySelector('#canvas'); return [c.clientWidth / 2, c.clientHeight / 2]"
    )
    x, y = round(middle[0] + 200), round(middle[1] - 100)
    _, before, _ = browser.run(CAMERA)
    browser.wheel(x, y, -400)
    _, after, _ = browser.run(CAMERA)
    assert after > 1.5 * before
    np.testing.assert_allclose(browser.run(CORNER, *place[:2])[:2], (200, 100), atol=2)
    moves = [{"type": "pointerMove", "duration": 0, "x": x - k, "y": y + k} for k in (0, 20, 50)]
    browser.mouse(
        moves[0], {"type": "pointerDown", "button": 0}, *moves[1:], {"type": "pointerUp", "button": 0}
    )
    np.testing.assert_allclose(browser.run(CORNER, *place[:2])[:2], (150, 50), atol=3)


def test_a_worst_place_is_flown_to_and_marked(browser: Browser, tmp_path: Path) -> None:
    grid = passage()
    opened(browser, grid, tmp_path)
    worst = browser.run("return meshonet.facts.metrics[0].worst[0]")
    browser.click("#worst button")
    target, _, _ = browser.run(CAMERA)
    np.testing.assert_allclose(target[:2], np.mean(worst["corners"], axis=0), atol=1e-9)
    red, green, blue = np.moveaxis(browser.picture(), -1, 0)
    assert ((red > 0.7) & (green < 0.35) & (blue < 0.4)).sum() > 100


def test_a_click_says_which_cell_it_is_and_its_value(browser: Browser, tmp_path: Path) -> None:
    grid = ring(25, 9)
    opened(browser, grid, tmp_path)
    x, y, _ = browser.run(CORNER, *grid.nodes[3:5, 5:7].mean(axis=(0, 1)).tolist())
    middle = browser.run(
        "const c = document.querySelector('#canvas'); return [c.clientWidth / 2, c.clientHeight / 2]"
    )
    place = {"type": "pointerMove", "duration": 0, "x": round(middle[0] + x), "y": round(middle[1] - y)}
    browser.mouse(place, {"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0})
    tip = browser.run("return document.querySelector('#tip').innerText")
    assert tip.split("\n")[-1] == "i 3, j 5"
    value = grid.quality()["max_angle"].max  # all cells of a ring are alike
    assert float(tip.split("\n")[0].removeprefix("max_angle ")) == pytest.approx(value, rel=2e-3)


def test_blocks_are_switched_off_and_on(browser: Browser, tmp_path: Path) -> None:
    opened(browser, passage(), tmp_path)
    full = white(browser.picture())
    browser.click("#parts input[value='1']")
    fewer = white(browser.picture())
    assert fewer > full + 0.02
    browser.run("document.querySelectorAll('#parts .both button')[1].click()")
    browser.settle()
    assert white(browser.picture()) > fewer + 0.02
    browser.run("document.querySelectorAll('#parts .both button')[0].click()")
    browser.settle()
    assert white(browser.picture()) == pytest.approx(full, abs=1e-3)


def test_the_camera_sees_what_pictures_show(browser: Browser, tmp_path: Path) -> None:
    view = View(seen_from=(-40, 25), up="y")
    opened(browser, box(), tmp_path, view)
    np.testing.assert_allclose(browser.run("return meshonet.camera.axes"), view.axes, atol=1e-12)
    browser.run("document.querySelector('[data-view=y]').click()")
    np.testing.assert_allclose(browser.run("return meshonet.camera.axes")[2], [0, 1, 0], atol=1e-12)


def test_a_volume_is_turned_cut_and_sliced(browser: Browser, tmp_path: Path) -> None:
    opened(browser, box(), tmp_path, View(slice=parse_slice("z=.5")))
    assert browser.run("return meshonet.state.cut.count") > 0
    browser.run("document.querySelectorAll('#parts .both button')[1].click()")
    browser.settle()
    cut = browser.picture()
    assert coloured(cut) > 0.05
    choose(browser, "#across", "k")
    assert browser.run("return meshonet.state.slice.length") == 1
    assert browser.run("return meshonet.state.cut") is None
    assert coloured(browser.picture()) > 0.05
    choose(browser, "#across", "")
    assert white(browser.picture()) > 0.99
    browser.run("document.querySelectorAll('#parts .both button')[0].click()")
    browser.settle()
    solid = browser.picture()
    _, _, before = browser.run(CAMERA)
    moves = [{"type": "pointerMove", "duration": 0, "x": 400 + k, "y": 400} for k in (0, 20, 90)]
    browser.mouse(
        moves[0], {"type": "pointerDown", "button": 0}, *moves[1:], {"type": "pointerUp", "button": 0}
    )
    _, _, after = browser.run(CAMERA)
    assert after != before
    assert np.abs(browser.picture() - solid)[CANVAS].mean() > 0.005
    assert browser.complaints() == []


def test_a_large_volume_is_sliced_and_shows_what_is_around_bad_cells(
    browser: Browser, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(scene, "MOST_NODES", 100)
    opened(browser, box(), tmp_path, View(slice=parse_slice("k=1")))
    assert browser.run("return meshonet.state.slice.map(({ sheet }) => [sheet.across, sheet.at])") == [
        ["k", 1]
    ]
    browser.run("document.querySelectorAll('#parts .both button')[1].click()")
    browser.settle()
    first = browser.picture()
    assert coloured(first) > 0.05
    assert browser.run("return [...document.querySelector('#across').options].length") == 4
    browser.run(
        "const c = document.querySelector('#layer'); c.value = c.max; c.dispatchEvent(new Event('input'))"
    )
    browser.settle()
    assert browser.run("return meshonet.state.slice[0].sheet.at") > 1
    assert np.abs(browser.picture() - first)[CANVAS].mean() > 1e-3
    choose(browser, "#across", "")
    empty = browser.picture()
    assert white(empty) > 0.99
    browser.click("#worst button")
    drawn = (browser.picture() != empty).any(axis=-1)[CANVAS].mean()
    assert drawn > 2e-3  # its edges, and the lines around it
    assert browser.run("return meshonet.state.mark.length") == 2
    assert browser.complaints() == []


def test_nodes_keep_their_places_when_enlarged_a_billion_times(browser: Browser, tmp_path: Path) -> None:
    """Cells of 1e-9 beside coordinates of 1, which floats of a graphics card cannot tell apart."""
    layers = np.append(np.arange(9) * 1e-9, 1.0)
    x, y = np.meshgrid(np.linspace(1.0, 1.0 + 8e-9, 9), 1.0 + layers, indexing="ij")
    grid = Grid.from_nodes(np.stack([x, y], axis=-1))
    opened(browser, grid, tmp_path, View(zoom=(1.0, 1.0 + 8e-9, 1.0, 1.0 + 8e-9)))
    choose(browser, "#metric", "")
    row = (browser.picture()[300:301, 20:860].max(axis=-1) < 0.75).mean(axis=0)
    lines = np.flatnonzero(np.diff((row > 0).astype(int)) == 1)
    gaps = np.diff(lines)
    assert len(lines) >= 7
    assert gaps.max() - gaps.min() <= 2
