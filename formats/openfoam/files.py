"""The files of a ``polyMesh``: lists of points, faces and labels under OpenFOAM's headers, text or binary.

Binary ones are those of a little-endian machine with labels of 32 bits and scalars of 64, which every build
reads by what the header says. https://doc.openfoam.com/2312/fundamentals/input-types/dictionaries/
"""

from itertools import pairwise
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.openfoam.faces import Faces
from meshonet.formats.text.number_table import write_rows
from meshonet.geometry.arrays import Floats

_ARCH = '    arch        "LSB;label=32;scalar=64";\n'


def head(
    kind: str, name: str, note: str = "", place: str = "constant/polyMesh", *, binary: bool = False
) -> str:
    """Return the header of a file of the class `kind`."""
    remark = f'    note        "{note}";\n' if note else ""
    form = f"binary;\n{_ARCH}" if binary else "ascii;\n"
    return (
        f"FoamFile\n{{\n    version     2.0;\n    format      {form}    class       {kind};\n{remark}"
        f'    location    "{place}";\n    object      {name};\n}}\n\n'
    )


def write_mesh(folder: Path, points: Floats, faces: Faces, *, binary: bool) -> None:
    """Write the lists of points, faces, owners and neighbours."""
    note = (
        f"nPoints: {len(points)} nCells: {int(faces.owner.max()) + 1} "
        f"nFaces: {len(faces.nodes)} nInternalFaces: {len(faces.neighbour)}"
    )
    _write_points(folder / "points", points, binary=binary)
    _write_faces(folder / "faces", faces.nodes, binary=binary)
    _write_labels(folder / "owner", faces.owner, note, binary=binary)
    _write_labels(folder / "neighbour", faces.neighbour, note, binary=binary)


def _write_points(path: Path, points: Floats, *, binary: bool) -> None:
    with path.open("wb") as stream:
        stream.write(head("vectorField", path.name, binary=binary).encode("ascii"))
        if binary:
            _put(stream, points, len(points))
        else:
            _rows(stream, "(%e %e %e)", points)


def _write_faces(path: Path, nodes: NDArray[np.int32], *, binary: bool) -> None:
    """Write faces of four nodes, or three where two are one; binary as where each begins, then all nodes."""
    kind = "faceCompactList" if binary else "faceList"
    own = nodes != np.roll(nodes, -1, axis=1)
    sizes = own.sum(axis=1)
    with path.open("wb") as stream:
        stream.write(head(kind, path.name, binary=binary).encode("ascii"))
        if binary:
            flat = nodes if (sizes == 4).all() else nodes[own]
            _put(stream, np.concatenate([[0], np.cumsum(sizes)]).astype(np.int32), len(nodes) + 1)
            _put(stream, flat, flat.size)
            return
        stream.write(f"{len(nodes)}\n(\n".encode("ascii"))
        ends = [0, *(np.flatnonzero(np.diff(sizes)) + 1).tolist(), len(nodes)]
        for first, last in pairwise(ends):
            size = int(sizes[first])
            form = f"{size}({' '.join(['%d'] * size)})"
            write_rows(stream, form, nodes[first:last][own[first:last]].reshape(-1, size))
        stream.write(b")\n")


def _write_labels(path: Path, labels: NDArray[np.int32], note: str, *, binary: bool) -> None:
    with path.open("wb") as stream:
        stream.write(head("labelList", path.name, note, binary=binary).encode("ascii"))
        if binary:
            _put(stream, labels, len(labels))
        else:
            _rows(stream, "%d", labels[:, None])


def _put(stream: BinaryIO, values: NDArray[Any], count: int) -> None:
    """Write a list of `count` things as bytes."""
    stream.write(f"\n{count}\n(".encode("ascii"))
    order = values.dtype.newbyteorder("<")
    stream.write(np.ascontiguousarray(values, order).data)
    stream.write(b")\n")


def _rows(stream: BinaryIO, form: str, rows: NDArray[Any]) -> None:
    stream.write(f"{len(rows)}\n(\n".encode("ascii"))
    write_rows(stream, form, rows)
    stream.write(b")\n")
