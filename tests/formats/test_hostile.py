"""Whatever bytes a reader meets, only InputError comes out, with a place or a remedy, and soon."""

from __future__ import annotations

import functools
import json
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from format_shapes import channel
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from formats.format import Format
from formats.registry import TABLE, format_named
from formats.source import Source
from geometry.errors import InputError
from geometry.grid import Grid

READABLE = [name for name in TABLE if format_named(name).read_grids or format_named(name).read_shapes]
SECONDS = 5.0  # of processor time: a busy machine is not a fault
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
"""A good file of each format that this package reads and does not write."""


@functools.cache
def good(name: str) -> bytes:
    """Return a good file of a format."""
    if name in TEXTS:
        return TEXTS[name].encode()
    writer = format_named(name).write_grids
    assert writer is not None, f"{name} needs a good file in TEXTS"
    with TemporaryDirectory() as folder:
        writer(Path(folder) / "g", [channel()])
        return (Path(folder) / "g").read_bytes()


def refuse(record: Format, data: bytes) -> None:
    """Read `data`; anything but shapes, grids or an InputError that says something is a failure."""
    source = Source("hostile", data=data)
    start = time.process_time()
    for read in (record.read_shapes, record.read_grids):
        if read is None:
            continue
        try:
            for item in read(source):
                assert item.name.isprintable()
                assert not isinstance(item, Grid) or np.isfinite(item.nodes).all()
        except InputError as error:
            refusal = error
        else:
            continue
        assert str(refusal).isprintable()
        assert 10 < len(str(refusal)) < 400
        assert refusal.remedy
    assert time.process_time() - start < SECONDS


def mutations(name: str) -> st.SearchStrategy[bytes]:
    """Return a good file of format `name` cut, with bytes changed, put in, taken out or repeated."""
    data = good(name)
    place = st.integers(0, len(data) - 1)
    bits = st.sampled_from(
        [b"\0", b"\xff", b"nan", b"-1", b"1e999", b"999999999", b"\x1b[2J", b"*", b",", b"\n", b'"']
    )

    def change(edits: list[tuple[int, int, bytes]]) -> bytes:
        changed = data
        for at, length, new in edits:
            changed = changed[:at] + new + changed[at + length :]
        return changed

    edit = st.tuples(place, st.integers(0, 12), st.one_of(bits, st.binary(max_size=8)))
    cut = place.map(lambda k: data[:k])
    doubled = place.map(lambda k: data[:k] + data[max(0, k - 99) :])
    return st.one_of(st.lists(edit, min_size=1, max_size=3).map(change), cut, doubled)


@pytest.mark.parametrize("name", READABLE)
def test_a_good_file_is_good(name: str) -> None:
    record = format_named(name)
    read = record.read_grids or record.read_shapes
    assert read is not None
    assert len(list(read(Source("good", data=good(name))))) == 1


@pytest.mark.parametrize("name", READABLE)
@settings(max_examples=60, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_a_damaged_file_is_refused_or_read(name: str, data: st.DataObject) -> None:
    refuse(format_named(name), data.draw(mutations(name)))


@pytest.mark.parametrize("name", READABLE)
@settings(max_examples=30, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(data=st.binary(max_size=300))
def test_arbitrary_bytes_are_refused(name: str, data: bytes) -> None:
    refuse(format_named(name), data)


LONG: dict[str, Callable[[], bytes]] = {
    "a line of 5 MB": lambda: b"1" * 5_000_000,
    "5 MB of words": lambda: b"1 " * 2_500_000,
    "5 MB of blank": lambda: b" " * 5_000_000,
    "5 MB of zeros": lambda: bytes(5_000_000),
    "5 MB of lines": lambda: b"\n" * 5_000_000,
    "5 MB of brackets": lambda: b"[" * 5_000_000,
    "5 MB of noise": lambda: np.random.default_rng(0).bytes(5_000_000),
    "a pickle": lambda: (
        b"\x80\x04\x95\x1d\x00\x00\x00\x00\x00\x00\x00\x8c\x05posix\x94\x8c\x06system\x94\x93\x94"
    ),
    "an HDF5 file": lambda: good("hdf5"),
    "a .vts file": lambda: good("vts"),
    "a NaN grid": lambda: good("plot3d-ascii").replace(b"e-0", b"nan"),
}


@pytest.mark.parametrize("what", LONG)
def test_large_and_foreign_files_are_refused_soon(what: str) -> None:
    data = LONG[what]()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for name in READABLE:
            refuse(format_named(name), data)
