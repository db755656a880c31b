"""The functions that the commands are named after, called from Python."""

from pathlib import Path

import numpy as np
import pytest

from meshonet import convert, models, plot, quality
from meshonet.api.quality import single_grid
from meshonet.formats.registry import format_named, read_grids
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError


def sheared(name: str = "", shift: float = 0.5) -> Grid:
    x, y = np.meshgrid(np.arange(5.0), np.arange(4.0), indexing="ij")
    return Grid.from_nodes(np.stack([x + shift * y, y], axis=-1), name=name)


@pytest.fixture
def grid_vts(tmp_path: Path) -> Path:
    write = format_named("vts").write_grids
    assert write is not None
    write(tmp_path / "grid.vts", [sheared()])
    return tmp_path / "grid.vts"


def test_quality_measures_a_grid_or_a_file(grid_vts: Path) -> None:
    for grid in (sheared(), grid_vts, str(grid_vts)):
        report = quality(grid, profile="openfoam", compare=sheared(shift=0.0))
        angle = report.quality["max_angle"]
        assert angle.max == pytest.approx(90 + np.degrees(np.arctan(0.5)), rel=1e-12)
        assert report.comparison is not None
        assert report.comparison.difference.max == pytest.approx(1.5, rel=1e-12)
        assert report.as_dict()["profile"]["name"] == "openfoam"
        assert report.as_dict()["compare"]["max"] == pytest.approx(1.5, rel=1e-12)


def test_gates_are_given_as_on_the_command_line() -> None:
    report = quality(sheared())  # angles of 90 +- 26.57 degrees
    (line,) = report.broken(["max_angle>116", "max_angle>117", "min_angle<63"])
    assert line.startswith("max_angle.max is 116.565 at i=")
    assert line.endswith(", which fails the gate 'max_angle>116'")
    assert report.broken("max_angle>116") == [line]
    assert report.broken(["max_angle>117"]) == report.broken() == []
    assert report.judgement("max_angle.mean>116").verdict == "fail"
    with pytest.raises(InputError, match="metric 'max_angel' is not known; did you mean 'max_angle'"):
        report.broken("max_angel>116")
    with pytest.raises(InputError, match="this grid has no y_plus"):
        report.broken("y_plus>1")
    strict = quality(sheared(), profile="openfoam").broken(["max_angle>116"])
    assert line in strict
    assert "{" not in "".join(strict)


def test_an_unknown_profile_is_refused() -> None:
    with pytest.raises(InputError, match="profile: profile 'mine' is not known; use one of openfoam"):
        quality(sheared(), profile="mine")


def test_a_file_of_several_grids_is_refused(tmp_path: Path) -> None:
    write = format_named("hdf5").write_grids
    assert write is not None
    write(tmp_path / "two.h5", [sheared("a"), sheared("b")])
    with pytest.raises(InputError, match="holds several, where a grid is asked for; read them one by one"):
        single_grid(tmp_path / "two.h5")


def test_plot_draws_what_it_is_told(grid_vts: Path, tmp_path: Path) -> None:
    plot(sheared(), tmp_path / "a.png", metric="skewness")
    plot(grid_vts, tmp_path / "b.svg", metric=None, zoom=(0, 2, 0, 2), every=1)
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    assert b"</svg>" in (tmp_path / "b.svg").read_bytes()
    with pytest.raises(InputError, match="zoom: '1,0,0,1' is not a box"):
        plot(sheared(), tmp_path / "c.png", zoom=(1, 0, 0, 1))
    with pytest.raises(InputError, match="metric: metric 'beauty' is not known"):
        plot(sheared(), tmp_path / "c.png", metric="beauty")


def test_convert_writes_what_can_be_read_again(grid_vts: Path, tmp_path: Path) -> None:
    convert(grid_vts, tmp_path / "b.h5", swap=True)
    (grid,) = read_grids(str(tmp_path / "b.h5"))
    assert (grid.ni, grid.nj) == (4, 5)
    convert(grid_vts, tmp_path / "c.p3d", extrude=0.5)
    assert len((tmp_path / "c.p3d").read_text().split()) > 2 * 3 * 20
    with pytest.raises(InputError, match="geo holds flat grids only"):
        convert(grid_vts, tmp_path / "d.geo", extrude=0.5)


def test_many_files_are_converted_as_by_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from meshonet_cli.app import run

    monkeypatch.chdir(tmp_path)
    Path("folder").mkdir()
    for name, shift in (("a", 0.0), ("b", 1.0), ("c", 2.0)):
        sheared(name, shift).write(f"folder/{name}.vts")
    assert run(["convert", "folder", "-o", "command.h5", "-q"]) == 0
    command = list(read_grids("command.h5"))
    for source in ("folder", Path("folder"), [f"folder/{name}.vts" for name in "abc"]):
        convert(source, "python.h5")
        grids = list(read_grids("python.h5"))
        assert [grid.name for grid in grids] == [grid.name for grid in command]
        for grid, other in zip(grids, command, strict=True):
            np.testing.assert_array_equal(grid.nodes, other.nodes)
    for source in ("folder", "command.h5"):
        with pytest.raises(InputError, match=r"all\.vts: vts files hold one, and there are several"):
            convert(source, "all.vts")
    with pytest.raises(InputError, match="source: there is nothing to convert"):
        convert([], "all.h5")
    assert not list(Path().glob("all.*"))


def test_models_say_what_they_are() -> None:
    assert {model["topology"] for model in models()} == {"o", "quad"}
