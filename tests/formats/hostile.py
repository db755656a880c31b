"""Hostile files for every reader: good ones, what can be done to them, and what never was one."""

import functools
import json
import re
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

import numpy as np
from domains import step_layout
from format_shapes import VARIANTS, channel
from many_blocks import passage
from surface_grids import sphere, tube
from volume_grids import c_volume, shifted

from meshonet.formats.format import Format
from meshonet.formats.layout.write import as_text
from meshonet.formats.registry import TABLE, format_named
from meshonet.geometry.blocks.grid import Grid

READABLE = [
    name
    for name in (*TABLE, *VARIANTS)
    if (format_named(name).read_grids or format_named(name).read_shapes)
    and not format_named(name).beside
    and name not in ("step", "brep")  # Open Cascade reads these, in a process of its own: test_cad.py
]
"""What reads a stream of bytes; each has a process of its own in ``make fuzz``."""
BLOCKS = " of blocks"
"""Behind the name of a format: files of it that hold a grid of several blocks."""
READABLE += [name + BLOCKS for name in ("hdf5", "cgns", "plot3d", "plot3d:binary")]
VOLUMES, SURFACE = " of volumes", " of a surface"
"""Behind the name of a format: files of it that hold grids in space."""
_WRITTEN = [(name, format_named(name)) for name in READABLE if " " not in name]
_SPACIOUS = [(name, each.space) for name, each in _WRITTEN if each.read_grids and each.write_grids]
READABLE += [name + VOLUMES for name, space in _SPACIOUS if "volumes" in space]
READABLE += [name + SURFACE for name, space in _SPACIOUS if "surfaces" in space]
SECTION = "A SECTION\n" + "".join(
    f"{0.5 + 0.5 * np.cos(a):.6f} {0.06 * np.sin(a):.6f}\n" for a in np.linspace(0, 2 * np.pi, 41)
)
SQUARE = [[0, 0], [2, 0], [2, 1], [0, 1], [0, 0]]
TEXTS = {
    "airfoil": SECTION,
    "points": SECTION.split("\n", 1)[1],
    "wkt": "POLYGON ((0 0, 2 0, 2 1, 0 1, 0 0))",
    "geojson": json.dumps({"type": "Feature", "geometry": {"type": "Polygon", "coordinates": [SQUARE]}}),
}
"""A good file of each format that this package reads and does not write as grids."""
TEXTS["svg"] = (
    '<svg xmlns="http://www.w3.org/2000/svg"><g transform="scale(2)"><rect width="8" height="4"/>'
    '<path d="M3 2A1 1 0 0 0 5 2C5 1 3 1 3 2z"/></g></svg>'
)
TEXTS["layout"] = as_text(step_layout())
TEXTS["dxf"] = "\n".join(
    ["0", "SECTION", "2", "ENTITIES"]
    + [f"0\nLINE\n8\nside\n10\n{a[0]}\n20\n{a[1]}\n11\n{b[0]}\n21\n{b[1]}" for a, b in pairwise(SQUARE)]
    + ["0", "ENDSEC", "0", "EOF", ""]
)

BITS = [
    b"\0", b"\xff", b"nan", b"inf", b"-1", b"0", b"1e999", b"-1e308", b"999999999", b"2147483647",
    b"-2147483648", b"18446744073709551615", b"\x1b[2J\x1b]0;owned\x07", b"*", b"9*", b",", b"\n", b'"', b"(",
    b"<", b"../../etc/passwd",
]  # fmt: skip
_NUMBER = re.compile(rb"-?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?")
_WRONG_NUMBERS = (b"nan", b"-inf", b"1e999", b"-1", b"0", b"1000000000", b"4294967296", b"x")


@functools.cache
def good(name: str) -> bytes:
    """Return a good file of a format."""
    if name in TEXTS:
        return TEXTS[name].encode()
    writer = record_of(name).write_grids
    assert writer is not None, f"{name} needs a good file in TEXTS"
    with TemporaryDirectory() as folder:
        writer(Path(folder) / "g", [_grid(name)])
        return (Path(folder) / "g").read_bytes()


