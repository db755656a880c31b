"""Datasets in parts: written whole, shown as one, continued, extended; and indices that lie."""

import json
import multiprocessing
import os
from collections.abc import Iterator
from pathlib import Path

import h5py
import numpy as np
import pytest

from meshonet.formats.hdf5.parts import Failed, Input, OtherPartsError, PartFiles, digest_of
from meshonet.formats.registry import read_grids, read_shapes
from meshonet.geometry.blocks.grid import Grid, Origin
from meshonet.geometry.errors import InputError


def grid(number: int, ni: int = 4) -> Grid:
    x, y = np.meshgrid(np.linspace(0.0, 1.0 + number, ni), np.linspace(0.0, 1.0, 3), indexing="ij")
    origin = Origin((("width", 1.0 + number),), "test" if number % 3 == 0 else "train")
    return Grid.from_nodes(np.stack([x, y], axis=-1), "quad", name=f"g{number}", origin=origin)


def inputs(*numbers: int) -> list[Input]:
    return [Input(f"{number}.dat", digest_of(str(number))) for number in numbers]


@pytest.fixture
def files(tmp_path: Path) -> PartFiles:
    """Three parts of ten grids, of which the fourth failed, and their index."""
    files = PartFiles(tmp_path / "out.h5", "request")
    for number, (start, stop) in enumerate(((0, 4), (4, 8), (8, 10))):
        failed = [Failed("3.dat", "3.dat", "no such file", again=False)] if number == 0 else []
        grids = (grid(k) for k in range(start, stop) if k != 3)
        files.write(number, "grids", grids, inputs(*range(start, stop)), failed)
    assert files.build() == 9
    return files


NAMES = [f"g{k}" for k in range(10) if k != 3]


def test_parts_are_read_as_one(files: PartFiles) -> None:
    grids = list(read_grids(str(files.index)))
    assert [each.name for each in grids] == NAMES
    assert np.array_equal(grids[-1].nodes, grid(9).nodes)
    assert grids[-1].origin == grid(9).origin
    assert [shape.name for shape in read_shapes(str(files.index))] == NAMES


def test_ten_lines_of_h5py_read_it(files: PartFiles) -> None:
    with h5py.File(files.index) as file:
        assert file.attrs["format"] == "meshonet-grid"
        assert file["nodes"].shape == (9, 4, 3, 2)
        assert np.array_equal(file["nodes"][8], grid(9).nodes)
        assert list(file["names"].asstr()) == NAMES
        assert list(file["parameters"].attrs["names"]) == ["width"]
        assert [json.loads(text)[0] for text in file["failed"].asstr()] == ["3.dat"]


def test_samples_are_chosen_across_parts(files: PartFiles) -> None:
    def names(words: str) -> list[str]:
        return [each.name for each in read_grids(f"{files.index}#{words}")]

    assert names("8") == ["g9"]
    assert names("2:4") == ["g2", "g4"]
    assert names("::3") == ["g0", "g4", "g7"]
    assert names("test") == ["g0", "g6", "g9"]
    assert names("test,1:") == ["g6", "g9"]
    with pytest.raises(InputError, match="has 9 samples"):
        names("9")


def test_the_folder_can_be_moved_with_its_index(files: PartFiles, tmp_path: Path) -> None:
    (tmp_path / "else where").mkdir()
    for path in (files.index, files.folder):
        path.rename(tmp_path / "else where" / path.name)
    assert len(list(read_grids(str(tmp_path / "else where" / "out.h5")))) == 9


def test_a_percent_sign_is_no_pattern(tmp_path: Path) -> None:
    files = PartFiles(tmp_path / "50%b.h5", "request")
    files.write(0, "grids", [grid(0)], inputs(0), [])
    files.build()
    assert [each.name for each in read_grids(str(files.index))] == ["g0"]
    with h5py.File(files.index) as file:
        assert np.array_equal(file["nodes"][0], grid(0).nodes)


