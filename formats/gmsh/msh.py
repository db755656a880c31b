"""Gmsh ``.msh`` 2.2 and 4.1: quadrilaterals with merged seams, and the boundary's parts as physical groups.

2.2 is written through meshio, binary unless asked otherwise; text is what converters such as OpenFOAM's
insist on. 4.1 is in `meshonet.formats.gmsh.msh41`. https://gmsh.info/doc/texinfo/gmsh.html#MSH-file-format-version-2
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import partial
from pathlib import Path
from types import ModuleType

import numpy as np

from meshonet.formats.format import Format, Heights, only_one
from meshonet.formats.gmsh import msh41 as gmsh41
from meshonet.formats.gmsh.msh41 import INTERIOR
from meshonet.formats.gmsh.read import read_shapes, sniff
from meshonet.formats.mesh.unstructured import Indices, extruded, unstructured
from meshonet.formats.source import printable
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid


def write_grids(path: Path, grids: Iterable[Grid], *, text: bool = False) -> None:
    """Write the one grid of `grids`: quads, and lines in groups named as its parts."""
    mesh = unstructured(only_one(grids, "a .msh file"))
    points = np.column_stack([mesh.points, np.zeros(len(mesh.points))])
    groups = [("line", name, edges) for name, edges in mesh.edges.items()]
    _write(path, points, 1, groups, ("quad", mesh.quads), text=text)


def write_extruded(path: Path, grids: Iterable[Grid], heights: Heights, *, text: bool = False) -> None:
    """Write the one grid of `grids` repeated in z: hexahedra, and faces in groups."""
    mesh = unstructured(only_one(grids, "a .msh file"))
    points, faces, hexahedra = extruded(mesh, heights)
    groups = [("quad", name, quads) for name, quads in faces.items()]
    _write(path, points, 2, groups, ("hexahedron", hexahedra), text=text)


def _write(
    path: Path,
    points: Floats,
    dimension: int,
    groups: list[tuple[str, str, Indices]],
    interior: tuple[str, Indices],
    *,
    text: bool,
) -> None:
    """Write groups (cell kind, name, cells) of `dimension`, and the interior one dimension up."""
    import meshio

    inside = INTERIOR if all(name != INTERIOR for _, name, _ in groups) else f"{INTERIOR}-cells"
    cells = [(kind, block) for kind, _, block in groups] + [interior]
    names = [(quotable(name), dimension) for _, name, _ in groups] + [(inside, dimension + 1)]
    tags = [np.full(len(block), tag) for tag, (_, block) in enumerate(cells, start=1)]
    mesh = meshio.Mesh(
        points,
        cells,
        field_data={name: np.array([tag, dim]) for tag, (name, dim) in enumerate(names, start=1)},
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
    )
    meshio.gmsh.write(str(path), mesh, fmt_version="2.2", binary=not text, float_fmt=".16e")


def quotable(name: str) -> str:
    """Return a name that can stand between double quotes."""
    return printable(name).replace('"', "'")


def _formats(number: str, one: ModuleType | None, version: str) -> Iterator[Format]:
    """Yield the binary and the text format of a version; `one` has its writers, or this module."""
    grids = one.write_grids if one else write_grids
    layers = one.write_extruded if one else write_extruded
    for text, kind in ((False, "binary"), (True, "text")):
        yield Format(
            name=f"gmsh{number}{'-ascii' if text else ''}",
            suffixes=(".msh",),
            description=f"Gmsh {version} mesh, {kind}, parts as physical groups; read as a boundary",
            read_shapes=read_shapes,
            write_grids=partial(grids, text=text),
            write_extruded=partial(layers, text=text),
            sniff=sniff,
            names_patches=True,
        )


FORMATS = (*_formats("", None, "2.2"), *_formats("41", gmsh41, "4.1"))
