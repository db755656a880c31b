"""HDF5 datasets of many boundaries or grids of one size; layout version 1.

::

    attributes   format = "meshonet-boundary" or "meshonet-grid", version = 1, topology
    south, north (n, ni, 2)   west, east (n, nj, 2)   float64, corners shared
    nodes        (n, ni, nj, 2), grids only
    names, split, parts, provenance   (n,) text, where there is any
    parameters   (n, p), its attribute names (p,)
    sensors      (n, m, 2), sub-sampled boundary nodes, when asked for

Everything is chunked by sample, or by a few where these are small, and resizable along n; samples are
appended one by one and written in blocks. `parts` and `provenance` are JSON; the first grid's provenance is
repeated as attributes of the file, for reading by eye. https://docs.h5py.org
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from operator import call
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Literal, TypeVar

import numpy as np

from meshonet.formats.hdf5.check import Checked, checked
from meshonet.formats.hdf5.file import created
from meshonet.formats.mesh.metadata import plain
from meshonet.formats.mesh.recover_topology import usable
from meshonet.formats.source import Source
from meshonet.geometry.arrays import SIDES, Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.metadata import Origin
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError

if TYPE_CHECKING:
    import h5py

T = TypeVar("T")
VERSION = 1
BLOCK = 1 << 22
"""Bytes of samples that are held back to be written together."""
TEXTS = ("names", "split", "parts", "provenance")
CHUNK = 1 << 14
"""Bytes up to which rows of several samples share a chunk."""
Kind = Literal["meshonet-boundary", "meshonet-grid"]


class Writer:
    """A dataset being written; all samples that were appended are in the file when it is left, however it is.

    Parameters
    ----------
    path : file to make.
    kind : what it will hold.
    parameter_names : names of the numbers that go with each sample, if any do.

    Raises
    ------
    InputError
        when a sample differs from the first one in size or topology.
    """

    def __init__(self, path: Path, kind: Kind, parameter_names: Sequence[str] = ()) -> None:
        self._made = created(path)
        self._file = self._made.__enter__()
        self._file.attrs.update(format=kind, version=VERSION)
        self._data: dict[str, h5py.Dataset] = {}
        self._shapes: dict[str, tuple[int, ...]] = {}
        self._held: dict[str, list[tuple[int, Floats | str]]] = {}
        self._bytes = 0
        self._count = 0
        self._first: tuple[int, int, str] | None = None
        if parameter_names:
            self._name_parameters(parameter_names)

    def __enter__(self) -> Writer:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self._flush()
        finally:
            self._made.__exit__(kind, error, trace)

    def append(self, sample: Boundary | Grid, *, parameters: Floats | None = None, split: str = "") -> None:
        """Add one sample.

        Parameters
        ----------
        sample : a grid for a file of grids, else a boundary.
        parameters : (p,) numbers that made it; None for those of its origin.
        split : ``train``, ``test`` or nothing; that of its origin when empty.
        """
        shape = (sample.ni, sample.nj, sample.topology)
        if self._first is None:
            self._first = shape
            self._file.attrs["topology"] = sample.topology
        if shape != self._first:
            raise InputError(
                "sample {} is {}x{} {} and the first is {}x{} {}".format(self._count, *shape, *self._first),
                "one dataset has one size and topology: set {res} and {topology}, or write one file each",
            )
        arrays: dict[str, Floats]
        if isinstance(sample, Grid):  # of any quality: its edges may be no valid boundary
            nodes = sample.nodes
            sides = (nodes[:, 0], nodes[-1], nodes[:, -1], nodes[0])
            arrays = dict(zip(SIDES, sides, strict=True)) | {"nodes": nodes}
            if self._count == 0:
                self._facts(sample.provenance)
        else:
            arrays = {side: getattr(sample, side) for side in SIDES}
        if parameters is None and sample.origin.parameters:
            parameters = self._parameters(sample.origin)
        if parameters is not None:
            arrays["parameters"] = parameters
        if isinstance(sample, Boundary) and sample.sensors is not None:
            arrays["sensors"] = sample.sensors
        self._check(arrays)
        texts = {"names": sample.name, "split": split or sample.origin.split}
        texts["parts"] = json.dumps([[p.name, p.side, p.start, p.stop] for p in sample.patches])
        if isinstance(sample, Grid) and sample.provenance:
            texts["provenance"] = json.dumps(sample.provenance, default=plain)
        for name, values in arrays.items():
            self._hold(name, values)
        for name, text in texts.items():
            self._hold(name, text)
        self._count += 1
        if self._bytes >= BLOCK:
            self._flush()

    def _parameters(self, origin: Origin) -> Floats:
        """Return the numbers of a sample; the first one's names are those of the dataset."""
        if "parameters" not in self._data and self._count == 0:
            self._name_parameters([name for name, _ in origin.parameters])
        return np.array([value for _, value in origin.parameters])

    def _name_parameters(self, names: Sequence[str]) -> None:
        self._shapes["parameters"] = (len(names),)
        self._row("parameters").attrs["names"] = list(names)

    def _check(self, arrays: Mapping[str, Floats]) -> None:
        for name, values in arrays.items():
            shape = self._shapes.setdefault(name, values.shape)
            if values.shape != shape:
                told = f"{name} of sample {self._count} has shape {values.shape}"
                raise InputError(told, f"the first has {shape}")

    def _hold(self, name: str, value: Floats | str) -> None:
        """Keep the entry of this sample for the next block; a text of nothing has none."""
        if isinstance(value, str):
            if not value and name not in self._data and name not in self._held:
                return
            self._bytes += len(value)
        else:
            value = np.array(value, dtype=np.float64)
            self._bytes += value.nbytes
        self._held.setdefault(name, []).append((self._count, value))

    def _flush(self) -> None:
        held, self._held, self._bytes = self._held, {}, 0
        for name, entries in held.items():
            data = self._row(name)
            data.resize(entries[-1][0] + 1, axis=0)
            rows = [row for row, _ in entries]
            where: Any = slice(rows[0], rows[-1] + 1) if rows[-1] - rows[0] + 1 == len(rows) else rows
            data[where] = np.array([value for _, value in entries], dtype=object if name in TEXTS else None)

    def _row(self, name: str) -> h5py.Dataset:
        """Return the dataset of a name, made when it is first needed."""
        import h5py

        if name not in self._data:
            text, shape = name in TEXTS, self._shapes.get(name, ())
            some = 64 if text else max(1, CHUNK // max(8 * int(np.prod(shape)), 1))
            kind: Any = h5py.string_dtype() if text else "f8"
            most = (None, *shape)
            self._data[name] = self._file.create_dataset(
                name, (0, *shape), kind, maxshape=most, chunks=(some, *shape)
            )
        return self._data[name]

    def _facts(self, facts: Mapping[str, Any]) -> None:
        """Repeat the first sample's provenance as attributes of the file."""
        for key, value in facts.items():
            name = f"meshonet_{key}" if key in ("format", "version", "topology") else key
            self._file.attrs[name] = (
                value if isinstance(value, str | int | float) else json.dumps(value, default=plain)
            )


def write_boundaries(path: Path, boundaries: Iterable[Boundary]) -> None:
    """Write boundaries of one size and topology, each as it comes."""
    _write(path, "meshonet-boundary", boundaries)


def write_grids(path: Path, grids: Iterable[Grid]) -> None:
    """Write grids of one size and topology, each as it comes."""
    _write(path, "meshonet-grid", grids)


def read_shapes(source: Source) -> Iterator[Boundary]:
    """Return an iterator over the boundaries; of a grid dataset, the grids' outer edges as they were stored.

    It goes on behind a sample that is not right and raised InputError.
    """
    return map(call, _samples(source, _boundary))


def read_grids(source: Source) -> Iterator[Grid]:
    """Return an iterator over the grids; it goes on behind a sample that is not right.

    Raises
    ------
    InputError
        the dataset holds boundaries only, or is not right.
    """
    return map(call, _samples(source, _grid))


def _samples(source: Source, read: Callable[[Checked, int], T]) -> Iterator[Callable[[], T]]:
    """Yield functions that read one sample each: what they raise does not end the generator."""
    with checked(source) as data:
        if read is _grid and "nodes" not in data:
            raise InputError(
                "holds boundaries, not grids", "make grids of them first: meshonet solve-pde IN -o OUT.h5"
            )
        for k in data.kept(source.split):
            yield partial(read, data, k)


def _boundary(data: Checked, k: int) -> Boundary:
    with data.place(k):
        south, north, west, east = (data.sample(side, k) for side in ("south", "north", "west", "east"))
        name = data.text("names", k)
        parts, origin = _parts(data, k), _origin(data, k)
        return Boundary(south, north, west, east, data.topology, parts, name, origin=origin)


def _grid(data: Checked, k: int) -> Grid:
    with data.place(k):
        facts = json.loads(data.text("provenance", k) or "{}")
        if not isinstance(facts, dict):
            raise InputError("provenance is not a JSON object", "remove the dataset 'provenance'")
        return Grid.from_nodes(
            usable(data.sample("nodes", k)),
            data.topology,
            _parts(data, k),
            data.text("names", k),
            facts,
            _origin(data, k),
        )


def read_parameters(source: Source) -> tuple[tuple[str, ...], Floats, tuple[str, ...]]:
    """Return the names (p,), the parameters (n, p) and the split (n,) of a dataset; empty where absent."""
    with checked(source) as data:
        count = range(data.count)
        if "parameters" not in data:
            return (), np.empty((data.count, 0)), tuple(data.text("split", k) for k in count)
        rows = np.array([data.sample("parameters", k) for k in count])
        return data.parameter_names(), rows, tuple(data.text("split", k) for k in count)


def _write(path: Path, kind: Kind, samples: Iterable[Boundary | Grid]) -> None:
    with Writer(path, kind) as writer:
        empty = True
        for sample in samples:
            writer.append(sample)
            empty = False
    if empty:
        raise InputError(f"there is no {kind.removeprefix('meshonet-')} to write", "check the input")


def _origin(data: Checked, k: int) -> Origin:
    if "parameters" not in data:
        return Origin(split=data.text("split", k))
    row = data.sample("parameters", k)
    names = data.parameter_names() or tuple(f"parameter {m}" for m in range(len(row)))
    pairs = tuple((name, float(value)) for name, value in zip(names, row, strict=False))
    return Origin(pairs, data.text("split", k))


def _parts(data: Checked, k: int) -> tuple[Patch, ...]:
    try:
        rows = json.loads(data.text("parts", k) or "[]")
        return tuple(Patch(str(name), side, int(start), int(stop)) for name, side, start, stop in rows)
    except (ValueError, TypeError, RecursionError):
        raise InputError(
            "its parts are not a JSON list of [name, side, start, stop]", "remove the dataset 'parts'"
        ) from None
