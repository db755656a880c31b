"""The files of a ``polyMesh``: points, faces and labels, text or binary (little-endian, 32 and 64 bits).

https://doc.openfoam.com/2312/fundamentals/input-types/dictionaries/
"""

from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.openfoam.faces import Faces
from meshonet.formats.text.number_table import write_rows
from meshonet.geometry.arrays import Floats

_ARCH = '    arch        "LSB;label=32;scalar=64";\n'  # header entry with the number formats of a binary file


def head(
    kind: str, name: str, note: str = "", place: str = "constant/polyMesh", *, binary: bool = False
) -> str:
    """Return the header of an OpenFOAM file; `kind` is its class, `name` its object, `place` its location."""
    remark = f'    note        "{note}";\n' if note else ""
    form = f"binary;\n{_ARCH}" if binary else "ascii;\n"
    return (
        f"FoamFile\n{{\n    version     2.0;\n    format      {form}    class       {kind};\n{remark}"
        f'    location    "{place}";\n    object      {name};\n}}\n\n'
    )


def write_mesh(folder: Path, points: Floats, faces: Faces, *, binary: bool) -> None:
    """Write the mesh files ``points``, ``faces``, ``owner`` and ``neighbour`` into `folder`."""
    note = (
        f"nPoints: {len(points)} nCells: {int(faces.owner.max()) + 1} "
        f"nFaces: {len(faces.nodes)} nInternalFaces: {len(faces.neighbour)}"
    )
    put = _put if binary else _rows
    with _list(folder / "points", "vectorField", binary=binary) as stream:
        put(stream, points, "(%e %e %e)")
    _write_faces(folder / "faces", faces.nodes, binary=binary)
    for name, labels in (("owner", faces.owner), ("neighbour", faces.neighbour)):
        with _list(folder / name, "labelList", note, binary=binary) as stream:
            put(stream, labels, "%d")


def write_zone(path: Path, name: str, cells: int, *, binary: bool) -> None:
    """Write a file of cell zones with a single zone, `name`, which contains all `cells` cells."""
    with path.open("wb") as stream:
        stream.write(head("regIOobject", path.name, binary=binary).encode("ascii"))
        entries = "    type            cellZone;\n    cellLabels      List<label>"
        stream.write(f"1\n(\n{name}\n{{\n{entries}\n".encode("ascii"))
        put = _put if binary else _rows
        put(stream, np.arange(cells, dtype=np.int32), "%d")
        stream.write(b";\n}\n)\n")


@contextmanager
def _list(path: Path, kind: str, note: str = "", *, binary: bool) -> Iterator[BinaryIO]:
    """Return a context with the stream of a list whose header is written."""
    with path.open("wb") as stream:
        stream.write(head(kind, path.name, note, binary=binary).encode("ascii"))
        yield stream


def _write_faces(path: Path, nodes: NDArray[np.int32], *, binary: bool) -> None:
    """Write faces of four nodes, or three if two are equal; binary as start indices, then all nodes."""
    kind = "faceCompactList" if binary else "faceList"
    own = nodes != np.roll(nodes, -1, axis=1)
    sizes = own.sum(axis=1)
    with _list(path, kind, binary=binary) as stream:
        if binary:
            flat = nodes if (sizes == 4).all() else nodes[own]
            _put(stream, np.concatenate([[0], np.cumsum(sizes)]).astype(np.int32))
            _put(stream, flat.reshape(-1))
            return
        stream.write(f"{len(nodes)}\n(\n".encode("ascii"))
        ends = [0, *(np.flatnonzero(np.diff(sizes)) + 1).tolist(), len(nodes)]
        for first, last in pairwise(ends):
            size = int(sizes[first])
            form = f"{size}({' '.join(['%d'] * size)})"
            write_rows(stream, form, nodes[first:last][own[first:last]].reshape(-1, size))
        stream.write(b")\n")


def _put(stream: BinaryIO, values: NDArray[Any], _: str = "") -> None:
    """Write a list as bytes."""
    stream.write(f"\n{len(values)}\n(".encode("ascii"))
    order = values.dtype.newbyteorder("<")
    stream.write(np.ascontiguousarray(values, order).data)
    stream.write(b")\n")


def _rows(stream: BinaryIO, rows: NDArray[Any], form: str) -> None:
    """Write a list as text, one entry of the format `form` per line."""
    stream.write(f"{len(rows)}\n(\n".encode("ascii"))
    write_rows(stream, form, rows.reshape(len(rows), -1))
    stream.write(b")\n")
