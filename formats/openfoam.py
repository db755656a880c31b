"""OpenFOAM's mesh of a case: ``constant/polyMesh``, one cell thick unless asked otherwise.

The file named, ``case/case.foam``, is the empty one by which ParaView opens a case; the mesh goes into the
folder around it. Where ``system`` lacks one of the three dictionaries without which no tool of OpenFOAM
looks at a mesh, a bare one is written. https://doc.openfoam.com/2312/tools/processing/mesh/polyMesh/
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.format import Heights, only_one
from meshonet.formats.mesh.names import kinds, words
from meshonet.formats.mesh.unstructured import Indices, Unstructured, layer_points, unstructured
from meshonet.formats.output import whole_file, whole_folder
from meshonet.formats.text.number_table import write_rows
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.connection import Motion
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Kind

EMPTY = "frontAndBack"
"""Name of the patch of type ``empty``: the two planes of a grid that is one cell thick."""

_TYPES: dict[Kind, str] = {"wall": "wall", "symmetry": "symmetry"}
_DICTIONARIES = {
    "controlDict": "startFrom latestTime;\nstartTime 0;\nstopAt endTime;\nendTime 1000;\ndeltaT 1;\n"
    "writeControl timeStep;\nwriteInterval 1000;\n",
    "fvSchemes": "gradSchemes {}\ndivSchemes {}\nlaplacianSchemes {}\n",
    "fvSolution": "",
}


class Patch(NamedTuple):
    """Outer faces that lie behind each other in the list of faces; `more` are further entries."""

    name: str
    kind: str
    size: int
    more: tuple[str, ...] = ()


@dataclass(frozen=True)
class Faces:
    """The faces of some layers of cells, those between cells first.

    Parameters
    ----------
    nodes : (f, 4) point numbers; the normal points out of the owner.
    owner : (f,) cell behind each face; the lower of two.
    neighbour : (g,) cell before each of the g inner faces, which are in upper-triangular order.
    patches : the outer faces, in order.
    """

    nodes: Indices
    owner: Indices
    neighbour: Indices
    patches: tuple[Patch, ...]


def write_grids(path: Path, grids: Iterable[Grid], heights: Heights = (0.0, 1.0)) -> None:
    """Write the one grid of `grids` around `path`, which is left empty, repeated in z.

    One cell thick, its two planes are a patch ``empty``; thicker, they are symmetry planes. The mesh that is
    there is replaced when the new one is whole.
    """
    grid = only_one(grids, "a case")
    mesh = unstructured(grid)
    faces = layer_faces(mesh, _patches(grid, mesh), len(heights) - 1)
    for name in ("constant", "system"):
        (path.parent / name).mkdir(exist_ok=True)
    with whole_folder(path.parent / "constant" / "polyMesh") as folder:
        points = layer_points(mesh, heights)
        _write_list(folder / "points", "vectorField", "(%e %e %e)", points)
        _write_faces(folder, faces, len(points))
        _write_boundary(folder / "boundary", faces)
    for name, entries in _DICTIONARIES.items():
        dictionary = path.parent / "system" / name
        if not dictionary.exists():
            with whole_file(str(dictionary)) as part:
                part.write_text(_head("dictionary", name, place="system") + entries, encoding="ascii")
    path.write_bytes(b"")


def layer_faces(mesh: Unstructured, kinds: Mapping[str, Patch], layers: int) -> Faces:
    """Return the faces of `layers` layers of cells over the quadrilaterals of `mesh`.

    An edge a, b of a cell on its left carries the face a, b, b', a' of the layer, whose normal points to
    the right: out of the cell. `kinds` has a patch for each name of the mesh's edges.
    """
    count, cells = len(mesh.points), len(mesh.quads)
    inner, edges, lower, upper = _plane(mesh)
    layer, every = np.arange(layers)[:, None], np.arange(cells)
    owner, neighbour = (lower + cells * layer).ravel(), (upper + cells * layer).ravel()
    nodes = _walls(inner, count, layers)
    if layers > 1:
        between = (every + cells * layer[:-1]).ravel()
        owner, neighbour = np.concatenate([owner, between]), np.concatenate([neighbour, between + cells])
        plates = [mesh.quads + count * k for k in range(1, layers)]
        order = np.lexsort([neighbour, owner])
        owner, neighbour, nodes = owner[order], neighbour[order], np.concatenate([nodes, *plates])[order]
    back, front = mesh.quads[:, ::-1], mesh.quads + count * layers
    beside = [_walls(rows, count, layers) for rows, _ in edges.values()]
    turned = {pair.partner for pair in mesh.periodic}  # coupled faces begin at points that are coupled
    beside = [np.roll(w, -1, 1) if name in turned else w for name, w in zip(edges, beside, strict=True)]
    behind = [(cell + cells * layer).ravel() for _, cell in edges.values()]
    ends = [Patch(EMPTY, "empty", 2 * cells)]
    if layers > 1:
        ends = [Patch(name, "symmetryPlane", cells) for name in ("back", "front")]
    return Faces(
        np.concatenate([nodes, *beside, back, front]),
        np.concatenate([owner, *behind, every, every + cells * (layers - 1)]),
        neighbour,
        (*(kinds[name]._replace(size=layers * len(rows)) for name, (rows, _) in edges.items()), *ends),
    )


def _plane(mesh: Unstructured) -> tuple[Indices, dict[str, tuple[Indices, Indices]], Indices, Indices]:
    """Return the inner edges (g, 2), each name's edges and cells, and the two cells at each inner edge."""
    count = len(mesh.points)
    edges = mesh.quads[:, [0, 1, 1, 2, 2, 3, 3, 0]].reshape(-1, 2)  # four of each cell, in turn
    key = edges.min(axis=1) * count + edges.max(axis=1)
    order = np.argsort(key, kind="stable")
    twice = key[order[1:]] == key[order[:-1]]
    lower, upper = order[:-1][twice], order[1:][twice]
    rows = np.lexsort([upper // 4, lower // 4])
    outer = {}
    for name, ends in mesh.edges.items():
        at = np.searchsorted(key, ends.min(axis=1) * count + ends.max(axis=1), sorter=order)
        outer[name] = ends, order[at] // 4
    return edges[lower[rows]], outer, lower[rows] // 4, upper[rows] // 4


def _walls(edges: Indices, count: int, layers: int) -> Indices:
    """Return the faces (n * layers, 4) over edges (n, 2), layer by layer, `count` points a plane."""
    wall = np.column_stack([edges, edges[:, ::-1] + count])
    return np.concatenate([wall + count * k for k in range(layers)])


def _patches(grid: Grid, mesh: Unstructured) -> dict[str, Patch]:
    """Return title, type and further entries of the patch of each part; periodic sides are ``cyclic``."""
    kind = kinds(grid, grid.outer_patches())
    word = words(mesh.edges, taken=[EMPTY, "back", "front"], letter=True)
    found = {name: Patch(word[name], _TYPES.get(kind.get(name, "other"), "patch"), 0) for name in mesh.edges}
    for pair in mesh.periodic:
        ends = (pair.name, pair.partner, pair.motion), (pair.partner, pair.name, pair.motion.inverse())
        for name, partner, motion in ends:
            more = f"neighbourPatch  {word[partner]};", *_transform(motion)
            found[name] = Patch(word[name], "cyclic", 0, more)
    return found


def _transform(motion: Motion) -> tuple[str, ...]:
    """Return how the faces of a cyclic patch come to its neighbour's."""
    angle, centre = motion.rotation
    if angle:
        axis = "transform       rotational;", "rotationAxis    (0 0 1);"
        return *axis, f"rotationCentre  {_vector(centre)};"
    return "transform       translational;", f"separationVector {_vector(motion.translation)};"


def _vector(values: Floats) -> str:
    return f"({values[0] + 0.0:.17g} {values[1] + 0.0:.17g} 0)"


def _write_list(path: Path, kind: str, form: str, rows: NDArray[Any], note: str = "") -> None:
    with path.open("wb") as stream:
        stream.write(f"{_head(kind, path.name, note)}{len(rows)}\n(\n".encode("ascii"))
        write_rows(stream, form, rows)
        stream.write(b")\n")


def _write_faces(folder: Path, faces: Faces, points: int) -> None:
    """Write the lists of faces, owners and neighbours."""
    note = (
        f"nPoints: {points} nCells: {int(faces.owner.max()) + 1} "
        f"nFaces: {len(faces.nodes)} nInternalFaces: {len(faces.neighbour)}"
    )
    _write_list(folder / "faces", "faceList", "4(%d %d %d %d)", faces.nodes)
    _write_list(folder / "owner", "labelList", "%d", faces.owner[:, None], note)
    _write_list(folder / "neighbour", "labelList", "%d", faces.neighbour[:, None], note)


def _write_boundary(path: Path, faces: Faces) -> None:
    """Write names, types and face counts of the patches."""
    text, start = f"{_head('polyBoundaryMesh', 'boundary')}{len(faces.patches)}\n(\n", len(faces.neighbour)
    for patch in faces.patches:
        entries = "".join(f"        {entry}\n" for entry in patch.more)
        text += f"    {patch.name}\n    {{\n        type            {patch.kind};\n{entries}"
        text += f"        nFaces          {patch.size};\n        startFace       {start};\n    }}\n"
        start += patch.size
    path.write_text(f"{text})\n", encoding="ascii")


def _head(kind: str, name: str, note: str = "", place: str = "constant/polyMesh") -> str:
    remark = f'    note        "{note}";\n' if note else ""
    return (
        f"FoamFile\n{{\n    version     2.0;\n    format      ascii;\n    class       {kind};\n{remark}"
        f'    location    "{place}";\n    object      {name};\n}}\n\n'
    )
