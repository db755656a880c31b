"""`meshonet plot`."""

import sys
from pathlib import Path

import pytest
from command_line import Meshonet, Process

from meshonet.formats.figure.picture import DRAWN
from meshonet.formats.registry import picture_format
from meshonet.geometry.quality.profiles import PROFILES
from meshonet_cli.tasks.pictures import leave_out_docstrings


@pytest.fixture
def grid_vts(meshonet: Meshonet, body_h5: Path) -> Path:
    """An O grid, 41 x 15."""
    meshonet("tfi", body_h5, "-o", "grid.vts")
    return Path("grid.vts")


@pytest.mark.parametrize(
    ("name", "start"),
    [("g.png", b"\x89PNG"), ("g.svg", b"<?xml"), ("g.pdf", b"%PDF"), ("g.html", b"<!doctype html>")],
)
def test_a_grid_becomes_a_picture(meshonet: Meshonet, grid_vts: Path, name: str, start: bytes) -> None:
    done = meshonet("plot", grid_vts, "-o", name)
    assert (done.code, done.out) == (0, "")
    assert Path(name).read_bytes().startswith(start)
    assert "coloured by max_angle" in done.err


def test_options_change_the_picture(meshonet: Meshonet, grid_vts: Path) -> None:
    pictures = set()
    for k, words in enumerate(
        [(), ("--zoom", "-1,1,-1,1"), ("--every", "4"), ("--metric", "none"), ("--metric", "skewness")]
    ):
        assert meshonet("plot", grid_vts, "-o", f"{k}.png", *words).code == 0
        pictures.add(Path(f"{k}.png").read_bytes())
    assert len(pictures) == 5


def test_json_says_what_was_drawn(meshonet: Meshonet, grid_vts: Path) -> None:
    report = meshonet("plot", grid_vts, "-o", "g.png", "--metric", "none", "--json").only
    assert (report["input"], report["output"], report["metric"], report["ni"]) == (
        "grid.vts",
        "g.png",
        None,
        41,
    )


def test_a_picture_goes_to_standard_output(meshonet: Meshonet, process: Process, grid_vts: Path) -> None:
    assert process("plot", grid_vts, "-o", "-", "--to", "pdf").stdout.startswith(b"%PDF")


def test_standard_output_is_a_png_unless_told() -> None:
    assert picture_format("-").name == "png"
    assert picture_format("-", "svg").name == "svg"


def test_a_batch_becomes_one_picture_each(meshonet: Meshonet, three_h5: Path) -> None:
    meshonet("tfi", three_h5, "-o", "grids.h5")
    assert meshonet("plot", "grids.h5", "-o", "{index}.png", "--metric", "none").code == 0
    assert sorted(path.name for path in Path().glob("*.png")) == ["0.png", "1.png", "2.png"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("-o", "g.vts"), "g.vts: vts is no picture; use .png, .svg, .pdf or .html"),
        (("-o", "g.png", "--metric", "beauty"), "--metric: metric 'beauty' is not known; use none or one of"),
        (("-o", "g.png", "--metric", "wall_growth"), "of the whole grid; draw growth"),
        (("-o", "g.png", "--zoom", "1,0,0,1"), "--zoom: '1,0,0,1' is not a box; use x0,x1,y0,y1"),
        (("-o", "g.png", "--zoom", "a"), "--zoom: 'a' is not a box"),
        (("-o", "g.png", "--zoom", "90,91,90,91"), "shows none of the grid"),
        (("-o", "g.png", "--every", "0"), "every 0-th line cannot be drawn; use 1 or more"),
    ],
)
def test_mistakes_get_a_line(
    meshonet: Meshonet, grid_vts: Path, words: tuple[str, ...], message: str
) -> None:
    done = meshonet("plot", grid_vts, *words)
    assert done.code == 2
    assert message in done.err
    assert done.err.count("\n") == 1
    assert not list(Path().glob("g.*"))


@pytest.mark.parametrize("figure", sorted({check.figure for each in PROFILES.values() for check in each}))
def test_each_figure_that_a_profile_judges_is_drawn_or_says_what_to_draw(
    meshonet: Meshonet, grid_vts: Path, figure: str
) -> None:
    for picture in ("g.png", "g.html"):
        done = meshonet("plot", grid_vts, "-o", picture, "--metric", figure)
        if done.code == 0:
            assert f"coloured by {figure}" in done.err
            assert figure in DRAWN
        else:
            assert f"{figure} is one figure of the whole grid; draw " in done.err


def test_matplotlib_composes_no_docstrings(monkeypatch: pytest.MonkeyPatch) -> None:
    from matplotlib import artist

    for owner, name in ((artist, "kwdoc"), (artist.Artist, "_update_set_signature_and_docstring")):
        monkeypatch.setattr(owner, name, getattr(owner, name))
    monkeypatch.delitem(sys.modules, "matplotlib.figure", raising=False)
    leave_out_docstrings()
    made = type("Made", (artist.Artist,), {})
    assert made.set.__doc__ is None
    assert artist.kwdoc(made) == ""
    assert made().set(zorder=3) == [None]


def test_what_has_loaded_matplotlib_keeps_its_docstrings() -> None:
    import matplotlib.figure  # noqa: F401
    from matplotlib import artist

    before = artist.kwdoc
    leave_out_docstrings()
    assert artist.kwdoc is before
