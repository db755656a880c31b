import struct
from pathlib import Path

import numpy as np
import pytest
from format_shapes import channel, memory

from meshonet.formats.plot3d import sniff
from meshonet.formats.plot3d.read import read_grids
from meshonet.formats.registry import format_named
from meshonet.geometry.errors import InputError

GRID = channel(9, 6)
X, Y = GRID.x.ravel(order="F"), GRID.y.ravel(order="F")


def text(dims: str = "1\n9 6", values: str = "") -> bytes:
    return f"{dims}\n{values or ' '.join(map(repr, [*X.tolist(), *Y.tolist()]))}\n".encode()


def binary(*dims: int, order: str = "<", size: int = 8) -> bytes:
    return (
        struct.pack(f"{order}{len(dims)}i", *dims)
        + np.concatenate([X, Y]).astype(f"{order}f{size}").tobytes()
    )


CURVED = [np.arange(3.0) ** (1 + k / 9) for k in range(3)]
SOLID = np.stack(np.meshgrid(*CURVED)).swapaxes(1, 2).ravel()
CASES = {
    "cut text": (
        text()[:-40],
        r"has 10\d numbers and no Plot3D layout fits \(nearest: dims 9x6, 111 numbers\); the file",
    ),
    "cut binary": (
        binary(1, 9, 6)[:-1],
        r"has 875 bytes and no binary Plot3D layout fits \(nearest: dims 9x6, float64, little endian, 876",
    ),
    "garbage": (
        bytes(range(256)) * 9,
        "has 2304 bytes and no binary Plot3D layout fits; the file is cut short",
    ),
    "zeros": (bytes(4000), "has 4000 bytes and no binary Plot3D layout fits"),
    "word": (text(values="1 2 3\n4 five 6"), "line 4: 'five' is not a number; write numbers only"),
    "escape": (text(values="1 \x1b[2J"), r"line 3: '\\x1b\[2J' is not a number"),
    "bytes": (text(values="1 2\n4 ") + bytes(range(128, 200)), "line 5: holds binary data beside text"),
    "repeat of nothing": (text(values="3*"), r"line 3: '3\*' is not a number"),
    "repeat by a word": (text(values="x*3"), r"line 3: 'x\*3' is not a number"),
    "bomb": (text(values="999999999*0"), "repeats a number too often for its size; write the values out"),
    "bigger bomb": (text(values="9999999999999*0"), r"'9999999999999\*0' is not a number"),
    "several bombs": (text(values="999999999999*0 " * 9), "repeats a number too often for its size"),
    "negative": (text("1\n-9 6"), "does not start with the dims of a Plot3D grid; start it with"),
    "fraction": (text("1.5 2.5"), "does not start with the dims of a Plot3D grid"),
    "huge": (text("1000000000 1000000000 1"), r"dims .*1000000000.*; the file is cut short"),
    "huge binary": (binary(1, 10**9, 10**9), "no binary Plot3D layout fits"),
    "negative binary": (binary(1, -9, -6), "no binary Plot3D layout fits"),
    "many blocks": (text("99999 2 2"), "no Plot3D layout fits"),
    "nan": (text(values="nan " * 108), "node i=0, j=0 has x = nan; check the file"),
    "inf": (text(values="1e999 " * 108), "node i=0, j=0 has x = inf"),
    "too large": (text(values="1e200 -1e200 " * 54), r"has x = 1e\+200; check the file"),
    "line": (text("54 1", ""), "a grid of 54x1x1 nodes has no cells"),
    "empty text": (b"\n\n  \n", "does not start with the dims"),
    "one number": (b"7\n", "does not start with the dims"),
    "airfoil": (
        b"NACA 0012\n1.0 0.0\n0.5 0.1\n",
        "line 1: 'NACA' is not a number; .* name another format with from_format",
    ),
    "pickle": (b"\x80\x04\x95" + bytes(99), "no binary Plot3D layout fits"),
    "Fortran cut": (
        struct.pack("<i2ii", 8, 9, 6, 8) + struct.pack("<i", 864) + bytes(800),
        "Fortran record 2, at byte 16, says 864 bytes and 796 are left; the file is cut short",
    ),
    "Fortran end": (
        struct.pack("<i3ii", 12, 3, 3, 3, 12)
        + struct.pack("<i", 648)
        + SOLID.tobytes()
        + struct.pack("<i", 640),
        "Fortran record 2, at byte 20, says 648 bytes and does not end so",
    ),
    "solid cut": (
        struct.pack("<3i", 3, 3, 3) + SOLID.tobytes()[:-9],
        "no binary Plot3D layout fits .nearest: dims 3x3x3, float64, little endian, 660 bytes.",
    ),
    "solid nan": (
        struct.pack("<3i", 3, 3, 3) + np.where(np.arange(81) == 40, np.nan, SOLID).tobytes(),
        "block 1, read as C binary, little endian, float64: node i=1, j=1, k=1 has y = nan; check the file",
    ),
    "solid negative": (text("3 3 -3", " ".join(map(str, SOLID))), "no Plot3D layout fits"),
    "solid huge": (struct.pack("<3i", 2**31 - 1, 3, 3) + SOLID.tobytes(), "no binary Plot3D layout fits"),
}


@pytest.mark.parametrize("case", CASES)
def test_a_file_that_is_no_plane_grid_is_refused(case: str) -> None:
    data, message = CASES[case]
    with pytest.raises(InputError, match=message):
        list(read_grids(memory(data)))


def test_an_airfoil_is_not_taken_for_a_grid() -> None:
    for start in ("NACA 2412\n", "", "61. 61.\n\n", "5 5\n"):
        rows = "".join(f"{1 - k / 30:.5f} {k * 0.01:.5f}\n" for k in range(61))
        assert not sniff((start + rows).encode())
    assert sniff(text())


def test_two_readings_of_the_same_length_are_told_apart_by_their_cells() -> None:
    # a counted plane grid with iblank has as many numbers as an uncounted three-dimensional one with ni = 1
    flags = [1] * 20 + [0] * 14 + [-1] * 20
    data = text(values=" ".join(map(repr, [*X.tolist(), *Y.tolist(), *flags])))
    (grid,) = read_grids(memory(data))
    assert np.array_equal(grid.nodes, GRID.nodes)
    span = [0.0] * 54
    data = text("1 9 6", values=" ".join(map(repr, [*span, *X.tolist(), *Y.tolist()])))
    (grid,) = read_grids(memory(data))
    assert np.array_equal(grid.nodes, GRID.nodes)


def test_a_block_too_large_for_a_fortran_record_is_refused(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("meshonet.formats.plot3d.write.StoredBlock.nodes", 1 << 27)
    writer = format_named("plot3d:fortran").write_grids
    assert writer is not None
    with pytest.raises(
        InputError,
        match="block 1 of 9x6 nodes takes 2147483648 bytes and a Fortran record less than 2 GiB; write the",
    ):
        writer(tmp_path / "g", [GRID])
