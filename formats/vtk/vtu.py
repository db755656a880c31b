"""VTK XML unstructured grids, ``.vtu``, through meshio: seams merged, with the cells of the boundary.

The cell array ``part`` is 0 inside and counts the boundary's parts from 1, in the order of the grid's
sides south, east, north, west. https://github.com/nschloe/meshio
"""

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from meshonet.formats.format import Heights, only_one
from meshonet.formats.mesh.unstructured import CELLS, extruded, in_space, unstructured
from meshonet.geometry.blocks.grid import Grid


def write_grids(path: Path, grids: Iterable[Grid], heights: Heights = ()) -> None:
    """Write the one grid of `grids`: quadrilaterals and lines, or repeated in z hexahedra and faces."""
    import meshio

    points, patches, inside = extruded(unstructured(only_one(grids, "a .vtu file")), heights)
    cells = [(CELLS[nodes.shape[1]], nodes) for nodes in (inside, *patches.values())]
    numbers = [np.full(len(nodes), k) for k, (_, nodes) in enumerate(cells)]
    meshio.vtu.write(str(path), meshio.Mesh(in_space(points), cells, cell_data={"part": numbers}))
