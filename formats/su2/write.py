"""SU2's own mesh, ``.su2``: merged seams, counter-clockwise cells, a marker for every part.

Text with 17 significant digits, nodes counted from 0. Markers are words (`meshonet.formats.mesh.names`), since
configuration files list them by name. https://su2code.github.io/docs_v7/Mesh-File/
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from meshonet.formats.format import Format, Heights, only_one
from meshonet.formats.mesh.names import words
from meshonet.formats.mesh.unstructured import Indices, extruded, unstructured
from meshonet.formats.su2.read import read_shapes, sniff
from meshonet.formats.text.number_table import write_rows
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid

_LINE, _QUADRILATERAL, _HEXAHEDRON = 3, 9, 12  # VTK's numbers


def write_grids(path: Path, grids: Iterable[Grid]) -> None:
    """Write the one grid of `grids`: quadrilaterals, and lines under the names of its parts."""
    mesh = unstructured(only_one(grids, "a .su2 file"))
    _write(path, mesh.points, (_QUADRILATERAL, mesh.quads), (_LINE, mesh.edges))


def write_extruded(path: Path, grids: Iterable[Grid], heights: Heights) -> None:
    """Write the one grid of `grids` repeated in z, the outer planes as markers ``back`` and ``front``."""
    points, faces, hexahedra = extruded(unstructured(only_one(grids, "a .su2 file")), heights)
    _write(path, points, (_HEXAHEDRON, hexahedra), (_QUADRILATERAL, faces))


def _write(
    path: Path, points: Floats, cells: tuple[int, Indices], markers: tuple[int, Mapping[str, Indices]]
) -> None:
    """Write points (n, 2 or 3), the cells (kind, nodes) and the markers (kind, nodes by name)."""
    kind, nodes = cells
    marker_kind, parts = markers
    with path.open("wb") as stream:
        stream.write(f"NDIME= {points.shape[1]}\nNELEM= {len(nodes)}\n".encode("ascii"))
        write_rows(stream, _row(kind, nodes), nodes)
        stream.write(f"NPOIN= {len(points)}\n".encode("ascii"))
        write_rows(stream, " ".join(["%e"] * points.shape[1]), points)
        stream.write(f"NMARK= {len(parts)}\n".encode("ascii"))
        for name, word in words(parts).items():
            stream.write(f"MARKER_TAG= {word}\nMARKER_ELEMS= {len(parts[name])}\n".encode("ascii"))
            write_rows(stream, _row(marker_kind, parts[name]), parts[name])


def _row(kind: int, nodes: Indices) -> str:
    return " ".join([str(kind), *["%d"] * nodes.shape[1]])


FORMAT = Format(
    name="su2",
    suffixes=(".su2",),
    description="SU2 mesh, text, parts as markers; read as a boundary",
    write_grids=write_grids,
    write_extruded=write_extruded,
    read_shapes=read_shapes,
    sniff=sniff,
    names_patches=True,
)
