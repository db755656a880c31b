import itertools
from pathlib import Path

import numpy as np
import pytest
from format_shapes import channel, memory, ring
from test_plot3d import File, flat, solid

from meshonet.formats.format import Format
from meshonet.formats.plot3d import CHOICES
from meshonet.formats.registry import format_named
from meshonet.geometry.blocks.extrude import extruded
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError

RING, CHANNEL = ring(13, 7), channel(9, 6)


def written(words: str, grids: list[Grid], folder: Path, heights: tuple[float, ...] = ()) -> bytes:
    """Return the file that ``--to plot3d:words`` writes."""
    record = format_named(f"plot3d:{words}")
    assert record.write_grids is not None
    record.write_grids(folder / "g", [extruded(grid, heights) if heights else grid for grid in grids])
    return (folder / "g").read_bytes()


def read(words: str, data: bytes) -> list[Grid]:
    record: Format = format_named(f"plot3d:{words}" if words else "plot3d")
    assert record.read_grids is not None
    return list(record.read_grids(memory(data, "g")))


@pytest.mark.parametrize(
    "words", [",".join(row) for row in itertools.product(*(CHOICES[k] for k in (0, 1, 2, 3)))]
)
def test_every_variant_comes_back_with_and_without_being_told(words: str, tmp_path: Path) -> None:
    kinds = ("float64", "float64,big") if not words.startswith("ascii") else ("float64",)
    for kind in kinds:
        data = written(f"{words},{kind}", [CHANNEL], tmp_path)
        message = words if words.startswith("ascii") else f"{words},{kind}"
        for way in ("", message):
            (back,) = read(way, data)
            assert np.array_equal(back.nodes, CHANNEL.nodes)


@pytest.mark.parametrize("order", ["little", "big"])
@pytest.mark.parametrize("kind", ["binary", "fortran"])
def test_a_variant_is_written_as_the_page_of_the_format_has_it(kind: str, order: str, tmp_path: Path) -> None:
    sign = {"little": "<", "big": ">"}[order]
    for words, file in (
        ("2d,multi,no-iblank", File(flat(RING), flat(CHANNEL))),
        ("3d,multi,no-iblank", File(solid(RING), solid(CHANNEL))),
        ("2d,single", File(flat(CHANNEL), counted=False)),
    ):
        grids = [RING, CHANNEL] if "multi" in words else [CHANNEL]
        for size in (8, 4):
            data = written(f"{kind},{order},float{8 * size},{words}", grids, tmp_path)
            assert data == file.binary(sign, size, records=kind == "fortran")


def test_iblank_is_written_as_ones(tmp_path: Path) -> None:
    data = written("binary,iblank,2d", [CHANNEL], tmp_path)
    assert np.array_equal(np.frombuffer(data[-4 * 54 :], "<i4"), np.ones(54))
    assert written("iblank", [CHANNEL], tmp_path).split()[-54:] == [b"1"] * 54


@pytest.mark.parametrize(("span", "axis"), [("span-i", 0), ("span-j", 1), ("span-k", 2)])
def test_planes_are_written_along_any_index(span: str, axis: int, tmp_path: Path) -> None:
    data = written(f"binary,{span}", [CHANNEL], tmp_path, (0.0, 0.5))
    assert data == File(solid(CHANNEL, 2, axis)).binary()
    (back,) = read("", data)
    assert np.array_equal(np.sort(back.nodes, axis=None), np.sort(CHANNEL.nodes, axis=None))


def test_iblank_that_is_read_is_told_of() -> None:
    (back,) = read("", File(flat(CHANNEL), iblank=True).binary())
    assert back.provenance == {"iblank": {"-1": 18, "0": 18, "1": 18}}
    (plain,) = read("", File(flat(CHANNEL)).binary())
    assert plain.provenance == {}


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("huge", "'huge' is no option of plot3d files; use ascii binary fortran multi"),
        ("big,little", "little and big exclude each other; give one"),
    ],
)
def test_words_that_make_no_sense_are_refused(words: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        format_named(f"plot3d:{words}")


def test_a_file_that_is_not_as_told_is_refused_with_what_fits() -> None:
    data = File(flat(CHANNEL)).binary(">")
    with pytest.raises(
        InputError, match="is not little: it fits 2d big binary float64 multi no-iblank whole"
    ):
        read("little", data)


def test_several_grids_need_a_count(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="2 grids do not fit in a file without a count; leave out"):
        written("single", [RING, CHANNEL], tmp_path)


def test_planes_are_not_written(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="planes are read and not written"):
        written("planes", [CHANNEL], tmp_path)


def test_other_formats_have_no_variants() -> None:
    with pytest.raises(InputError, match="big: vts files have no options; leave them out"):
        format_named("vts:big")
