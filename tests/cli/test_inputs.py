"""Inputs that stand for many: folders, zip archives, lists, samples of datasets; and shards of them."""

import zipfile
from pathlib import Path

import pytest
from command_line import Meshonet, Process, dataset, duct

SQUARE = "0,0\n1,0\n1,1\n0,1\n"
GRIDS = ("--res", "9x4", "-q")


@pytest.fixture
def shapes(tmp_path: Path) -> Path:
    """A folder of squares, some of them deeper down, and of what is passed over."""
    folder = tmp_path / "shapes"
    (folder / "more").mkdir(parents=True)
    (folder / "out").mkdir()
    for name in ("b.csv", "A.CSV", "more/c.csv", ".hidden.csv", "notes.md", "out/part-00000.csv"):
        (folder / name).write_text(SQUARE)
    dataset(folder / "out.h5", "quad", duct(), duct(bump=0.1))
    return folder


@pytest.fixture
def archive(tmp_path: Path) -> Path:
    """The same in a zip archive, with what must not act as a path or on a terminal."""
    path = tmp_path / "shapes.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        for name in (
            "b.csv",
            "more/c.csv",
            "__MACOSX/b.csv",
            ".hidden.csv",
            "read.me",
            "../up.csv",
            "/root.csv",
        ):
            file.writestr(name, SQUARE)
        file.writestr("red\x1b[31m.csv", "no numbers")
    return path


def stems(suffix: str = ".vts") -> list[str]:
    return sorted(path.stem for path in Path().glob(f"*{suffix}"))


def test_a_folder_stands_for_its_readable_files_and_those_of_its_folders(
    meshonet: Meshonet, shapes: Path
) -> None:
    done = meshonet("tfi", shapes, "-o", "{index}-{stem}.vts", "--res", "5x4")
    assert (done.code, stems()) == (0, ["0-A", "1-b", "2-c", "3-out", "4-out"])
    assert "5 done" in done.err


def test_members_of_an_archive_are_read_where_they_are(meshonet: Meshonet, archive: Path) -> None:
    done = meshonet("tfi", archive, "-o", "{stem}.vts", *GRIDS)
    assert stems() == ["b", "c", "root"]
    assert done.code == 2
    assert "shapes.zip/red\\x1b[31m.csv: " in done.err
    assert "\x1b" not in done.err
    assert not (archive.parent.parent / "up.csv").exists()


def test_a_member_of_an_archive_is_an_input_by_itself(meshonet: Meshonet, archive: Path) -> None:
    assert meshonet("tfi", "shapes.zip/more/c.csv", "-o", "c.vts", *GRIDS).code == 0
    done = meshonet("tfi", "shapes.zip/more/d.csv", "-o", "d.vts", *GRIDS)
    assert done.err == "error: shapes.zip/more/d.csv: no such file in the archive; list it: unzip -l\n"


def test_archives_that_lie_are_refused(meshonet: Meshonet, tmp_path: Path, archive: Path) -> None:
    data = bytearray(archive.read_bytes())
    where = data.rindex(b"PK\x01\x02", 0, data.index(b"b.csv", data.index(b"PK\x01\x02")))
    data[where + 24 : where + 28] = (0xFFFFFFF0).to_bytes(4, "little")  # its size, unpacked
    (tmp_path / "bomb.zip").write_bytes(data)
    done = meshonet("tfi", "bomb.zip/b.csv", "-o", "b.vts", *GRIDS)
    assert done.err.startswith("error: bomb.zip/b.csv: claims 4294967280 bytes, more than 268435456; ")
    data = bytearray(archive.read_bytes())
    data[where + 8] |= 1  # encrypted
    (tmp_path / "secret.zip").write_bytes(data)
    done = meshonet("tfi", "secret.zip/b.csv", "-o", "b.vts", *GRIDS)
    assert "cannot be unpacked" in done.err
    (tmp_path / "text.zip").write_text("no archive")
    done = meshonet("tfi", "text.zip", "-o", "b.vts", *GRIDS)
    assert done.err.startswith("error: text.zip: is no zip archive ")
    for cut in (30, 200, len(data) - 30):
        (tmp_path / "cut.zip").write_bytes(data[:cut])
        done = meshonet("tfi", "cut.zip", "-o", "b.vts", *GRIDS)
        assert (done.code, done.err.count("\n")) == (2, 1)
    assert stems() == []


def test_a_list_has_an_input_a_line(meshonet: Meshonet, shapes: Path) -> None:
    lines = ["# ours", "shapes/b.csv", "", "  naca:0012  ", "shapes/more", "@others", "missing.csv"]
    Path("list").write_text("\ufeff" + "\r\n".join(lines))
    Path("others").write_text("shapes/out.h5#1")
    done = meshonet("tfi", "@list", "-o", "{index}-{stem}.vts", *GRIDS)
    assert stems() == ["0-b", "1-naca0012", "2-c", "3-out"]
    assert done.err == "error: missing.csv: no such file; check the path\n"


def test_a_list_can_come_through_a_pipe(process: Process, shapes: Path) -> None:
    done = process("tfi", "@-", "-o", "{stem}.vts", *GRIDS, input=b"shapes/b.csv\nshapes/more/c.csv")
    assert done.returncode == 0, done.stderr
    assert {path.stem for path in shapes.parent.glob("*.vts")} == {"b", "c"}


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("@list", "@list: lists name each other; "),
        ("# nothing", "@list: holds no inputs; "),
        ("a\0b", "@list: line 1: is no list of inputs; "),
        ("x" * 9000, "@list: line 1: is no list of inputs; "),
    ],
)
def test_a_list_that_is_none_gets_a_line(meshonet: Meshonet, content: str, message: str) -> None:
    Path("list").write_text(content)
    done = meshonet("tfi", "@list", "-o", "{stem}.vts", *GRIDS)
    assert (done.code, done.err.count("\n")) == (2, 1)
    assert done.err.startswith(f"error: {message}")