def test_a_missing_part_gets_one_line_that_names_it(files: PartFiles) -> None:
    files.path(1).unlink()
    with pytest.raises(InputError, match=r"its part .*out/part-00001.h5 is missing; put it back"):
        next(read_grids(str(files.index)))
    files.path(0).unlink()
    with pytest.raises(InputError, match=r"part-00000\.h5 is missing, as is 1 more of 3"):
        next(read_grids(str(files.index)))


def test_a_part_that_is_a_pipe_is_not_waited_for(files: PartFiles) -> None:
    files.path(1).unlink()
    os.mkfifo(files.path(1))
    with pytest.raises(InputError, match=r"its part .*out/part-00001.h5 is missing; put it back"):
        next(read_grids(str(files.index)))


def names_and_errors(grids: Iterator[Grid]) -> list[str]:
    outcomes = []
    while True:
        try:
            outcomes.append(next(grids).name)
        except StopIteration:
            return outcomes
        except InputError as error:
            outcomes.append(str(error))


def test_a_damaged_part_gets_one_line_and_the_others_are_read(files: PartFiles) -> None:
    files.path(1).write_bytes(files.path(1).read_bytes()[:2000])
    outcomes = names_and_errors(read_grids(str(files.index)))
    assert outcomes[:3] + outcomes[4:] == ["g0", "g1", "g2", "g8", "g9"]
    assert "part-00001.h5: " in outcomes[3]


def test_a_damaged_sample_is_named_by_its_part(files: PartFiles) -> None:
    with h5py.File(files.path(1), "a") as file:
        file["nodes"][2, 0, 0] = np.nan
    outcomes = names_and_errors(read_grids(str(files.index)))
    assert "part-00001.h5: sample 2: " in outcomes[5]
    assert len(outcomes) == 9


def test_a_part_with_fewer_samples_than_shown_is_refused(files: PartFiles) -> None:
    files.path(1).unlink()
    files.write(1, "grids", [grid(4)], inputs(4), [])
    assert "holds 1 samples, where the index shows 4" in names_and_errors(read_grids(str(files.index)))[3]


def test_what_is_there_is_told_from_what_is_not(files: PartFiles) -> None:
    assert files.state(0, inputs(0, 1, 2, 3)) == "complete"
    assert files.state(2, inputs(8, 9)) == "complete"
    assert files.state(2, inputs(8, 9, 10)) == "extended"
    assert files.state(3, inputs(10)) == "missing"
    changed = [*inputs(0, 1, 2), Input("3.dat", "another")]
    assert files.state(0, changed) == "extended"  # the one that failed
    with pytest.raises(OtherPartsError, match=r"was not made of 5\.dat as it is now"):
        files.state(1, [*inputs(4), Input("5.dat", "another"), *inputs(6, 7)])
    with pytest.raises(OtherPartsError, match="was made of 2 inputs, of which 1 are left"):
        files.state(2, inputs(8))
    with pytest.raises(OtherPartsError, match="was made with other options"):
        PartFiles(files.index, "other").state(0, inputs(0, 1, 2, 3))


def test_a_part_of_which_a_member_ran_out_of_memory_is_made_again(files: PartFiles) -> None:
    files.write(
        0, "grids", [grid(0)], inputs(0, 1), [Failed("1.dat", "1.dat", "not enough memory", again=True)]
    )
    assert files.state(0, inputs(0, 1)) == "extended"


def test_a_part_without_samples_is_not_shown(files: PartFiles) -> None:
    files.write(1, "grids", [], inputs(4, 5), [Failed("4.dat", "4.dat", "empty", again=False)])
    assert files.build() == 5
    assert [each.name for each in read_grids(str(files.index))] == ["g0", "g1", "g2", "g8", "g9"]


def test_parts_of_two_sizes_are_not_shown_as_one(files: PartFiles) -> None:
    files.write(1, "grids", [grid(4, ni=7)], inputs(4), [])
    with pytest.raises(InputError, match=r"part-00001.h5: holds 7x3 quad, and part-00000.h5 4x3 quad; "):
        files.build()
    assert len(h5py.File(files.index)["south"]) == 9  # the index is as it was


