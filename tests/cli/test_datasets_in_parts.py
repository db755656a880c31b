"""Datasets in parts from the command line: made, continued, extended, shared by jobs, and used."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from command_line import Meshonet, dataset, duct

from meshonet_cli.batch import destination


@pytest.fixture
def five(tmp_path: Path) -> Path:
    """A dataset of five channels, and a folder of three squares."""
    (tmp_path / "squares").mkdir()
    for name, length in (("a", 1.0), ("b", 1.1), ("c", 1.2)):
        (tmp_path / "squares" / f"{name}.csv").write_text(f"0,0\n{length},0\n1,1\n0,1\n")
    samples = [duct(bump=0.05 * k) for k in range(5)]
    return dataset(tmp_path / "five.h5", "quad", *samples, names=tuple("vwxyz"))


MAKE = ("squares", "five.h5", "--res", "9x5", "-o", "out.h5")
PARTS = ("--part-size", "3", "-q")


def made(name: str = "out.h5") -> tuple[list[str], bytes]:
    """Names and nodes of a dataset, by h5py alone."""
    with h5py.File(name) as file:
        return list(file["names"].asstr()), file["nodes"][:].tobytes()


def changed(folder: str = "out") -> dict[str, int]:
    """When the parts were written."""
    return {path.name: path.stat().st_mtime_ns for path in sorted(Path(folder).iterdir())}


def test_parts_hold_what_one_file_holds(meshonet: Meshonet, five: Path) -> None:
    assert meshonet("tfi", *MAKE[:-1], "one.h5", "-q").code == 0
    done = meshonet("tfi", *MAKE, "--part-size", "3")
    assert done.code == 0
    assert "8 done" in done.err
    assert "five.h5#0:3[w] -> out.h5: 9 x 5" in done.err
    assert list(changed()) == [f"part-0000{k}.h5" for k in range(3)]
    assert made() == made("one.h5")


@pytest.mark.parametrize("jobs", [("--jobs", "2"), ("--shard",)])
def test_jobs_and_shards_make_the_same_parts(meshonet: Meshonet, five: Path, jobs: tuple[str, ...]) -> None:
    assert meshonet("tfi", *MAKE[:-1], "one.h5", *PARTS).code == 0
    shards = [("--shard", f"{k}/2") for k in (2, 1)] if jobs == ("--shard",) else [jobs]
    for words in shards:
        assert meshonet("tfi", *MAKE, *PARTS, *words).code == 0
    assert made() == made("one.h5")


def test_what_is_missing_is_made_and_nothing_else(meshonet: Meshonet, five: Path) -> None:
    assert meshonet("tfi", *MAKE, *PARTS).code == 0
    before, whole = changed(), made()
    Path("out/part-00001.h5").unlink()
    done = meshonet("tfi", *MAKE, "--part-size", "3", "--skip-existing")
    assert "3 done, 2 there already" in done.err
    after = changed()
    assert [name for name in before if before[name] != after[name]] == ["part-00001.h5"]
    assert made() == whole


def test_new_inputs_behind_the_old_ones_extend_it(meshonet: Meshonet, five: Path) -> None:
    assert meshonet("tfi", "squares", "--res", "9x5", "-o", "out.h5", "--part-size", "2", "-q").code == 0
    before = changed()
    assert meshonet("tfi", *MAKE, "--part-size", "2", "--skip-existing", "-q").code == 0
    assert before["part-00000.h5"] == changed()["part-00000.h5"]
    assert made()[0] == ["a", "b", "c", *"vwxyz"]


def test_other_options_inputs_and_sizes_are_refused(meshonet: Meshonet, five: Path) -> None:
    assert meshonet("tfi", *MAKE, *PARTS).code == 0
    before = changed()
    for words, message in (
        (
            ("--skip-existing", "--blending", "linear"),
            "was made with other options or another size of parts; ",
        ),
        (("--skip-existing", "--part-size", "2"), "was made with other options or another size of parts; "),
        ((), "is there already; continue with --skip-existing, or remove the parts: rm -r out"),
    ):
        done = meshonet("tfi", *MAKE, *PARTS, *words)
        assert done.code == 2
        assert done.err.startswith(f"error: out/part-00000.h5: {message}")
    Path("squares/aa.csv").write_text("0,0\n1,0\n1,1\n0,1\n")
    done = meshonet("tfi", *MAKE, *PARTS, "--skip-existing")
    assert "was not made of squares/aa.csv as it is now, at this place; " in done.err
    assert changed() == before


def test_a_changed_input_is_not_taken_for_the_old_one(meshonet: Meshonet, five: Path) -> None:
    assert meshonet("tfi", *MAKE, *PARTS).code == 0
    with h5py.File("five.h5", "a") as file:
        file["north"][4, 3, 1] += 0.01
    done = meshonet("tfi", *MAKE, *PARTS, "--skip-existing")
    assert "part-00002.h5: was not made of five.h5#3:5 as it is now" in done.err


def test_threads_and_reports_are_no_other_options(meshonet: Meshonet, five: Path) -> None:
    assert meshonet("tfi", *MAKE, *PARTS).code == 0
    done = meshonet("tfi", *MAKE, *PARTS, "--skip-existing", "--threads", "1", "--fail-on", "max_angle>179.9")
    assert done.code == 0


def test_members_that_fail_are_left_out_and_named(meshonet: Meshonet, five: Path) -> None:
    Path("squares/b.csv").write_text("not a shape")
    done = meshonet("tfi", *MAKE, *PARTS)
    assert done.code == 2
    assert made()[0] == ["a", "c", *"vwxyz"]
    with h5py.File("out.h5") as file:
        assert "squares/b.csv" in file["failed"].asstr()[0]
    done = meshonet("tfi", *MAKE, "--part-size", "3", "--skip-existing")
    assert "out/part-00000.h5 -> out.h5: there already; 1 of its inputs failed" in done.err
    Path("squares/b.csv").write_text("0,0\n1.1,0\n1,1\n0,1\n")
    assert meshonet("tfi", *MAKE, *PARTS, "--skip-existing").code == 0
    assert made()[0] == ["a", "b", "c", *"vwxyz"]


def test_parts_that_are_there_say_how_large_the_others_are(meshonet: Meshonet, five: Path) -> None:
    assert meshonet("tfi", *MAKE, *PARTS).code == 0
    Path("out/part-00001.h5").unlink()
    assert meshonet("tfi", *MAKE, "--skip-existing", "--shard", "2/2", "-q").code == 0
    assert len(made()[0]) == 8


def test_fewer_inputs_than_parts_that_are_there_are_told(meshonet: Meshonet, five: Path) -> None:
    assert meshonet("tfi", *MAKE, *PARTS).code == 0
    done = meshonet("tfi", "squares", *MAKE[2:], *PARTS, "--skip-existing")
    assert "warning: out.h5 also shows parts of an earlier run with more inputs: 2" in done.err


def test_many_inputs_are_written_in_parts_by_themselves(
    meshonet: Meshonet, five: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(destination, "MANY", 2)
    assert meshonet("tfi", *MAKE, "-q").code == 0
    assert Path("out/part-00000.h5").exists()
    assert len(made()[0]) == 8


def test_a_dataset_in_one_file_is_not_replaced_or_continued(meshonet: Meshonet, five: Path) -> None:
    assert meshonet("tfi", *MAKE, "-q").code == 0
    done = meshonet("tfi", *MAKE, *PARTS)
    assert done.err.startswith("error: out.h5: is there, and the parts would replace it; ")
    done = meshonet("tfi", *MAKE, "--skip-existing", "-q")
    assert done.err.startswith("error: out.h5: is a dataset in one file, which cannot be continued; ")


def test_only_datasets_have_parts(meshonet: Meshonet, five: Path) -> None:
    for output in ("{stem}.h5", "all.cgns", "-"):
        done = meshonet("tfi", *MAKE[:-1], output, *PARTS)
        assert done.err.startswith("error: --part-size: only a dataset has parts; write one .h5 file"), output


def test_families_are_drawn_in_parts(meshonet: Meshonet, tmp_path: Path) -> None:
    words = ("sample-boundary", "--family", "arch", "--count", "7", "--res", "9", "--split", "interpolation")
    assert meshonet(*words, "-o", "one.h5", "-q").code == 0
    for shard in ("1/2", "2/2"):
        assert meshonet(*words, "-o", "out.h5", *PARTS, "--shard", shard).code == 0
    with h5py.File("one.h5") as one, h5py.File("out.h5") as out:
        for name in ("south", "north", "parameters"):
            assert np.array_equal(one[name], out[name]), name
        for name in ("names", "split"):
            assert list(one[name].asstr()) == list(out[name].asstr()), name


def test_parts_serve_wherever_a_dataset_does(meshonet: Meshonet, five: Path) -> None:
    assert meshonet("tfi", *MAKE, *PARTS).code == 0
    assert len(meshonet("quality", "out.h5", "--json").objects) == 8
    assert meshonet("solve-pde", "out.h5", "-o", "smooth.h5", "-q").code == 0
    assert meshonet("plot", "out.h5#7", "-o", "last.png", "-q").code == 0
    assert meshonet("convert", "out.h5", "-o", "one.h5", "-q").code == 0
    assert made("one.h5") == made()
    assert meshonet("convert", "one.h5", "-o", "again.h5", *PARTS).code == 0
    assert made("again.h5") == made()
    assert meshonet("tfi", "out", "-o", "{index}.vts", "-q").code == 0  # the parts by themselves
    assert len(list(Path().glob("?.vts"))) == 8
