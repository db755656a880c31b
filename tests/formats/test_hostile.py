"""Whatever bytes a reader meets, only InputError comes out, with a place or a remedy, and soon."""

import functools
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hostile import BITS, READABLE, corpus, foreign, good, record_of
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from many_blocks import passage
from surface_grids import sphere
from volume_grids import shifted

from meshonet.formats.format import Format
from meshonet.formats.plot3d.read import read_grids as read_plot3d
from meshonet.formats.plot3d.write import write_grids as write_plot3d
from meshonet.formats.source import Source
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError

SECONDS = 2.0  # of processor time: a busy machine is not a fault


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
                blocks = item.blocks if isinstance(item, Grid) else ()
                assert all(np.isfinite(block.nodes).all() for block in blocks)
        except InputError as error:
            refusal = error
        else:
            continue
        assert str(refusal).isprintable()
        assert 10 < len(str(refusal)) < 400
        assert refusal.remedy
    assert time.process_time() - start < SECONDS


@functools.cache
def mutations(name: str) -> st.SearchStrategy[bytes]:
    """Return a good file of format `name` cut, with bytes changed, put in, taken out or repeated."""
    return mutated(good(name))


@functools.cache
def mutated(data: bytes) -> st.SearchStrategy[bytes]:
    """Return `data` cut, with bytes changed, put in, taken out or repeated."""
    place = st.integers(0, len(data) - 1)
    bits = st.sampled_from(BITS)

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
    record = record_of(name)
    read = record.read_grids or record.read_shapes
    assert read is not None
    assert len(list(read(Source("good", data=good(name))))) == 1


@pytest.mark.parametrize("name", READABLE)
@settings(max_examples=60, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_a_damaged_file_is_refused_or_read(name: str, data: st.DataObject) -> None:
    refuse(record_of(name), data.draw(mutations(name)))


@pytest.fixture(scope="module")
def mapped(tmp_path_factory: pytest.TempPathFactory) -> dict[Path, bytes]:
    """Folders of grids with maps beside them, and the bytes of each good map."""
    maps = {}
    for make in (passage, shifted, sphere):
        folder = tmp_path_factory.mktemp("map")
        write_plot3d(folder / "g.p3d", [make()])
        maps[folder] = (folder / "g.nmf").read_bytes()
    return maps


@settings(max_examples=150, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_a_damaged_map_is_refused_or_read(data: st.DataObject, mapped: dict[Path, bytes]) -> None:
    folder, good_map = data.draw(st.sampled_from(list(mapped.items())))
    (folder / "g.nmf").write_bytes(data.draw(mutated(good_map)))
    refused = None
    try:
        for grid in read_plot3d(Source("g", path=folder / "g.p3d")):
            assert all(patch.name.isprintable() for patch in grid.patches)
    except InputError as error:
        refused = error
    assert refused is None or (refused.remedy and str(refused).isprintable())


@pytest.mark.parametrize("name", READABLE)
@settings(max_examples=30, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(data=st.binary(max_size=300))
def test_arbitrary_bytes_are_refused(name: str, data: bytes) -> None:
    refuse(record_of(name), data)


@pytest.mark.parametrize("name", READABLE)
def test_the_corpus_is_refused_or_read(name: str) -> None:
    record, files = record_of(name), [*corpus(name), *foreign()]
    assert len(files) > 80
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for _, data in files:
            refuse(record, data)


LONG: dict[str, Callable[[], bytes]] = {
    "a line of 2 MB": lambda: b"1" * 2_000_000,
    "2 MB of words": lambda: b"1 " * 1_000_000,
    "2 MB of blank": lambda: b" " * 2_000_000,
    "2 MB of zeros": lambda: bytes(2_000_000),
    "2 MB of lines": lambda: b"\n" * 2_000_000,
    "2 MB of brackets": lambda: b"[" * 2_000_000,
    "2 MB of noise": lambda: np.random.default_rng(0).bytes(2_000_000),
    "a pickle": lambda: (
        b"\x80\x04\x95\x1d\x00\x00\x00\x00\x00\x00\x00\x8c\x05posix\x94\x8c\x06system\x94\x93\x94"
    ),
    "an HDF5 file": lambda: good("hdf5"),
    "a .vts file": lambda: good("vts"),
    "a NaN grid": lambda: good("plot3d").replace(b"e-0", b"nan"),
}


@pytest.mark.parametrize("what", LONG)
def test_large_and_foreign_files_are_refused_soon(what: str) -> None:
    data = LONG[what]()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for name in READABLE:
            refuse(record_of(name), data)
