"""Quads by Gmsh in a domain, as a process of its own: nodes and quads to an .npz file.

    python benchmarks/gmsh_quads.py DOMAIN.geojson ALGORITHM CELLS OUT.npz

Gmsh is a tool of the tests and benchmarks only (GPL).
"""

import sys
import time
from pathlib import Path
from typing import Any

import gmsh
import numpy as np

import meshonet
from meshonet.geometry.domain.loop import Loop

NEAR = 0.8, 1.25
"""What the cells may be of those asked for, before the size is corrected."""


def main() -> None:
    """Mesh, twice where the first count is far off, and write."""
    source, algorithm, cells, out = sys.argv[1:]
    wanted = int(cells)
    nodes, quads, triangles, spent = meshed(source, int(algorithm), wanted)
    if len(quads) and not NEAR[0] <= len(quads) / wanted <= NEAR[1]:
        corrected = int(wanted * wanted / max(len(quads), wanted // 20))
        nodes, quads, triangles, spent = meshed(source, int(algorithm), corrected)
    np.savez(Path(out), nodes=nodes, quads=quads, triangles=triangles, seconds=spent)


def meshed(source: str, algorithm: int, cells: int) -> tuple[Any, Any, int, float]:
    """Return nodes (n, 2), quads (m, 4), the number of triangles left, and the seconds of meshing alone."""
    domain = meshonet.read(source).domain  # type: ignore[union-attr]
    size = float(np.sqrt(domain.area / cells))
    gmsh.initialize()
    for name, value in {
        "General.Terminal": 0, "General.NumThreads": 1, "Mesh.Algorithm": algorithm, "Mesh.RecombineAll": 1,
        "Mesh.MeshSizeMin": 0.2 * size, "Mesh.MeshSizeMax": size, "Mesh.MeshSizeFromPoints": 0,
    }.items():  # fmt: skip
        gmsh.option.setNumber(name, value)
    gmsh.model.geo.addPlaneSurface([gmsh.model.geo.addCurveLoop(curves(loop)) for loop in domain.loops])
    gmsh.model.geo.synchronize()
    begun = time.process_time()
    gmsh.model.mesh.generate(2)
    spent = time.process_time() - begun
    tags, xyz, _ = gmsh.model.mesh.getNodes()
    number = np.full(int(tags.max()) + 1, -1)
    number[tags.astype(int)] = np.arange(len(tags))
    quads, triangles = np.zeros((0, 4), dtype=int), 0
    for kind, _, nodes in zip(*gmsh.model.mesh.getElements(2), strict=True):
        if kind == 3:
            quads = number[nodes.astype(int)].reshape(-1, 4)
        if kind == 2:
            triangles = len(nodes) // 3
    gmsh.finalize()
    return xyz.reshape(-1, 3)[:, :2], quads, triangles, spent


def curves(loop: Loop) -> list[int]:
    """Return the curves of a loop: lines and splines from corner to corner, two for a smooth loop."""
    points = [gmsh.model.geo.addPoint(x, y, 0.0) for x, y in loop.curve.points.tolist()]
    n = len(points)
    corners = sorted(loop.corners) or [0]
    if len(corners) == 1:
        corners = sorted([corners[0], (corners[0] + n // 2) % n])
    lines = []
    for first, last in zip(corners, [*corners[1:], corners[0] + n], strict=True):
        along = [points[k % n] for k in range(first, last + 1)]
        lines.append(gmsh.model.geo.addLine(*along) if len(along) == 2 else gmsh.model.geo.addSpline(along))
    return lines


if __name__ == "__main__":
    main()
