"""OpenFOAM meshes, ``constant/polyMesh``, of volumes, or of planar grids one cell thick.

The output file ``case/case.foam`` is empty; ParaView opens a case by it.
https://doc.openfoam.com/2312/tools/processing/mesh/polyMesh/
"""

from collections.abc import Iterable
from pathlib import Path

from meshonet.formats.format import Options, only_one
from meshonet.formats.mesh.collapsed import with_collapsed
from meshonet.formats.mesh.names import words
from meshonet.formats.mesh.periodic import outer_parts
from meshonet.formats.mesh.unstructured import node_numbers, points_of
from meshonet.formats.openfoam.faces import all_faces, without_collapsed
from meshonet.formats.openfoam.files import head, write_mesh, write_zone
from meshonet.formats.openfoam.patches import patches_of, with_empty_planes, write_boundary
from meshonet.formats.output import whole_file, whole_folder
from meshonet.geometry.blocks.extrude import extruded
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.screw import screw_of
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import check_extent

_DICTIONARIES = {
    "controlDict": "startFrom latestTime;\nstartTime 0;\nstopAt endTime;\nendTime 1000;\ndeltaT 1;\n"
    "writeControl timeStep;\nwriteInterval 1000;\n",
    "fvSchemes": "gradSchemes {}\ndivSchemes {}\nlaplacianSchemes {}\n",
    "fvSolution": "",
}
"""Minimal entries of the dictionaries without which OpenFOAM's tools do not start."""
_SMALL = 1 << 16  # largest number of cells of a mesh that is written as text, unless options say otherwise
_ZONE = "passage"  # name of the zone of a grid without one


def write_grids(path: Path, grids: Iterable[Grid], *, options: Options = frozenset()) -> None:
    """Write the only grid of `grids` into the folder of `path`; the file at `path` is left empty.

    A planar grid becomes one layer of cells. The two planes of this layer, or of a volume with one layer of
    cells between symmetry planes, form a patch of type ``empty``. Cells at collapsed sides become prisms or
    pyramids. In blade rows, and if periodic sides are related by a rotation, all cells form a zone with the
    name of the grid, for a rotating frame. Missing dictionaries in ``system`` are added.
    """
    grid = only_one(grids, "a case")
    low, high = grid.box
    check_extent(float((high - low).max()))
    if grid.form == "plane":
        grid = extruded(grid, (0.0, 1.0))
    apart = node_numbers(grid)
    numbers = with_collapsed(grid, apart)
    points = points_of(grid, numbers)
    parts, pairs = outer_parts(grid, numbers)
    parts = with_empty_planes(grid, parts)
    faces = all_faces(grid, numbers, parts)
    if numbers is not apart:
        faces, parts = without_collapsed(faces, parts)
    if not len(faces.owner):
        raise InputError("no cell of the grid has a volume", "give a grid whose nodes are apart")
    periodic = "cyclicAMI" if "cyclicami" in options else "cyclic"
    patches = patches_of(grid, parts, pairs, points, periodic)
    binary = "binary" in options or (len(points) > _SMALL and "ascii" not in options)
    for name in ("constant", "system"):
        (path.parent / name).mkdir(exist_ok=True)
    with whole_folder(path.parent / "constant" / "polyMesh") as folder:
        write_mesh(folder, points, faces, binary=binary)
        write_boundary(folder / "boundary", patches, len(faces.neighbour))
        if grid.provenance.get("method") == "row" or any(screw_of(pair.motion).angle for pair in pairs):
            (name,) = words([grid.name or _ZONE], letter=True).values()
            write_zone(folder / "cellZones", name, int(faces.owner.max()) + 1, binary=binary)
    for name, entries in _DICTIONARIES.items():
        dictionary = path.parent / "system" / name
        if not dictionary.exists():
            with whole_file(str(dictionary)) as part:
                part.write_text(head("dictionary", name, place="system") + entries, encoding="ascii")
    path.write_bytes(b"")
