"""Discs that are full, folders that may not be written, readers that go: one line of error."""

import os
import resource
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from command_line import ROOT, Process

from meshonet.formats.output import _machine

ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONDONTWRITEBYTECODE": "1"}
"""Nothing compiled is kept: the first half of it is all that a full disc would take."""
MESHONET = [sys.executable, "-m", "meshonet_cli"]
OUTPUTS = [
    "out.h5", "out.cgns", "out.vts", "out.vtm", "out.p3d", "out.su2", "out.msh", "out.stl", "out.png",
    "case/case.foam",
]  # fmt: skip


def everything(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


@pytest.fixture(scope="module")
def grid(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An O grid of 121 x 41 nodes."""
    import matplotlib.font_manager  # noqa: F401 - which keeps a list of fonts: made here, not on the full disc

    path = tmp_path_factory.mktemp("faults") / "grid.vts"
    subprocess.run(
        [*MESHONET, "tfi", "naca:0012", "--res", "121x41", "-q", "-o", path], env=ENVIRONMENT, check=True
    )
    return path


@pytest.mark.parametrize("output", OUTPUTS)
def test_a_disc_that_is_full_leaves_what_was_there(grid: Path, output: str, tmp_path: Path) -> None:
    def small() -> None:  # no file may grow beyond this, which is how a full disc looks from inside
        resource.setrlimit(resource.RLIMIT_FSIZE, (9000, 9000))

    shutil.copy(grid, tmp_path / "grid.vts")
    if "/" not in output:
        (tmp_path / output).write_text("mine")
    before = everything(tmp_path)
    done = subprocess.run(
        [*MESHONET, "convert", "grid.vts", "-o", output], cwd=tmp_path, env=ENVIRONMENT, capture_output=True,
        preexec_fn=small, text=True,
    )  # fmt: skip
    assert done.returncode == 2
    assert f"{output}: cannot be written (" in done.stderr
    assert "free space or choose another place" in done.stderr
    assert done.stderr.count("\n") == 1
    assert everything(tmp_path) == before


def test_a_folder_that_may_not_be_written_is_told(grid: Path, tmp_path: Path) -> None:
    (tmp_path / "closed").mkdir()
    (tmp_path / "closed" / "out.vts").write_text("mine")
    (tmp_path / "closed").chmod(0o500)
    plain = ["setpriv", "--bounding-set=-dac_override,-dac_read_search"] if os.geteuid() == 0 else []
    if plain and shutil.which("setpriv") is None:
        pytest.skip("root may write everywhere, and there is no setpriv")
    words = [*plain, *MESHONET, "convert", str(grid), "-o", str(tmp_path / "closed" / "out.vts")]
    done = subprocess.run(words, env=ENVIRONMENT, capture_output=True, text=True)
    (tmp_path / "closed").chmod(0o700)
    assert done.returncode == 2
    assert "out.vts: cannot be written (Permission denied); " in done.stderr
    assert done.stderr.count("\n") == 1
    assert everything(tmp_path) == {"closed/out.vts": b"mine"}


@pytest.mark.parametrize("to", ["vts", "hdf5", "plot3d-ascii"])
def test_a_pipe_that_is_closed_is_no_error(grid: Path, to: str) -> None:
    line = f"{' '.join(MESHONET)} convert {grid} - --to {to} | head -c 1 | wc -c; echo ${{PIPESTATUS[0]}}"
    done = subprocess.run(["bash", "-c", line], env=ENVIRONMENT, capture_output=True, text=True)
    assert done.stdout.split() == ["1", "0"]
    assert "Traceback" not in done.stderr
    assert "rror" not in done.stderr


def test_what_a_killed_program_left_is_swept_by_the_next(
    process: Process, grid: Path, tmp_path: Path
) -> None:
    dead = subprocess.run(
        [sys.executable, "-c", "import os; print(os.getpid())"], capture_output=True, text=True
    )
    left = tmp_path / f".out.vts.{_machine()}-{dead.stdout.strip()}-0123abcd.meshonet-part"
    left.write_text("half")
    assert process("convert", grid, "next.vts").returncode == 0
    assert not left.exists()
