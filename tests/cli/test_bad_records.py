"""Records that cannot be read fail alone, and so do members when memory runs out for many at once."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from command_line import Meshonet, dataset, duct

from meshonet.formats.registry import read_grids, read_shapes
from meshonet.geometry.errors import InputError

NAMES = ("a", "b", "c", "d", "e")


def five(path: Path, bad: int) -> Path:
    """Five channels, the corners of one of which are not shared."""
    dataset(path, "quad", *[duct(bump=0.05 * k) for k in range(5)], names=NAMES)
    with h5py.File(path, "a") as file:
        file["south"][bad, 0] = [-7.0, 3.0]
    return path


@pytest.mark.parametrize("bad", [0, 2, 4])
@pytest.mark.parametrize("jobs", [1, 2])
def test_a_bad_record_fails_alone(meshonet: Meshonet, tmp_path: Path, bad: int, jobs: int) -> None:
    source = five(tmp_path / "five.h5", bad)
    done = meshonet("tfi", source, "-o", "{name}.vts", "--jobs", jobs)
    assert done.code == 2
    assert "4 done, 1 failed" in done.err
    assert f"five.h5: sample {bad}: " in done.err
    assert {path.stem for path in Path().glob("*.vts")} == set(NAMES) - {NAMES[bad]}


@pytest.mark.parametrize("words", [("convert",), ("quality",), ("plot", "-o", "{name}.png")])
def test_a_bad_grid_fails_alone(meshonet: Meshonet, tmp_path: Path, words: tuple[str, ...]) -> None:
    meshonet("tfi", five(tmp_path / "five.h5", 4), "-o", "grids.h5", "-q")
    with h5py.File("grids.h5", "a") as file:
        file["nodes"][1, 3, 3] = np.nan
    output = ["-o", "{name}.vts"] if words == ("convert",) else []
    done = meshonet(words[0], "grids.h5", *words[1:], *output, "--json")
    assert done.code == 2
    assert [one.get("name") for one in done.objects if "name" in one] == ["a", "c", "d"]
    assert "grids.h5: sample 1: node i=3, j=3 has x = nan" in done.err


def test_an_iterator_goes_on_behind_a_bad_record(tmp_path: Path) -> None:
    shapes = read_shapes(str(five(tmp_path / "five.h5", 1)))
    assert next(shapes).name == "a"
    with pytest.raises(InputError, match="sample 1"):
        next(shapes)
    assert [shape.name for shape in shapes] == ["c", "d", "e"]


def test_memory_that_ends_while_many_are_solved_ends_nothing(
    meshonet: Meshonet, tmp_path: Path, quad_model: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    from meshonet.solvers.neural.quad import operator

    solve = operator.polished

    def limited(boundaries, *more):  # type: ignore[no-untyped-def]
        if len(boundaries) > 1:
            raise MemoryError
        return solve(boundaries, *more)

    monkeypatch.setattr(operator, "polished", limited)
    dataset(tmp_path / "three.h5", "quad", *[duct(bump=0.1 * k) for k in range(3)])
    done = meshonet("infer", "three.h5", "--model", quad_model, "-o", "g.h5")
    assert (done.code, len(list(read_grids("g.h5")))) == (0, 3)
