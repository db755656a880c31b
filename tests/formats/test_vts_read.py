import base64
import zlib

import numpy as np
import pytest
from format_shapes import channel, memory

from meshonet.formats.vtk.vts import write
from meshonet.formats.vtk.vts_read import read_grids
from meshonet.geometry.errors import InputError

NODES = channel(5, 2).nodes[:3]
POINTS = np.zeros((2, 3, 3))
POINTS[..., :2] = NODES.swapaxes(0, 1)
ZLIB = 'compressor="vtkZLibDataCompressor"'


def form(encoding: str, more: str = "", kind: str = "Float64", components: int = 3) -> str:
    """Return a DataArray's attributes."""
    return f'type="{kind}" NumberOfComponents="{components}" format="{encoding}" {more}'


def vts(
    points: str = "",
    *,
    array: str = "",
    extent: str = "0 2 0 1 0 0",
    file: str = "",
    head: str = "",
    tail: str = "",
) -> bytes:
    """Return a .vts file written by hand."""
    text = points or " ".join(map(repr, POINTS.ravel().tolist()))
    return (
        f'{head}<VTKFile type="StructuredGrid" {file}><StructuredGrid WholeExtent="{extent}">'
        f'<Piece Extent="{extent}"><Points><DataArray {array or form("ascii")}>{text}</DataArray></Points>'
        f"</Piece></StructuredGrid>{tail}</VTKFile>"
    ).encode()


def inline(data: bytes, file: str = "") -> bytes:
    """Return a .vts file with `data` as inline base64."""
    return vts(base64.b64encode(data).decode(), array=form("binary"), file=file)


def packed(count: int, block: int, last: int, *data: bytes) -> bytes:
    """Return a .vts file whose points are compressed blocks under the given length words."""
    words = np.array([count, block, last, *map(len, data)], np.uint32).tobytes()
    text = base64.b64encode(words) + base64.b64encode(b"".join(data))
    return vts(text.decode(), array=form("binary"), file=ZLIB)


def test_a_file_written_by_hand_is_read() -> None:
    (grid,) = read_grids(memory(vts()))
    assert np.array_equal(grid.nodes, NODES)


def test_an_extent_need_not_start_at_zero() -> None:
    (grid,) = read_grids(memory(vts(extent="5 7 -1 0 3 3")))
    assert np.array_equal(grid.nodes, NODES)


def test_length_words_are_32_bits_when_nothing_is_said() -> None:
    raw = np.uint32(POINTS.nbytes).tobytes() + POINTS.tobytes()
    data = vts(" ", array=form("appended", 'offset="0"'), tail="@@")
    whole = data.replace(b"@@", b'<AppendedData encoding="raw">\n _' + raw + b"</AppendedData>")
    (grid,) = read_grids(memory(whole))
    assert np.array_equal(grid.nodes, NODES)


def test_base64_length_words_may_be_apart_or_together() -> None:
    word, body = np.uint32(POINTS.nbytes).tobytes(), POINTS.tobytes()
    for text in (base64.b64encode(word) + base64.b64encode(body), base64.b64encode(word + body)):
        (grid,) = read_grids(memory(vts(f"\n  {text.decode()}\n", array=form("binary"))))
        assert np.array_equal(grid.nodes, NODES)


def test_compressed_blocks_with_and_without_a_short_last_one() -> None:
    raw = POINTS.tobytes()
    for block in (144, 100, 72, 48):
        pieces = [zlib.compress(raw[k : k + block]) for k in range(0, 144, block)]
        (grid,) = read_grids(memory(packed(len(pieces), block, 144 % block, *pieces)))
        assert np.array_equal(grid.nodes, NODES)


def pieces() -> str:
    """Return the grid as a file of two pieces that share their middle column."""
    message = ""
    for i in range(2):
        part = " ".join(map(repr, POINTS[:, i : i + 2].ravel().tolist()))
        array = f"<DataArray {form('ascii')}>{part}</DataArray>"
        message += f'<Piece Extent="{i} {i + 1} 0 1 0 0"><Points>{array}</Points></Piece>'
    text = vts().decode()
    return text[: text.index("<Piece")] + message + text[text.index("</StructuredGrid>") :]


def test_several_pieces_are_put_together() -> None:
    (grid,) = read_grids(memory(pieces().encode()))
    assert np.array_equal(grid.nodes, NODES)


@pytest.mark.parametrize(
    ("extent", "message"),
    [
        ("0 8 0 1 0 0", "its pieces do not cover WholeExtent"),
        ("0 1 0 1 0 0", "a piece lies outside WholeExtent"),
    ],
)
def test_pieces_that_do_not_make_the_whole_are_refused(extent: str, message: str) -> None:
    data = pieces().replace('WholeExtent="0 2 0 1 0 0"', f'WholeExtent="{extent}"')
    with pytest.raises(InputError, match=message):
        list(read_grids(memory(data.encode())))


