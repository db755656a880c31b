"""Writing HDF5 datasets: samples are appended one by one and written in blocks of some MB."""

from __future__ import annotations

import contextlib
import json
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from meshonet.formats.format import size_of, size_remedy
from meshonet.formats.hdf5.file import created
from meshonet.formats.hdf5.names import UniqueNames
from meshonet.formats.mesh.metadata import connections_text, plain
from meshonet.geometry.arrays import SIDES, Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError

if TYPE_CHECKING:
    import h5py

    from meshonet.formats.hdf5.index import Failed

BLOCK = 1 << 22  # bytes of samples that are collected before they are written together
TEXTS = ("names", "titles", "split", "parts", "provenance")  # datasets of texts, one text per sample
CHUNK = 1 << 14  # largest row, in bytes, that shares a chunk with other samples
Kind = Literal["meshonet-boundary", "meshonet-grid"]


class Writer:
    """Writer of a dataset, sample by sample. All samples must have the same size and topology."""

    def __init__(self, file: h5py.File, kind: Kind) -> None:
        self._file = file
        self._file.attrs.update(format=kind, version=1)
        self._data: dict[str, h5py.Dataset] = {}
        self._shapes: dict[str, tuple[int, ...]] = {}
        self._held: dict[str, list[tuple[int, Floats | str]]] = {}
        self._bytes = 0
        self._count = 0
        self._first: tuple[str, ...] = ()
        self._names = UniqueNames()
        self._common: dict[str, Any] = {}  # what the provenances of all grids say

    def append(self, sample: Boundary | Grid) -> None:
        """Add a boundary or grid. Raises InputError: size or topology differ from the first sample."""
        self._check_size(sample)
        arrays = _arrays_of(sample)
        if isinstance(sample, Grid):
            facts = {
                name: fact if isinstance(fact, str | int | float) else json.dumps(fact, default=plain)
                for name, fact in sample.provenance.items()
            }
            known = facts if self._count == 0 else self._common
            self._common = {name: fact for name, fact in known.items() if facts.get(name) == fact}
        if sample.origin.parameters:
            names, numbers = zip(*sample.origin.parameters, strict=True)
            arrays["parameters"] = np.array(numbers)
            if self._count == 0:
                self._shapes["parameters"] = (len(names),)
                self._row("parameters").attrs["names"] = names
        for name, values in arrays.items():
            shape = self._shapes.setdefault(name, values.shape)
            if values.shape != shape:
                problem = f"{name} of sample {self._count} has shape {values.shape}"
                raise InputError(problem, f"the first has {shape}")
        name = self._names.add(sample.name)
        texts = {"names": name, "titles": sample.origin.title, "split": sample.origin.split}
        rows = [[p.name, p.side, p.start, p.stop, p.block, p.across, p.kind] for p in sample.patches]
        texts["parts"] = json.dumps([row if _is_of_blocks(sample) else row[:4] for row in rows])
        if isinstance(sample, Grid) and sample.provenance:
            texts["provenance"] = json.dumps(sample.provenance, default=plain)
        for name, entry in (arrays | texts).items():
            self._hold(name, entry)
        self._count += 1
        if self._bytes >= BLOCK:
            self.flush()

    def _check_size(self, sample: Boundary | Grid) -> None:
        """Raise InputError if a sample differs from the first one in size or topology."""
        several = _is_of_blocks(sample)
        size = size_of(sample)
        connections = connections_text(sample.connections) if several else ""
        if not self._first:
            self._first = size, connections
            more = {"version": 2, "connections": connections} if several else {"topology": sample.topology}
            self._file.attrs.update(more)
        if (size, connections) != self._first:
            first = self._first[0] if size != self._first[0] else "connected otherwise"
            problem = f"sample {self._count} is {size} and the first is {first}"
            remedy = size_remedy(size, self._first[0])
            raise InputError(
                problem, f"one dataset has one size and topology: {remedy}, or write one file each"
            )

    def _hold(self, name: str, value: Floats | str) -> None:
        """Keep the entry of this sample for the next block."""
        if isinstance(value, str):
            if not value and name not in self._data and name not in self._held:
                return
            self._bytes += len(value)
        else:
            large = value.nbytes >= BLOCK  # and written before anybody can change it
            value = np.asarray(value, np.float64) if large else np.array(value, np.float64)
            self._bytes += value.nbytes
        self._held.setdefault(name, []).append((self._count, value))

    def note(self, facts: Mapping[str, str], digests: Sequence[str], failed: Sequence[str]) -> None:
        """Write how samples were made: `facts` by name, digests of inputs, and texts about failed samples."""
        size, connections = self._first or ("", "")
        joined = f", connected as {_digest(connections)}" if connections else ""
        common = {_attribute(name): _digest(str(fact)) for name, fact in self._common.items()}
        every = {**facts, "size": f"{size}{joined}"[-500:], "common": json.dumps(common)}
        self._file.attrs.update({name: np.bytes_(fact.encode()) for name, fact in every.items()})
        self._file.create_dataset("inputs", data=np.array(digests, dtype=np.bytes_))
        self.note_failed(failed)

    def note_failed(self, failed: Sequence[str]) -> None:
        """Write texts about failed samples; nothing if there are none."""
        import h5py

        if failed:
            self._file.create_dataset("failed", data=list(failed), dtype=h5py.string_dtype())

    def close(self) -> None:
        """Write the remaining samples, and the provenance common to all grids as attributes of the file."""
        self.flush()
        self._file.attrs.update({_attribute(name): fact for name, fact in self._common.items()})

    def flush(self) -> None:
        """Write the samples that have been collected in memory."""
        held, self._held, self._bytes = self._held, {}, 0
        for name, entries in held.items():
            data = self._row(name)
            data.resize(entries[-1][0] + 1, axis=0)
            last_row, last = entries[-1]
            if len(entries) == 1 and not isinstance(last, str):
                _put(data, last_row, last)
                continue
            rows = [row for row, _ in entries]
            where: Any = slice(rows[0], rows[-1] + 1) if rows[-1] - rows[0] + 1 == len(rows) else rows
            data[where] = np.array([value for _, value in entries], dtype=object if name in TEXTS else None)

    def _row(self, name: str) -> h5py.Dataset:
        """Return the dataset `name`, created at the first call."""
        import h5py

        if name not in self._data:
            text, shape = name in TEXTS, self._shapes.get(name, ())
            some = 64 if text else max(1, CHUNK // max(8 * int(np.prod(shape)), 1))
            kind: Any = h5py.string_dtype() if text else "f8"
            row = 8 * int(np.prod(shape[1:]))
            whole = (
                row * (shape or (1,))[0] <= 4 * BLOCK
            )  # else some `BLOCK` bytes of rows are stored together
            chunk = shape if whole else (max(1, BLOCK // row), *shape[1:])
            size = {"maxshape": (None, *shape), "chunks": (some, *chunk)}
            self._data[name] = self._file.create_dataset(name, (0, *shape), kind, **size)
        return self._data[name]


def _put(data: h5py.Dataset, row: int, value: Floats) -> None:
    """Write a sample; a large one chunk by chunk, because h5py converts its memory order."""
    step = data.chunks[1] if value.ndim else 1
    if not value.ndim or step >= len(value):
        data[row] = value
        return
    for start in range(0, len(value), step):
        data[row, start : start + step] = value[start : start + step]


@contextlib.contextmanager
def writing(path: Path, kind: Kind) -> Iterator[Writer]:
    """Return a context with the writer of a new dataset; after an exception, the samples so far are kept."""
    with created(path) as file:
        writer = Writer(file, kind)
        try:
            yield writer
        finally:
            writer.close()


def write_boundaries(path: Path, boundaries: Iterable[Boundary], failed: Sequence[Failed] = ()) -> None:
    """Write a dataset of boundaries, which must have the same size and topology, one at a time.

    `failed` lists samples that could not be made or were left out; it may grow while boundaries are read.
    """
    _write(path, "meshonet-boundary", boundaries, failed)


def write_grids(path: Path, grids: Iterable[Grid], failed: Sequence[Failed] = ()) -> None:
    """Write a dataset of grids, which must have the same size and topology; see `write_boundaries`."""
    _write(path, "meshonet-grid", grids, failed)


def _write(path: Path, kind: Kind, samples: Iterable[Boundary | Grid], failed: Sequence[Failed]) -> None:
    empty = True
    with writing(path, kind) as writer:
        for sample in samples:
            writer.append(sample)
            empty = False
        writer.note_failed(list(map(json.dumps, failed)))
    if empty:
        raise InputError(f"there is no {kind.removeprefix('meshonet-')} to write", "check the input")


def _digest(text: str) -> str:
    return f"{zlib.crc32(text.encode()):08x}"


def _attribute(name: str) -> str:
    return f"meshonet_{name}" if name in ("format", "version", "topology") else name


def _is_of_blocks(sample: Boundary | Grid) -> bool:
    return isinstance(sample, Grid) and sample.topology == "blocks"


def _arrays_of(sample: Boundary | Grid) -> dict[str, Floats]:
    if isinstance(sample, Boundary):
        edges: dict[str, Floats] = {side: getattr(sample, side) for side in SIDES}
        return edges if sample.sensors is None else edges | {"sensors": sample.sensors}
    if sample.topology == "blocks":
        return {f"blocks/{k}": block.nodes for k, block in enumerate(sample.blocks)}
    # the edges are those of the nodes: a grid of any quality is written, also one that is no valid boundary
    faces: dict[str, Floats] = {side: sample.face(0, side) for side in SIDES}
    return faces | {"nodes": sample.nodes}
