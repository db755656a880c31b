"""`meshonet sample-boundary` of CAD files (extra ``cad``)."""

from pathlib import Path

import pytest
from command_line import Meshonet, Process

pytest.importorskip("OCP")

from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeSphere
from OCP.BRepTools import BRepTools


@pytest.fixture(autouse=True)
def _files(meshonet: Meshonet) -> None:
    BRepTools.Write_s(BRepPrimAPI_MakeSphere(1.0).Shape(), "ball.brep")
    BRepTools.Write_s(BRepPrimAPI_MakeBox(1.0, 2.0, 3.0).Shape(), "box.brep")


@pytest.fixture
def untried(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have files read without the trial in a process of its own, which takes a second."""
    monkeypatch.setattr("meshonet.formats.cad.read._is_readable", lambda *_: True)


def test_a_ball_becomes_a_surface_and_a_volume(meshonet: Meshonet) -> None:
    done = meshonet("sample-boundary", "ball.brep", "--res", "16", "-o", "ball.xyz", "--json")
    assert (done.code, done.only["blocks"]) == (0, 1)
    options = ["--method", "hyperbolic", "--first-cell", "1e-2", "--layers", "20", "--far-field", "3"]
    done = meshonet("solve-pde", "ball.xyz", *options, "-o", "ball.cgns")
    assert done.code == 0
    assert "became a core" in done.err


@pytest.mark.usefixtures("untried")
@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--te-spacing", "0.1"], "--te-spacing is of no use to CAD files"),
        (["--res", "20x30"], "give one number"),
        (["--spacing", "tanh"], "use curvature, uniform or cosine"),
        (["--sensors", "5"], "patches have no sensors"),
    ],
)
def test_options_without_use_are_refused(options: list[str], message: str, meshonet: Meshonet) -> None:
    done = meshonet("sample-boundary", "box.brep", *options, "-o", "box.xyz")
    assert done.code == 2
    assert message in done.err
    assert not Path("box.xyz").exists()


@pytest.mark.usefixtures("untried")
def test_other_commands_say_what_to_do_with_a_cad_file(meshonet: Meshonet) -> None:
    done = meshonet("infer", "box.brep", "-o", "box.vts")
    assert done.code == 2
    assert "make patches first: meshonet sample-boundary" in done.err


@pytest.mark.usefixtures("untried")
def test_files_of_one_run_are_of_one_kind(meshonet: Meshonet) -> None:
    done = meshonet("sample-boundary", "box.brep", "naca:0012", "-o", "{stem}.vtm")
    assert "is no CAD file, and the first input is one" in done.err
    assert done.code == 2
    assert not Path("naca0012.vtm").exists()


def test_a_stream_is_read_once_and_is_a_cad_file_if_its_format_is(process: Process, tmp_path: Path) -> None:
    BRepTools.Write_s(BRepPrimAPI_MakeBox(1.0, 2.0, 3.0).Shape(), str(tmp_path / "box.brep"))
    data = (tmp_path / "box.brep").read_bytes()
    words = ["sample-boundary", "-", "--res", "20", "-o"]
    assert process(*words, "box.xyz", "--from", "brep", input=data).returncode == 0
    assert process(*words, "edges.h5", input=b"1 0\n0 0\n0 1\n1 1\n1 0\n").returncode == 0
    assert {path.name for path in tmp_path.iterdir()} >= {"box.xyz", "edges.h5"}
