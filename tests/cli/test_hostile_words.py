"""Hostile names, patterns and places: one clear line, nothing written, nothing that acts on a terminal."""

import os
import subprocess
import sys
import threading
from pathlib import Path

import h5py
import numpy as np
import pytest
from command_line import ROOT, Meshonet

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch

SQUARE = np.stack(np.meshgrid(np.linspace(0, 1, 5), np.linspace(0, 1, 4), indexing="ij"), axis=-1)


@pytest.mark.parametrize(
    "pattern",
    ["{index:c}.vts", "{stem:>1000000000}.vts", "{index:99999d}.vts", "{name:{index}}.vts", "{stem!x}.h5"],
)
def test_a_format_of_a_field_that_makes_no_name_is_refused(meshonet: Meshonet, pattern: str) -> None:
    done = meshonet("tfi", "naca:0012", "--res", "9", "-o", pattern)
    assert done.code == 2
    assert "has a field that is not known" in done.err or "in a format that makes no name" in done.err
    assert done.err.count("\n") == 1
    assert not list(Path().iterdir())


@pytest.mark.parametrize("pattern", ["{stem:_>300}.vts", "{stem}" * 40 + ".vts"])
def test_a_name_that_no_file_can_have_is_refused(meshonet: Meshonet, pattern: str) -> None:
    done = meshonet("tfi", "naca:0012", "--res", "9", "-o", pattern)
    assert done.code == 2
    assert "its output has a name of more than 255 bytes; use a shorter -o" in done.err
    assert not list(Path().iterdir())


@pytest.mark.parametrize(
    "pattern", ["{index:04d}-{stem:.4}.vts", "{index:+d}.vts", "{name:_<20}.vts", "{index:x}.vts"]
)
def test_other_formats_of_fields_stay(meshonet: Meshonet, pattern: str) -> None:
    assert meshonet("tfi", "naca:0012", "--res", "9", "-o", pattern).code == 0


def test_escape_sequences_in_names_are_quoted(meshonet: Meshonet) -> None:
    """Of the output, and of a grid in a dataset whose name comes from elsewhere."""
    Grid.from_nodes(SQUARE, name="a\x1b[31mb").write("grids.h5")
    for words in (
        ("convert", "grids.h5", "out\x1b]0;x\x07.vts"),
        ("quality", "grids.h5"),
        ("quality", "grids.h5", "--fail-on", "max_angle>1", "--summary"),
        ("infer", "no\x1b[2Jfile.dat", "-o", "g.vts"),
        ("infer", "naca:0012", "--\x1b[31m", "-o", "g.vts"),
    ):
        done = meshonet(*words)
        assert "\x1b" not in done.out + done.err
        assert "\x07" not in done.out + done.err
    assert "out\\x1b]0;x\\x07.vts" in meshonet("convert", "grids.h5", "out\x1b]0;x\x07.vts").err


def test_a_dataset_without_its_bad_members_says_so(meshonet: Meshonet) -> None:
    Path("bad.dat").write_text("1 nan\n")
    done = meshonet("tfi", "naca:0012", "bad.dat", "--res", "9", "-o", "all.h5")
    assert done.code == 2
    assert "1 done, 1 failed and not in all.h5 in " in done.err
    with h5py.File("all.h5") as file:
        assert len(file["nodes"]) == 1
    assert "and not in" not in meshonet("tfi", "naca:0012", "bad.dat", "--res", "9", "-o", "d/{stem}.vts").err


@pytest.mark.parametrize("key", ["airfoil", "outline"])
def test_a_device_is_no_section(meshonet: Meshonet, key: str) -> None:
    os.mkfifo("pipe.dat")
    for name in ("/dev/zero", "pipe.dat"):
        rows = "".join(f'[[sections]]\n{key} = "{name}"\nchord = 1.0\nz = {z}\n' for z in (0.0, 1.0))
        Path("wing.toml").write_text(rows)
        done = meshonet("stack", "wing.toml", "-o", "wing.h5")
        assert done.code == 2
        assert f"sections[0].{key}: {name} is no regular file" in done.err


def test_a_device_is_no_input(meshonet: Meshonet) -> None:
    done = meshonet("infer", "/dev/zero", "-o", "g.vts")
    assert (done.code, done.err) == (
        2, "error: /dev/zero: is a device; name a file, or - for standard input\n"
    )  # fmt: skip


