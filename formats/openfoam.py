"""OpenFOAM's mesh of a case: ``constant/polyMesh``, one cell thick, front and back ``empty``.

The file named, ``case/case.foam``, is the empty one by which ParaView opens a case; the mesh goes into the
folder around it. Where ``system`` lacks one of the three dictionaries without which no tool of OpenFOAM
looks at a mesh, a bare one is written. https://doc.openfoam.com/2312/tools/processing/mesh/polyMesh/
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from formats.format import Format, only_one
from formats.output import whole_file, whole_folder
from formats.patches import Role, patches, roles
from formats.unstructured import Indices, Unstructured, layer_points, unstructured
from formats.words import words, write_rows
from geometry.grid import Grid

EMPTY = "frontAndBack"
"""Name of the patch of type ``empty``: the planes z = 0 and z = thickness."""

_TYPES: dict[Role, str] = {"wall": "wall", "symmetry": "symmetry"}
_DICTIONARIES = {
    "controlDict": "startFrom latestTime;\nstartTime 0;\nstopAt endTime;\nendTime 1000;\ndeltaT 1;\n"
    "writeControl timeStep;\nwriteInterval 1000;\n",
    "fvSchemes": "gradSchemes {}\ndivSchemes {}\nlaplacianSchemes {}\n",
    "fvSolution": "",
}


@dataclass(frozen=True)
class Faces:
    """The faces of a layer, those between cells first.

    Parameters
    ----------
    nodes : (f, 4) point numbers; the normal points out of the owner.
    owner : (f,) cell behind each face; the lower of two.
    neighbour : (g,) cell before each of the g inner faces, which are in upper-triangular order.
    patches : name and count of the outer faces, in order.
    """

    nodes: Indices
    owner: Indices
    neighbour: Indices
    patches: tuple[tuple[str, int], ...]


def write_grids(path: Path, grids: Iterable[Grid]) -> None:
    """Write the one grid of `grids`, one unit of length thick."""
    write_extruded(path, grids, 1.0)


def write_extruded(path: Path, grids: Iterable[Grid], thickness: float) -> None:
    """Write the one grid of `grids` around `path`, which is left empty, one cell thick in z.

    The mesh that is there is replaced when the new one is whole.
    """
    grid = only_one(grids, "a case")
    mesh = unstructured(grid)
    faces = layer_faces(mesh)
    role = roles(grid, patches(grid))
    for name in ("constant", "system"):
        (path.parent / name).mkdir(exist_ok=True)
    with whole_folder(path.parent / "constant" / "polyMesh") as folder:
        _write_points(folder / "points", mesh, thickness)
        _write_faces(folder, faces, len(mesh.points))
        _write_boundary(folder / "boundary", faces, role)
    for name, told in _DICTIONARIES.items():
        dictionary = path.parent / "system" / name
        if not dictionary.exists():
            with whole_file(str(dictionary)) as part:
                part.write_text(_head("dictionary", name, place="system") + told, encoding="ascii")
    path.write_bytes(b"")


def layer_faces(mesh: Unstructured) -> Faces:
    """Return the faces of the cells over the quadrilaterals of `mesh`.

    An edge a, b of a cell on its left carries the face a, b, b', a' of the layer, whose normal points to
    the right: out of the cell.
    """
    count, cells = len(mesh.points), len(mesh.quads)
    edges = mesh.quads[:, [0, 1, 1, 2, 2, 3, 3, 0]].reshape(-1, 2)  # four of each cell, in turn
    key = edges.min(axis=1) * count + edges.max(axis=1)
    order = np.argsort(key, kind="stable")
    twice = key[order[1:]] == key[order[:-1]]
    lower, upper = order[:-1][twice], order[1:][twice]
    rows = np.lexsort([upper // 4, lower // 4])
    inner = edges[lower[rows]]

    outer = [mesh.edges[name] for name in mesh.edges]
    joined = np.concatenate(outer) if outer else np.empty((0, 2), np.int64)
    at = np.searchsorted(key, joined.min(axis=1) * count + joined.max(axis=1), sorter=order)
    sides = np.concatenate([inner, joined])
    every = np.arange(cells)
    return Faces(
        np.concatenate(
            [np.column_stack([sides, sides[:, ::-1] + count]), mesh.quads[:, ::-1], mesh.quads + count]
        ),
        np.concatenate([lower[rows] // 4, order[at] // 4, every, every]),
        upper[rows] // 4,
        (*((name, len(mesh.edges[name])) for name in mesh.edges), (EMPTY, 2 * cells)),
    )


def _write_points(path: Path, mesh: Unstructured, thickness: float) -> None:
    points = layer_points(mesh, thickness)
    with path.open("w", encoding="ascii") as stream:
        stream.write(f"{_head('vectorField', 'points')}{len(points)}\n(\n")
        write_rows(stream, "(%.16e %.16e %.16e)", points)
        stream.write(")\n")


def _write_faces(folder: Path, faces: Faces, count: int) -> None:
    """Write the lists of faces, owners and neighbours; `count` is that of the points of one plane."""
    note = (
        f"nPoints: {2 * count} nCells: {int(faces.owner.max()) + 1} "
        f"nFaces: {len(faces.nodes)} nInternalFaces: {len(faces.neighbour)}"
    )
    lists = (
        ("faces", "faceList", "4(%d %d %d %d)", faces.nodes, ""),
        ("owner", "labelList", "%d", faces.owner[:, None], note),
        ("neighbour", "labelList", "%d", faces.neighbour[:, None], note),
    )
    for name, kind, form, rows, remark in lists:
        with (folder / name).open("w", encoding="ascii") as stream:
            stream.write(f"{_head(kind, name, remark)}{len(rows)}\n(\n")
            write_rows(stream, form, rows)
            stream.write(")\n")


def _write_boundary(path: Path, faces: Faces, role: dict[str, Role]) -> None:
    """Write names, types and face counts of the patches; the last one is the two planes."""
    word = words((name for name, _ in faces.patches[:-1]), taken=[EMPTY], letter=True)

    def entries() -> Iterator[str]:
        start = len(faces.neighbour)
        for k, (name, count) in enumerate(faces.patches):
            last = k == len(faces.patches) - 1
            title, kind = (name, "empty") if last else (word[name], _TYPES.get(role[name], "patch"))
            yield f"    {title}\n    {{\n        type            {kind};\n"
            yield f"        nFaces          {count};\n        startFace       {start};\n    }}\n"
            start += count

    text = f"{_head('polyBoundaryMesh', 'boundary')}{len(faces.patches)}\n(\n{''.join(entries())})\n"
    path.write_text(text, encoding="ascii")


def _head(kind: str, name: str, note: str = "", place: str = "constant/polyMesh") -> str:
    remark = f'    note        "{note}";\n' if note else ""
    return (
        f"FoamFile\n{{\n    version     2.0;\n    format      ascii;\n    class       {kind};\n{remark}"
        f'    location    "{place}";\n    object      {name};\n}}\n\n'
    )


FORMAT = Format(
    name="openfoam",
    suffixes=(".foam",),
    description="OpenFOAM case: constant/polyMesh in the folder of the file, one cell thick",
    write_grids=write_grids,
    write_extruded=write_extruded,
    names_parts=True,
    fills_folder=True,
)
