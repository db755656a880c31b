"""An entry: transfinite surfaces of Gmsh on boundaries of a .h5 file, written to another.

    python benchmarks/yardstick/gmsh_transfinite.py BOUNDARIES.h5 GRIDS.h5 [SMOOTHINGS]

Every edge between two boundary nodes is a line of one element, so that Gmsh keeps the given nodes. Gmsh (GPL)
is a tool of tests and benchmarks only.
"""

import sys
from pathlib import Path

import gmsh
import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))
from yardstick.files import read_boundaries, write_grids
from yardstick.shapes import Floats, Shape


def main() -> None:
    """Mesh every shape."""
    source, output, *more = sys.argv[1:]
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("General.NumThreads", 1)
    smoothings = int(more[0]) if more else 0
    grids = {shape.name: transfinite(shape, smoothings) for shape in read_boundaries(Path(source))}
    gmsh.finalize()
    write_grids(Path(output), grids)


def transfinite(shape: Shape, smoothings: int) -> Floats:
    """Return the nodes (ni, nj, 2) of the transfinite surface."""
    ni, nj = len(shape.south), len(shape.west)
    outline = np.concatenate(
        [shape.south, shape.east[1:], shape.north[-2::-1], shape.west[-2:0:-1]]
    )  # counter-clockwise from the south-west corner, each node once
    gmsh.clear()
    geo, mesh = gmsh.model.geo, gmsh.model.mesh
    points = [geo.addPoint(x, y, 0.0) for x, y in outline.tolist()]
    lines = [geo.addLine(a, b) for a, b in zip(points, [*points[1:], points[0]], strict=True)]
    surface = geo.addPlaneSurface([geo.addCurveLoop(lines)])
    corners = [points[k] for k in (0, ni - 1, ni + nj - 2, 2 * ni + nj - 3)]
    geo.synchronize()
    for line in lines:
        mesh.setTransfiniteCurve(line, 2)
    mesh.setTransfiniteSurface(surface, "Left", corners)
    mesh.setRecombine(2, surface)
    mesh.setSmoothing(2, surface, smoothings)
    mesh.generate(2)
    tags, xyz, _ = mesh.getNodes()
    places = dict(zip(tags.tolist(), xyz.reshape(-1, 3)[:, :2], strict=True))
    rim = [int(mesh.getNodes(0, point)[0][0]) for point in points]
    quads = mesh.getElementsByType(3)[1].reshape(-1, 4).tolist()
    numbers = _ordered(quads, rim[:ni], [rim[0], *rim[:-nj:-1]])
    return np.array([[places[tag] for tag in row] for row in numbers])


def _ordered(quads: list[list[int]], south: list[int], west: list[int]) -> list[list[int]]:
    """Return the node numbers [i][j] of a structured mesh of which two sides are known."""
    fourth = {
        frozenset(quad[:k] + quad[k + 1 :]): quad[k] for quad in quads for k in range(4)
    }  # the last node of a quad by its three others
    columns = [[number, *[0] * (len(west) - 1)] for number in south]
    columns[0] = west
    for i in range(1, len(south)):
        for j in range(1, len(west)):
            known = frozenset((columns[i - 1][j - 1], columns[i][j - 1], columns[i - 1][j]))
            columns[i][j] = fourth[known]
    return columns


if __name__ == "__main__":
    main()
