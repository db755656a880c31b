"""CGNS's nodes in an HDF5 file: a group with texts of fixed length, and the dataset ``" data"``.

Axes run in the opposite order to the Fortran terms of https://cgns.org/standard/FMM/hdf5_impl.html
"""

from collections.abc import Iterator
from functools import cache
from typing import Any, TypeAlias

import h5py
import numpy as np
from h5py import h5a, h5d, h5g, h5l, h5o, h5p, h5s, h5t
from numpy.typing import NDArray

from meshonet.formats.hdf5.check import check_stored, own
from meshonet.formats.source import printable
from meshonet.geometry.errors import InputError

Node: TypeAlias = h5py.Group
NAME_LENGTH = 32  # largest number of characters of a node's name
VERSIONS = "earliest", "v108"  # oldest and newest HDF5 version that can read the objects of a file
_TYPES = {"int8": "C1", "int32": "I4", "int64": "I8", "float32": "R4", "float64": "R8"}
"""CGNS's names of number types by those of NumPy."""
_DATA = " data"  # name of the dataset of a node's data, with the leading blank that the standard requires


def root(file: h5py.File) -> Node:
    """Make and return the root node of a new CGNS file, which was opened with ``track_order=True``."""
    _label(file, "HDF5 MotherNode", "Root Node of HDF5 File", "MT")
    del file.attrs["flags"]
    file.create_dataset(" format", data=_codes("IEEE_LITTLE_32", 15))
    file.create_dataset(" hdf5version", data=_codes("HDF5 Version 1.8.0", 33))
    child(file, "CGNSLibraryVersion", "CGNSLibraryVersion_t", np.array([3.3], np.float32))
    return file


def child(parent: Node, name: str, label: str, value: str | NDArray[Any] | None = None) -> Node:
    """Add a node to `parent` and return it; the axes of an array `value` must be in the order of HDF5."""
    data = _codes(value, len(value.encode())) if isinstance(value, str) else value
    blank = _blank(label, "MT" if data is None else _TYPES[data.dtype.name])
    own = name.encode()
    h5o.copy(blank.id, b".", parent.id, own, lcpl=_links(ascii_name=name.isascii()))
    node = h5py.Group(h5g.open(parent.id, own))
    text = np.array(own, "S33")
    h5a.open(node.id, b"name").write(text, _stored_as(text.dtype.str, text.shape)[0])
    if data is not None:
        stored, space = _stored_as(data.dtype.str, data.shape)
        h5d.create(node.id, _DATA.encode(), stored, space).write(
            space, space, np.ascontiguousarray(data), stored
        )
    return node


def children(node: Node, label: str) -> Iterator[tuple[str, Node]]:
    """Yield name and node of each child of `node` that has the given label; links are skipped."""
    links = node.id.links
    for name in node.id:  # without h5py's objects, which take most of the time of files of many zones
        if links.get_info(name).type == h5l.TYPE_HARD:
            below = h5o.open(node.id, name)
            if isinstance(below, h5g.GroupID) and _label_of(below) == label:
                yield name.decode("utf-8", "surrogateescape"), h5py.Group(below)


def array(node: Node, ndim: int) -> NDArray[Any]:
    """Return the array of a node. Raises InputError: no array; an array of wrong type, rank or size."""
    place = printable(str(node.name))
    data = own(node, _DATA)
    if not isinstance(data, h5py.Dataset) or data.is_virtual or data.external:
        raise InputError("node has no data of its own", "write the file again", place=place)
    if data.dtype.kind not in "fiu" or data.ndim != ndim:
        problem = f"node holds {data.dtype} with {data.ndim} axes"
        raise InputError(problem, f"it must be numbers with {ndim}", place=place)
    check_stored(data, "node", place)
    return np.asarray(data[()])


def text(node: Node) -> str:
    """Return the text of a node. Raises InputError if the node has none."""
    codes = array(node, 1)
    if codes.dtype.itemsize != 1:
        raise InputError("node holds no text", "write the file again", place=printable(str(node.name)))
    return codes.tobytes().rstrip(b"\0 ").decode("utf-8", "replace")


def _label(node: Node, name: str, label: str, kind: str) -> None:
    _set(node, b"name", np.array(name.encode(), "S33"))
    _set(node, b"label", np.array(label.encode(), "S33"))
    _set(node, b"type", np.array(kind.encode(), "S3"))
    _set(node, b"flags", np.array([1], np.int32))


def _set(node: Node, name: bytes, value: NDArray[Any]) -> None:
    stored, space = _stored_as(value.dtype.str, value.shape)
    h5a.create(node.id, name, stored, space).write(value, stored)


@cache
def _blank(label: str, kind: str) -> Node:
    """Return the template of nodes with this label and type."""
    node = _blanks().create_group(f"{label} {kind}", track_order=True)
    _label(node, "", label, kind)
    return node


@cache
def _blanks() -> h5py.File:
    return h5py.File("blanks", "w", driver="core", backing_store=False, track_order=True, libver=VERSIONS)


@cache
def _links(*, ascii_name: bool) -> Any:
    links = h5p.create(h5p.LINK_CREATE)
    links.set_char_encoding(h5t.CSET_ASCII if ascii_name else h5t.CSET_UTF8)
    return links


@cache
def _stored_as(dtype: str, shape: tuple[int, ...]) -> tuple[Any, Any]:
    space = h5s.create_simple(shape) if shape else h5s.create(h5s.SCALAR)
    return h5t.py_create(np.dtype(dtype), logical=True), space


def _label_of(node: h5g.GroupID) -> str:
    if not h5a.exists(node, b"label"):
        return ""
    value = h5py.Group(node).attrs["label"]
    return value.decode("utf-8", "replace").rstrip("\0 ") if isinstance(value, bytes) else str(value)


def _codes(value: str, length: int) -> NDArray[np.int8]:
    return np.frombuffer(value.encode().ljust(length, b"\0")[:length], np.int8)
