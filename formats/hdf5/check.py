"""Checks of an HDF5 dataset: layout, shapes, types and sizes, before memory is allocated.

The HDF5 library (1.14 and before) trusts damaged sizes of heaps and texts: endless loops, 4 GiB of memory.
Format Specification III.E: https://support.hdfgroup.org/documentation/hdf5/latest/_f_m_t3.html
"""

from __future__ import annotations

import contextlib
import mmap
import re
import struct
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from meshonet.formats.mesh.metadata_read import connections_from
from meshonet.formats.mesh.recover_topology import known_topology
from meshonet.formats.source import Source, printable, reason_of
from meshonet.geometry.arrays import SIDES, Floats, Topology
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.errors import InputError

if TYPE_CHECKING:
    import h5py

TOGETHER = 1 << 17  # number of bytes of small samples that are read together
LARGE = 1 << 22  # largest sample, in bytes, that is not read in parts
_DEFLATE_LIMIT = 1032  # largest compression ratio of deflate, the best of HDF5's filters; more means damage
_MOST_SEARCHED = 1 << 28  # largest file, in bytes, that is searched for heaps, so that this is quick
_DAMAGE = (OSError, RuntimeError, LookupError, TypeError, ValueError, ArithmeticError)
"""Exceptions that h5py raises for damaged data."""
_TEXT = np.dtype([("length", "<u4"), ("heap", "<u8"), ("index", "<u4")])
"""Storage of a text of variable length in HDF5: length of the text, and position in a heap."""