def test_a_part_that_cannot_be_finished_leaves_nothing(files: PartFiles) -> None:
    def broken() -> Iterator[Grid]:
        yield grid(10)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        files.write(3, "grids", broken(), inputs(10), [])
    assert sorted(path.name for path in files.folder.iterdir()) == [f"part-0000{k}.h5" for k in range(3)]


def _write_and_build(index: str, number: int) -> None:
    files = PartFiles(Path(index), "request")
    files.write(number, "grids", [grid(number)], inputs(number), [])
    files.build()


def test_the_index_of_jobs_that_end_at_once_shows_the_parts_of_all(tmp_path: Path) -> None:
    context = multiprocessing.get_context("fork" if os.name == "posix" else "spawn")
    index = str(tmp_path / "out.h5")
    jobs = [context.Process(target=_write_and_build, args=(index, number)) for number in range(4)]
    for job in jobs:
        job.start()
    for job in jobs:
        job.join()
    assert [each.name for each in read_grids(index)] == ["g0", "g1", "g2", "g3"]


def lying(path: Path, name: str, *, start: int = 0, rows: int = 4) -> str:
    """An index over one file of that name."""
    with h5py.File(path, "w") as file:
        file.attrs.update(format="meshonet-grid", version=1, topology="quad")
        for side, shape in (
            ("south", (4, 2)),
            ("north", (4, 2)),
            ("west", (3, 2)),
            ("east", (3, 2)),
            ("nodes", (4, 3, 2)),
        ):
            layout = h5py.VirtualLayout((start + rows, *shape), "f8")
            layout[start:] = h5py.VirtualSource(name, side, (rows, *shape), "f8")
            file.create_virtual_dataset(side, layout)
    return str(path)


@pytest.mark.parametrize(
    "name", ["/etc/passwd", "../out/part-00000.h5", "out/../../x.h5", "part.h5", "a/b/c.h5"]
)
def test_an_index_that_leads_elsewhere_is_refused(files: PartFiles, name: str) -> None:
    path = lying(files.index.with_name("bad.h5"), name)
    with pytest.raises(InputError, match="is not in a folder beside it"):
        next(read_grids(path))


def test_an_index_that_claims_what_is_not_there_is_refused(files: PartFiles) -> None:
    path = lying(files.index.with_name("bad.h5"), "out/part-00000.h5", start=2)
    with pytest.raises(InputError, match="rows that are not one after the other"):
        next(read_grids(path))
    path = lying(files.index.with_name("bad.h5"), "out/part-00000.h5", rows=10**12)
    with pytest.raises(InputError, match="holds 3 samples, where the index shows 1000000000000"):
        next(read_grids(path))


def test_an_index_that_shows_an_index_is_refused(files: PartFiles) -> None:
    lying(files.folder / "part.h5", "out/part.h5")
    path = lying(files.index.with_name("bad.h5"), "out/part.h5")
    with pytest.raises(InputError, match="lies in another file"):
        next(read_grids(path))


def test_an_index_in_a_pipe_is_told(files: PartFiles, monkeypatch: pytest.MonkeyPatch) -> None:
    from meshonet.formats.hdf5.read import read_grids as read
    from meshonet.formats.source import Source

    with pytest.raises(InputError, match="shows parts in other files"):
        next(read(Source("-", data=files.index.read_bytes())))


def test_any_damage_to_an_index_ends_in_an_input_error(files: PartFiles) -> None:
    whole = files.index.read_bytes()
    rng = np.random.default_rng(0)
    for _ in range(60):
        data = bytearray(whole)
        for at in rng.integers(0, len(data), 8):
            data[at] = rng.integers(0, 256)
        files.index.write_bytes(data)
        for read in (read_grids, read_shapes):
            names_and_errors(read(str(files.index)))  # type: ignore[arg-type]