def record_of(name: str) -> Format:
    """Return the format of one of `READABLE`."""
    return format_named(name.partition(" ")[0])


def _grid(name: str) -> Grid:
    """Return the grid of a good file: of several blocks where the format holds them."""
    if name.endswith(BLOCKS):
        return passage()
    several = bool(record_of(name).blocks)
    if name.endswith(VOLUMES):
        return shifted() if several else c_volume()
    if name.endswith(SURFACE):
        return sphere() if several else tube()
    return channel()


def corpus(name: str) -> Iterator[tuple[str, bytes]]:
    """Yield (what it is, bytes) of hostile files for one reader: always the same ones."""
    data = good(name)
    for k in range(1, 10):
        yield f"cut at {k}0 per cent", data[: len(data) * k // 10]
    yield "cut by one byte", data[:-1]
    yield "one byte too long", data + b"\0"
    yield "twice", data + data
    yield "backwards", data[::-1]
    yield "every bit turned", bytes(255 - b for b in data)
    words = np.frombuffer(data[: len(data) // 4 * 4], "<u4")
    yield "wrong endianness", words.byteswap().tobytes()
    yield "not UTF-8", b"\xff\xfe\xfd" + data.replace(b" ", b"\xe9 ")
    yield "in UTF-16", data.decode("latin-1").encode("utf-16")
    numbers = list(_NUMBER.finditer(data))
    places = sorted({0, 1, 2, 3, len(numbers) // 2, len(numbers) - 1} & set(range(len(numbers))))
    for place in places:
        at = numbers[place]
        for wrong in _WRONG_NUMBERS:
            yield f"number {place} is {wrong.decode()}", data[: at.start()] + wrong + data[at.end() :]
    yield "every number NaN", _NUMBER.sub(b"nan", data)
    yield "every number the same", _NUMBER.sub(b"1", data)
    yield "every number zero", _NUMBER.sub(b"0", data)
    integers = np.frombuffer(data[: len(data) // 4 * 4], "<i4")
    for k in range(0, min(len(integers), 24), 4):
        for wrong_size in (-1, 10**9, 2**31 - 1):
            changed = integers.copy()
            changed[k] = wrong_size
            yield f"integer {k} is {wrong_size}", changed.tobytes()


def foreign() -> Iterator[tuple[str, bytes]]:
    """Yield (what it is, bytes) of files that are none of a reader's own: always the same ones."""
    yield "nothing", b""
    yield "a pickle", b"\x80\x04\x95\x1d\0\0\0\0\0\0\0\x8c\x05posix\x94\x8c\x06system\x94\x93\x94"
    yield "a zip archive", b"PK\x03\x04" + bytes(26) + b"a.dat"
    yield "a picture", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR" + bytes(50)
    yield "HTML", b"<!DOCTYPE html><html><body><script>alert(1)</script></body></html>"
    yield (
        "XML that multiplies",
        (
            b'<?xml version="1.0"?><!DOCTYPE a [<!ENTITY b "bbbbbb"><!ENTITY c "&b;&b;&b;&b;&b;&b;&b;&b;">'
            b'<!ENTITY d "&c;&c;&c;&c;&c;&c;&c;&c;">]><VTKFile type="StructuredGrid">&d;</VTKFile>'
        ),
    )
    yield "escapes", b"\x1b[2J\x1b]0;owned\x07\x1b[31m\n" * 20
    yield "path tricks", b"../../../../etc/passwd\n" * 20
    yield "the head of HDF5", b"\x89HDF\r\n\x1a\n" + bytes(200)
    yield "an ADF container", b"@(#)ADF Database Version B02012>" + bytes(400)
    yield "noise", np.random.default_rng(0).bytes(20_000)
    for message, points in _outlines().items():
        rows = "".join(f"{x} {y}\n" for x, y in points)
        yield message, rows.encode()
        ring = ", ".join(f"{x} {y}" for x, y in [*points, points[0]])
        yield f"{message}, as WKT", f"POLYGON (({ring}))".encode()
        closed = [[list(point) for point in [*points, points[0]]]]
        feature = {
            "type": "Feature",
            "properties": {"name": "\x1b[31m/../x"},
            "geometry": {"type": "Polygon"},
        }
        feature["geometry"]["coordinates"] = closed  # type: ignore[index]
        yield f"{message}, as GeoJSON", json.dumps(feature).encode()
    for dims in (
        "1000000000 1000000000",
        "3 3 -3",
        "1\n3 3 2147483647",
        "100000\n33 33 33",
        "1\n-3 4",
        "2147483647 2",
        "0 0",
        "1000000\n" + "2 2 2 " * 9,
        "2 2 1",
    ):
        yield f"dims {dims.split()[0]}...", f"{dims}\n0 1 2 3\n".encode()
    for name in READABLE:
        yield f"a good {name} file", good(name)


def _outlines() -> dict[str, list[tuple[float, float]]]:
    nan, inf = float("nan"), float("inf")
    return {
        "repeated points": [(0, 0)] * 12,
        "zero area": [(0, 0), (1, 1), (2, 2), (3, 3), (2, 2), (1, 1)],
        "self-crossing": [(0, 0), (2, 2), (2, 0), (0, 2)],
        "reversed": [(0, 1), (2, 1), (2, 0), (0, 0)],
        "four coincident corners": [(1, 1), (1, 1), (1, 1), (1, 1)],
        "not a number": [(0, 0), (nan, 0), (1, 1), (0, 1)],
        "infinite": [(0, 0), (inf, 0), (1, 1), (0, 1)],
        "huge": [(0, 0), (1e308, 0), (1e308, 1e308), (0, 1e308)],
        "tiny": [(0, 0), (1e-320, 0), (1e-320, 1e-320), (0, 1e-320)],
        "one point": [(0, 0)],
        "two points": [(0, 0), (1, 0)],
    }


def mutate(data: bytes, random: Random) -> bytes:
    """Return `data` with a few random things done to it."""
    changed = bytearray(data)
    for _ in range(random.choice((1, 1, 1, 2, 3, 8))):
        if not changed:
            break
        random.choice(_MUTATIONS)(changed, random)
    return bytes(changed)


def _place(data: bytearray, random: Random) -> int:
    """Return an index; every other one in the head, where files say how they go on."""
    return random.randrange(min(len(data), random.choice((len(data), 400))))


def _flip(data: bytearray, random: Random) -> None:
    data[_place(data, random)] ^= 1 << random.randrange(8)


def _put(data: bytearray, random: Random) -> None:
    at = _place(data, random)
    data[at : at + random.choice((0, 1, 4, 8))] = random.choice(BITS)


def _renumber(data: bytearray, random: Random) -> None:
    result = _NUMBER.search(data, _place(data, random))
    if result:
        data[result.start() : result.end()] = random.choice((*_WRONG_NUMBERS, b"%d" % random.randrange(99)))


def _resize(data: bytearray, random: Random) -> None:
    at = 4 * (_place(data, random) // 4)
    value = random.choice((-1, 0, 1, 2, 255, 10**9, 2**31 - 1, random.randrange(2**31)))
    data[at : at + 4] = value.to_bytes(4, random.choice(("little", "big")), signed=True)


def _cut(data: bytearray, random: Random) -> None:
    del data[_place(data, random) :]


def _drop(data: bytearray, random: Random) -> None:
    at = _place(data, random)
    del data[at : at + random.randrange(1, 200)]


def _repeat(data: bytearray, random: Random) -> None:
    at = _place(data, random)
    data[at:at] = data[at : at + random.randrange(1, 200)] * random.choice((1, 2, 50))


def _noise(data: bytearray, random: Random) -> None:
    at = _place(data, random)
    data[at : at + 16] = random.randbytes(16)


_MUTATIONS: tuple[Callable[[bytearray, Random], None], ...] = (
    _flip, _flip, _put, _put, _renumber, _renumber, _resize, _cut, _drop, _repeat, _noise,
)  # fmt: skip