class Checked:
    """An open dataset with `count` samples of one `topology`; in version 2, a sample has `blocks` blocks."""

    def __init__(self, file: h5py.File, source: Source) -> None:
        self._file, self._source = file, source
        self._texts: dict[str, Any] = {}
        self._rows: dict[str, tuple[int, Floats]] = {}  # first row and rows that were read together
        kind = _attribute(file, "format")
        if kind not in ("meshonet-boundary", "meshonet-grid"):
            raise InputError(
                "is HDF5 but not a dataset of boundaries or grids",
                "set its attributes format ('meshonet-boundary' or 'meshonet-grid'), version and topology",
            )
        self.version = _attribute(file, "version")
        self.topology: Topology = "blocks"
        self.blocks = 0
        self.connections: tuple[Connection, ...] = ()
        if self.version == "1":
            self._check_edges(file, kind)
        elif self.version == "2" and kind == "meshonet-grid":
            self._check_blocks(file)
        else:
            remedy = "this program reads version 1, and version 2 of grids: get a newer one"
            raise InputError(f"has layout version {self.version!r}", remedy)
        if self.count == 0:
            raise InputError("holds no samples", "write at least one")
        if "parameters" in self and self._shape("parameters", 2)[0] != self.count:
            raise InputError("dataset 'parameters' has another count than 'south'", "give one row a sample")

    def _check_edges(self, file: h5py.File, kind: str) -> None:
        self.topology = known_topology(_attribute(file, "topology"))
        self.count, ni = self._shape("south", 3)[:2]
        nj = self._shape("west", 3)[1]
        wanted = {"south": (ni, 2), "north": (ni, 2), "west": (nj, 2), "east": (nj, 2), "nodes": (ni, nj, 2)}
        for name in SIDES if kind == "meshonet-boundary" else (*SIDES, "nodes"):
            due = self.count, *wanted[name]
            shape = self._shape(name, len(due))
            if shape != due:
                remedy = f"it must be {due} as 'south' and 'west' say"
                raise InputError(f"dataset {name!r} has shape {shape}", remedy)

    def _check_blocks(self, file: h5py.File) -> None:
        import h5py

        group = own(file, "blocks")
        self.blocks = len(group) if isinstance(group, h5py.Group) else 0
        if not self.blocks:
            raise InputError("has no blocks", "store their nodes as blocks/0, blocks/1 ...")
        counts = {self._shape(f"blocks/{k}", 4, 5)[0] for k in range(self.blocks)}
        self.count = counts.pop()
        if counts:
            raise InputError("its blocks have different counts of samples", "give each sample every block")
        self.connections = connections_from(_attribute(file, "connections"))

    def __contains__(self, name: str) -> bool:
        return name in self._file

    def kept(self, split: str) -> Sequence[int]:
        """Return the indices of the samples in a split such as ``test``; of all if `split` is empty."""
        if not split:
            return range(self.count)
        return [k for k in range(self.count) if self.text("split", k) == split]

    def sample(self, name: str, k: int) -> Floats:
        """Return row `k` of the numeric dataset `name` as float64."""
        first, rows = self._rows.get(name, (0, np.empty(0)))
        if not first <= k < first + len(rows):
            first, rows = k, self._rows_from(self._file[name], k)
            self._rows[name] = first, rows
        return np.array(rows[k - first], dtype=np.float64)

    def nodes(self, name: str, k: int) -> Floats:
        """Return row `k` of a dataset of nodes; each coordinate is contiguous in memory."""
        data = self._file[name]
        if 8 * int(np.prod(data.shape[1:])) <= LARGE:
            return self.sample(name, k)
        nodes = np.empty((data.shape[-1], *data.shape[1:-1]))
        step = max(1, LARGE * data.shape[1] // (8 * nodes.size))
        for start in range(0, data.shape[1], step):
            nodes[:, start : start + step] = np.moveaxis(data[k, start : start + step], -1, 0)
        return np.moveaxis(nodes, 0, -1)

    @staticmethod
    def _rows_from(data: h5py.Dataset, k: int) -> Any:
        """Return row `k` and those after it, about `TOGETHER` bytes."""
        size = data.dtype.itemsize * max(int(np.prod(data.shape[1:])), 1)
        try:
            return data[k : k + max(TOGETHER // size, 1)]
        except OSError:  # the broken one may be a later row
            return data[k : k + 1]

    def text(self, name: str, k: int) -> str:
        """Return entry `k` of the dataset of texts `name`; empty if there is no such dataset or entry."""
        import h5py

        if name not in self._texts:
            data = self._dataset(name) if name in self else None
            if data is not None and (data.ndim != 1 or h5py.check_string_dtype(data.dtype) is None):
                raise InputError(f"dataset {name!r} is not a list of texts", "store strings, one a sample")
            if data is not None:
                _check_texts(data, self._source)
            self._texts[name] = data
        data = self._texts[name]
        if data is None or k >= len(data):
            return ""
        text = _text(data[k])
        return printable(text) if name in ("names", "titles", "split") else text

    def parameter_names(self) -> tuple[str, ...]:
        """Return the column names of the dataset ``parameters``."""
        names = np.atleast_1d(self._dataset("parameters").attrs.get("names", []))
        return tuple(printable(_text(name)) for name in names)

    @contextlib.contextmanager
    def place(self, k: int) -> Iterator[None]:
        """Return a context in which errors become an InputError that names sample `k`."""
        try:
            yield
        except InputError as error:
            error.place = error.place or f"sample {k}"
            raise
        except (ValueError, RecursionError) as error:
            raise InputError(str(error), "write the dataset again", place=f"sample {k}") from error
        except _DAMAGE as error:
            raise _damaged(error, f"sample {k}") from error

    def _dataset(self, name: str) -> h5py.Dataset:
        import h5py

        data = own(self._file, name)
        if not isinstance(data, h5py.Dataset):
            remedy = "store south, north, west and east (and nodes for grids)"
            raise InputError(f"has no dataset {name!r}", remedy)
        if data.is_virtual or data.external:
            raise InputError(f"dataset {name!r} lies in another file", "store it in this one")
        return data

    def _shape(self, name: str, *ndim: int) -> tuple[int, ...]:
        """Return the shape of a numeric dataset once its type, rank and stored size are plausible."""
        data = self._dataset(name)
        if data.dtype.kind not in "fiu" or data.ndim not in ndim:
            wanted = " or ".join(map(str, ndim))
            problem = f"dataset {name!r} is {data.dtype} with {data.ndim} axes"
            raise InputError(problem, f"store float64 with {wanted} axes")
        check_stored(data, f"dataset {name!r}")
        return tuple(int(n) for n in data.shape)


def own(group: h5py.Group, name: str) -> Any:
    """Return the member `name` of `group`; None if it is missing or a link to another object."""
    import h5py

    return group.get(name) if isinstance(group.get(name, getlink=True), h5py.HardLink) else None


def check_stored(data: h5py.Dataset, what: str, place: str = "") -> None:
    """Raise InputError if `data` has far fewer stored bytes than its shape needs; `what` is its name."""
    if data.size * data.dtype.itemsize > _DEFLATE_LIMIT * max(data.id.get_storage_size(), 1):
        problem = f"{what} claims shape {data.shape} but holds next to nothing"
        raise InputError(problem, "write the file again", place=place)


@contextlib.contextmanager
def checked(source: Source) -> Iterator[Checked]:
    """Return a context with the dataset in `source`; errors of the HDF5 library become InputError."""
    with opened(source) as file:
        yield Checked(file, source)


@contextlib.contextmanager
def opened(source: Source, *, texts: bool = True) -> Iterator[h5py.File]:
    """Open the HDF5 file `source` for reading, as a context; errors of HDF5 become InputError.

    `texts=False` skips the check for damaged strings; strings of variable length must then not be read.
    """
    import h5py

    if texts:
        check_heaps(source)
    with contextlib.ExitStack() as stack:
        try:
            target = source.path or stack.enter_context(source.open())
            file = stack.enter_context(h5py.File(target, "r", locking="best-effort"))
        except _DAMAGE as error:
            problem = f"is not readable as HDF5 ({reason_of(error)})"
            raise InputError(problem, "check that the file is whole") from error
        try:
            yield file
        except InputError:
            raise
        except _DAMAGE as error:
            raise _damaged(error) from error


def _damaged(error: Exception, place: str = "") -> InputError:
    return InputError(f"HDF5 data is damaged ({reason_of(error)})", "write the file again", place=place)


def _attribute(file: h5py.File, name: str) -> str:
    return _text(file.attrs.get(name, ""))


def _text(value: object) -> str:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def check_heaps(source: Source) -> None:
    """Raise InputError if a storage area of texts (a heap) is not filled exactly by its texts."""
    if source.size > _MOST_SEARCHED:
        return
    with source.open() as stream, contextlib.ExitStack() as stack:
        data: bytes | mmap.mmap = source.data or b""
        if source.data is None:
            data = stack.enter_context(mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ))
        for heap in re.finditer(rb"GCOL\x01\0\0\0(.{8})", data, re.DOTALL):
            at, end = heap.end(), heap.start() + int.from_bytes(heap[1], "little")
            while at + 16 <= end <= len(data):
                index, size = struct.unpack_from("<H6xQ", data, at)
                step = 16 + (size + 7) // 8 * 8 if index else size
                at = at + step if step >= 16 else end + 1
            if not at <= end <= len(data):
                problem = "HDF5 data is damaged (a heap of texts)"
                raise InputError(problem, "write the file again", place=f"byte {heap.start()}")


def _check_texts(data: h5py.Dataset, source: Source) -> None:
    """Raise InputError if a text in a dataset (n,) of texts has a length above that of the file."""
    if not data.id.get_type().is_variable_str() or data.id.get_create_plist().get_nfilters():
        return
    pieces = [(data.id.get_offset() or 0, data.id.get_storage_size())]
    if data.chunks is not None:
        chunks = map(data.id.get_chunk_info, range(data.id.get_num_chunks()))
        pieces = [(chunk.byte_offset, chunk.size) for chunk in chunks]
    with source.open() as stream:
        for offset, size in pieces:
            stream.seek(offset)
            raw = stream.read(size)
            lengths = np.frombuffer(raw, _TEXT, len(raw) // _TEXT.itemsize)["length"]
            if (lengths > source.size).any():
                problem = f"dataset {data.name.lstrip('/')!r} claims a text longer than the file"
                raise InputError(problem, "write the file again")
