"""Meshes that meshio writes and that are not read here, with merged seams.

Triangles come from quadrilaterals by their shorter diagonal. https://github.com/nschloe/meshio
"""

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from meshonet.formats.format import Options, only_one
from meshonet.formats.mesh.unstructured import CELLS, Indices, Unstructured, unstructured, with_z
from meshonet.geometry.blocks.grid import Grid

_TRIANGLES = {"stl", "off"}  # formats without quadrilaterals
_SETTINGS: dict[str, dict[str, object]] = {
    "stl": {"binary": True}, "ply": {"binary": True}, "abaqus": {"float_fmt": ".16e"},
    "medit": {"float_fmt": ".16e"},
    "xdmf": {"data_format": "XML"},
}  # fmt: skip
"""Arguments of meshio's writers, for full precision."""


def write_grids(path: Path, grids: Iterable[Grid], *, options: Options = frozenset()) -> None:
    """Write `grids`, which must be a single grid, by the package meshio in the format that `options` name."""
    import meshio

    (kind,) = options or {"stl"}
    mesh = unstructured(only_one(grids, f"a file of {kind}"))
    cells, nodes = ("triangle", _triangles(mesh)) if kind in _TRIANGLES else ("quad", mesh.cells)
    made = meshio.Mesh(with_z(mesh.points), [(cells, nodes.astype(np.int32))])
    getattr(meshio, kind).write(str(path), made, **_SETTINGS.get(kind, {}))


def write_vtu(path: Path, grids: Iterable[Grid]) -> None:
    """Write the cells and the boundary faces of the only grid of `grids`.

    The cell array ``part`` is 0 for cells. For a boundary face it is the number of its patch, from 1.
    """
    import meshio

    mesh = unstructured(only_one(grids, "a .vtu file"))
    cells = [(CELLS[nodes.shape[1]], nodes) for nodes in (mesh.cells, *mesh.faces.values())]
    numbers = [np.full(len(nodes), k) for k, (_, nodes) in enumerate(cells)]
    meshio.vtu.write(str(path), meshio.Mesh(with_z(mesh.points), cells, cell_data={"part": numbers}))


def _triangles(mesh: Unstructured) -> Indices:
    """Return two triangles (2m, 3) for each quadrilateral."""
    quads = mesh.cells
    corner = mesh.points[quads]
    first, second = (np.hypot(*(corner[:, k] - corner[:, k + 2]).T) for k in (0, 1))
    turned = np.where((first <= second)[:, None], quads, np.roll(quads, -1, axis=1))
    return np.stack([turned[:, [0, 1, 2]], turned[:, [0, 2, 3]]], axis=1).reshape(-1, 3)
