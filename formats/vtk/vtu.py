"""VTK XML unstructured grids, ``.vtu``, through meshio: seams merged, with the cells of the boundary.

The cell array ``part`` is 0 inside and counts the boundary's parts from 1, in the order of the grid's
sides south, east, north, west. https://github.com/nschloe/meshio
"""

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from meshonet.formats.format import only_one
from meshonet.formats.mesh.unstructured import CELLS, unstructured, with_z
from meshonet.geometry.blocks.grid import Grid


def write_grids(path: Path, grids: Iterable[Grid]) -> None:
    """Write the only grid of `grids`: quads and lines, or of a volume hexahedra and quads."""
    import meshio

    mesh = unstructured(only_one(grids, "a .vtu file"))
    cells = [(CELLS[nodes.shape[1]], nodes) for nodes in (mesh.cells, *mesh.faces.values())]
    numbers = [np.full(len(nodes), k) for k, (_, nodes) in enumerate(cells)]
    meshio.vtu.write(str(path), meshio.Mesh(with_z(mesh.points), cells, cell_data={"part": numbers}))