APPENDED = form("appended", 'offset="0"')
CASES = {
    "no XML": (b"<VTKFile", r"is not well-formed XML .*; write the file again"),
    "other": (
        vts().replace(b'type="StructuredGrid"', b'type="PolyData"'),
        "VTK file of type PolyData; give one",
    ),
    "entity": (vts(head='<!DOCTYPE a [<!ENTITY b "c">]>'), "has a document type or zero bytes; write"),
    "UTF-16": (vts().decode().encode("utf-16"), "has a document type or zero bytes"),
    "encoding": (b'<?xml version="1.0" encoding="no-such"?>' + vts(), "is not well-formed XML"),
    "no piece": (vts().replace(b"Piece", b"Peace"), "has no element Piece"),
    "no points": (vts().replace(b"Points", b"Dots"), "element Piece has no Points"),
    "cut": (vts()[:-30], "is not well-formed XML"),
    "short": (vts("1 2 3"), "Points: should have 18 numbers and has fewer; the file is cut short"),
    "long": (vts("1 " * 19), "Points: should have 18 numbers and has 19"),
    "word": (vts("a " * 18), "Points: could not convert string to float"),
    "nan": (vts("nan " * 18), "has x = nan; check the file"),
    "extent": (vts(extent="0 2 0 1"), "WholeExtent '0 2 0 1' is not six integers"),
    "reversed": (vts(extent="2 0 0 1 0 0"), "WholeExtent '2 0 0 1 0 0' is empty or absurdly large"),
    "absurd": (vts(extent="0 999999999 0 999999999 0 0"), "is empty or absurdly large"),
    "huge": (vts(extent="0 99999 0 99999 0 0"), "should have 30000000000 numbers and has fewer"),
    "line": (vts("1 2 3 4 5 6", extent="0 1 0 0 0 0"), "a grid of 2x1x1 nodes has no cells"),
    "components": (vts(array=form("ascii", components=2)), "do not have three components; write x, y, z"),
    "type": (vts(array=form("ascii", kind="Bit")), "number type 'Bit' is not known; write Float64"),
    "form": (vts(array=form("odd")), "format 'odd' at offset 0 cannot be read"),
    "offset": (vts(array=form("appended", 'offset="-1"')), "offset '-1' is not a number"),
    "nothing appended": (vts(array=APPENDED), "format 'appended' at offset 0 cannot be read"),
    "no mark": (vts(tail="<AppendedData>"), "its appended data has no start mark '_'; the file is cut"),
    "no end": (vts(tail="<AppendedData>_"), "its appended data has no end; the file is cut short"),
    "header": (vts(file='header_type="UInt16"'), "header_type 'UInt16' is not known; write UInt32 or UInt64"),
    "base64": (vts("%%%%", array=form("binary")), "its base64 data is damaged"),
    "words": (inline(b"\0\0"), "its length words are missing"),
    "size": (inline(bytes(148)), "should be 144 bytes, is said to be 0, and 144 are left"),
    "blocks": (packed(9, 1, 1), "should be 144 bytes and its blocks say 9"),
    "count": (packed(2**31, 0, 144), "should be 144 bytes and its blocks say 144"),
    "damaged": (packed(1, 144, 0, b"xxxx"), "block 0 cannot be decompressed"),
    "bomb": (
        packed(1, 10**9, 0, zlib.compress(bytes(10**7))),
        "should be 144 bytes and its blocks say 1000000000",
    ),
    "less": (packed(1, 144, 0, zlib.compress(b"x")), "block 0 has 1 bytes instead of 144"),
    "compressor": (
        inline(b"xxxx", 'compressor="odd"'),
        "compressor 'odd' cannot be read; write it with zlib",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_a_damaged_or_hostile_file_is_refused(case: str) -> None:
    data, message = CASES[case]
    with pytest.raises(InputError, match=message):
        list(read_grids(memory(data)))


def test_a_part_that_cannot_be_understood_is_named(tmp_path) -> None:  # type: ignore[no-untyped-def]
    write(tmp_path / "g.vts", channel())
    data = (tmp_path / "g.vts").read_bytes()
    codes = " ".join(map(str, b"west 0 4 inlet")).encode()
    assert codes in data
    with pytest.raises(InputError, match=r"part 'west' is not 'side start stop name'; remove the field"):
        list(read_grids(memory(data.replace(codes, b"119 101 115 116"))))
