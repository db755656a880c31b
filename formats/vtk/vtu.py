"""VTK XML unstructured grids, ``.vtu``, through meshio: seams merged, with the cells of the boundary.

The cell array ``part`` is 0 inside and counts the boundary's parts from 1, in the order of the grid's
sides south, east, north, west. https://github.com/nschloe/meshio
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np

from meshonet.formats.format import Heights, only_one
from meshonet.formats.mesh.unstructured import Indices, extruded, unstructured
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid


def write_grids(path: Path, grids: Iterable[Grid]) -> None:
    """Write the one grid of `grids`: quadrilaterals, and lines along its parts."""
    mesh = unstructured(only_one(grids, "a .vtu file"))
    points = np.column_stack([mesh.points, np.zeros(len(mesh.points))])
    _write(path, points, ("quad", mesh.quads), ("line", mesh.edges))


def write_extruded(path: Path, grids: Iterable[Grid], heights: Heights) -> None:
    """Write the one grid of `grids` repeated in z: hexahedra, and faces over its parts."""
    points, faces, hexahedra = extruded(unstructured(only_one(grids, "a .vtu file")), heights)
    _write(path, points, ("hexahedron", hexahedra), ("quad", faces))


def _write(
    path: Path, points: Floats, inside: tuple[str, Indices], outside: tuple[str, Mapping[str, Indices]]
) -> None:
    import meshio

    kind, parts = outside
    cells = [inside, *((kind, nodes) for nodes in parts.values())]
    numbers = [np.full(len(nodes), k) for k, (_, nodes) in enumerate(cells)]
    meshio.vtu.write(str(path), meshio.Mesh(points, cells, cell_data={"part": numbers}))