def test_a_pipe_in_place_of_a_part_is_no_part(meshonet: Meshonet) -> None:
    assert (
        meshonet("sample-boundary", "--family", "arch", "--count", "4", "--part-size", "2", "-o", "a.h5").code
        == 0
    )
    Path("a/part-00001.h5").unlink()
    os.mkfifo("a/part-00001.h5")
    done = meshonet("tfi", "a.h5", "-o", "g.h5")
    assert done.code == 2
    assert "its part a/part-00001.h5 is missing" in done.err


def test_text_of_many_megabytes_is_not_read(meshonet: Meshonet) -> None:
    with Path("large.dat").open("wb") as file:
        file.truncate(1 << 34)
    done = meshonet("infer", "large.dat", "--from", "airfoil", "-o", "g.vts")
    assert done.code == 2
    assert "large.dat: 16384 MB are too much for a text of points; give a file below 16 MB" in done.err


@pytest.mark.parametrize("output", ["g.png", "g.svg", "case/case.foam"])
def test_a_grid_of_one_point_is_refused(meshonet: Meshonet, output: str) -> None:
    Grid.from_nodes(np.zeros((5, 4, 2))).write("zeros.vts")
    words = ("convert", "zeros.vts", output) if "foam" in output else ("plot", "zeros.vts", "-o", output)
    done = meshonet(*words)
    assert done.code == 2
    assert "the points have no extent" in done.err
    assert "internal error" not in done.err
    assert not Path(output).exists()


@pytest.mark.parametrize("name", ["</script>", "<!--<script>"])
def test_a_name_cannot_end_the_facts_of_a_page(meshonet: Meshonet, name: str) -> None:
    Grid.from_nodes(SQUARE, "quad", (Patch(name, "south", 0, 4),)).write("g.vts")
    assert meshonet("plot", "g.vts", "-o", "g.html").code == 0
    page = Path("g.html").read_text()
    facts = page[page.index('id="facts">') :].split("</script>")[0]
    assert "\\u003c" in facts or name not in page
    assert "<" not in facts


def test_members_of_a_family_are_called_by_their_number(meshonet: Meshonet) -> None:
    done = meshonet("sample-boundary", "--family", "hexagon", "--count", "3", "-o", "h.h5", "--json")
    assert [one["name"] for one in done.objects] == ["hexagon-0", "hexagon-1", "hexagon-2"]
    done = meshonet("tfi", "h.h5", "--res", "9", "-o", "{name}.vts", "--json")
    assert [one["name"] for one in done.objects] == ["hexagon-0", "hexagon-1", "hexagon-2"]
    assert Path("hexagon-2.vts").exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("infer", "naca:0012", "--pitch", "1e300,0", "-o", "g.vtm"), "a pitch of length 1e+300; give DX,DY"),
        (("sweep", "circle:0.5", "path.toml", "-o", "g.vtm"), "radius: 4.94066e-324 is out of range"),
    ],
)
def test_pythons_warnings_do_not_reach_the_user(tmp_path: Path, words: tuple[str, ...], message: str) -> None:
    (tmp_path / "path.toml").write_text("[[pieces]]\narc = 90\nradius = 5e-324\ntowards = [0, 1, 0]\n")
    done = subprocess.run(
        [sys.executable, "-m", "meshonet_cli", *words], cwd=tmp_path, capture_output=True, text=True,
        timeout=120, env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert done.returncode == 2
    assert message in done.stderr
    assert done.stderr.count("\n") == 1


def test_a_warning_of_a_library_is_not_shown_unless_asked_for(tmp_path: Path) -> None:
    code = (
        "import sys, warnings\nfrom meshonet_cli import app\n"
        "app.run = lambda words: warnings.warn('of a library') or 0\napp.main()"
    )
    shown = []
    for word in ("doctor", "--debug"):
        done = subprocess.run(
            [sys.executable, "-c", code, word], cwd=tmp_path, capture_output=True, text=True, timeout=60,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
        )  # fmt: skip
        shown.append("of a library" in done.stderr)
    assert shown == [False, True]


def test_a_stream_without_an_end_is_refused(meshonet: Meshonet, monkeypatch: pytest.MonkeyPatch) -> None:
    from meshonet.formats import source

    monkeypatch.setattr(source, "_MOST_PIPED", 1000)
    os.mkfifo("pipe")
    feeder = threading.Thread(target=_fed, args=(Path("pipe"),), daemon=True)
    feeder.start()
    done = meshonet("infer", "pipe", "-o", "g.vts")
    assert done.code == 2
    assert "pipe: is a stream of more than" in done.err
    feeder.join(10)


def _fed(pipe: Path) -> None:
    try:
        with pipe.open("wb", buffering=0) as stream:
            for _ in range(200):
                stream.write(b"1 0\n" * 1000)
    except BrokenPipeError:
        pass