def test_names_are_picked_whatever_their_case(meshonet: Meshonet, shapes: Path) -> None:
    for pattern, taken in (("a*", ["A"]), ("more/*", ["c"]), ("?.csv", ["A", "b", "c"])):
        for path in Path().glob("*.vts"):
            path.unlink()
        assert meshonet("tfi", shapes, "--pick", pattern, "-o", "{stem}.vts", *GRIDS).code == 0
        assert stems() == taken
    Path("list").write_text("shapes/b.csv\nnaca:0012")
    assert meshonet("tfi", "@list", "--pick", "B", "--pick", "naca*", "-o", "l-{stem}.vts", *GRIDS).code == 0
    assert [stem for stem in stems() if stem.startswith("l-")] == ["l-b", "l-naca0012"]


def test_a_pattern_that_matches_nothing_gets_a_line(meshonet: Meshonet, shapes: Path) -> None:
    done = meshonet("tfi", shapes, "--pick", "naca*", "-o", "{stem}.vts", *GRIDS)
    assert done.code == 2
    assert done.err.startswith("error: --pick: 'naca*' matches none of 4 files; names are like '")
    done = meshonet("tfi", "shapes/b.csv", "--pick", "b", "-o", "{stem}.vts", *GRIDS)
    assert done.err.startswith("error: --pick: there is nothing to pick from; ")


def test_a_folder_without_readable_files_gets_a_line(meshonet: Meshonet, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "empty" / "loop").symlink_to("..")
    done = meshonet("quality", "empty")
    assert (done.code, done.err.count("\n")) == (2, 1)
    assert done.err.startswith("error: empty: holds no file that can be read; endings are ")


def test_samples_of_a_dataset_are_inputs(meshonet: Meshonet, three_h5: Path) -> None:
    for words, names in (("#1", ["low"]), ("#1:", ["high", "low"]), ("#::2", ["flat", "high"])):
        for path in Path().glob("*.vts"):
            path.unlink()
        assert meshonet("tfi", f"three.h5{words}", "-o", "{name}.vts", "-q").code == 0
        assert stems() == names
    assert meshonet("tfi", "three.h5#7", "-o", "x.vts").err.startswith("error: three.h5: has 3 samples; ")
    done = meshonet("tfi", "three.h5#x", "-o", "x.vts")
    assert "there is only #train, #test, #7 or #5:9" in done.err


def test_shards_share_the_inputs_and_keep_their_numbers(
    meshonet: Meshonet, shapes: Path, three_h5: Path
) -> None:
    words = (shapes, three_h5, "-o", "{index}-{stem}.vts", *GRIDS)
    assert meshonet("tfi", *words).code == 0
    whole = {path.name: path.read_bytes()[:200] for path in Path().glob("*.vts")}
    for path in Path().glob("*.vts"):
        path.unlink()
    counts = []
    for k in (1, 2, 3):
        before = len(stems())
        assert meshonet("tfi", *words, "--shard", f"{k}/3").code == 0
        counts.append(len(stems()) - before)
    assert {path.name for path in Path().glob("*.vts")} == set(whole)
    assert sorted(counts) == [2, 3, 3]


@pytest.mark.parametrize("shard", ["0/3", "4/3", "3", "1/2/3", "a/b", "-1/2"])
def test_a_shard_that_is_none_gets_a_line(meshonet: Meshonet, duct_h5: Path, shard: str) -> None:
    done = meshonet("tfi", duct_h5, "-o", "g.vts", "--shard", shard)
    assert (done.code, done.err.count("\n")) == (2, 1)
    assert done.err.startswith("error: --shard: ")


def test_a_file_of_several_has_no_numbers_in_a_shard(meshonet: Meshonet) -> None:
    Path("two.wkt").write_text("MULTIPOLYGON (((0 0,1 0,1 1,0 1,0 0)),((5 0,6 0,6 1,5 1,5 0)))")
    done = meshonet("tfi", "two.wkt", "-o", "{index}.vts", "--shard", "1/2", *GRIDS)
    assert done.code == 2
    assert "use {name} in place of {index}" in done.err


def test_quality_and_plots_take_folders_too(meshonet: Meshonet, shapes: Path) -> None:
    meshonet("tfi", shapes, "--pick", "?", "-o", "grids/{stem}.vts", *GRIDS)
    done = meshonet("quality", "grids", "--json")
    assert [report["input"] for report in done.objects] == [f"grids/{stem}.vts" for stem in ("A", "b", "c")]
    assert meshonet("convert", "grids", "-o", "all.h5", "-q").code == 0
    assert len(meshonet("quality", "all.h5", "--json").objects) == 3


def test_inputs_are_found_as_they_are_needed(process: Process, tmp_path: Path) -> None:
    (tmp_path / "list").write_text("missing.csv\n" * 20_000)
    with (tmp_path / "list").open("a") as file:
        file.write("x" * 9000)
    done = process("tfi", "@list", "-o", "{stem}.vts", "--shard", "1/20001", "-q")
    lines = done.stderr.decode().splitlines()
    assert [line.split(": ")[1] for line in lines] == ["missing.csv"]
