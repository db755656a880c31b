"""Table of all formats. Functions of a format are loaded when they are first used."""

import re
from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import Any

from meshonet.formats.format import Format, Space, kinds_in_space, later
from meshonet.formats.plot3d import CHOICES
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError

_DRAW = "meshonet.formats.figure.picture:write_grids"
_BOTH: Any = ("volumes", "surfaces")
_VOLUMES: Any = ("volumes",)
_HDF5, _CGNS = rb"\x89HDF\r\n\x1a\n", rb"HDF5 MotherNode"
_WKT = rb"\s*(?:POLYGON|LINESTRING|LINEARRING|MULTI\w+|GEOMETRYCOLLECTION)\b"
_MESHIO = {
    ".stl": "stl", ".ply": "ply", ".obj": "obj", ".off": "off", ".inp": "abaqus", ".mesh": "medit",
    ".avs": "avsucd", ".tec": "tecplot",
    ".dato": "permas", ".post": "permas", ".mdpa": "mdpa", ".med": "med", ".vol": "netgen",
    ".xdmf": "xdmf", ".xmf": "xdmf",
}  # fmt: skip
"""meshio's name of the format for each extension."""


def holds(marks: tuple[bytes, ...], head: bytes) -> bool:
    """Return whether `head`, the first bytes of a file, contains all texts in `marks`."""
    return all(mark in head[:4096] for mark in marks)


def begins(pattern: bytes, head: bytes) -> bool:
    """Return whether `head`, the first bytes of a file, matches the regular expression `pattern`."""
    return re.match(pattern, head, re.DOTALL | re.IGNORECASE) is not None


def _format(name: str, endings: str, description: str, functions: str, **more: Any) -> Format:
    """Return a record; `functions`, ``module:field``, are loaded when they are called."""
    for function in functions.split():
        more[function.partition(":")[2]] = partial(later, __package__ + f".{function}")
    if "write_grids" in more:
        more["write_grids"] = partial(_write, more["write_grids"], name)
    return Format(name, tuple(endings.split()), description, **more)


def _write(write: Any, name: str, path: Path, grids: Iterable[Grid], *rest: Any, **more: Any) -> None:
    """Write grids by the function `write` of the format `name`, which must be able to store each of them."""
    write(path, map(partial(_held, TABLE[name]), grids), *rest, **more)


def check_space(record: Format, kind: Space, output: str = "") -> None:
    """Raise InputError if a format cannot store this `kind` of 3-D blocks; `output` names the file."""
    if kind not in record.space:
        able = ", ".join(other.name for other in _FORMATS if kind in other.space and other.write_grids)
        held = " and ".join(("grids in the plane", *record.space))
        problem = f"{record.name} files hold {held}, but this grid has {kind} in space"
        raise InputError(problem, f"write one of {able}", source=output)


def _held(record: Format, grid: Grid) -> Grid:
    """Return the grid. Raises InputError: the format cannot store it."""
    for kind in kinds_in_space(grid) if grid.form != "plane" else ():
        check_space(record, kind)
    if len(grid.blocks) > 1 and not record.blocks:
        able = ", ".join(other.name for other in _FORMATS if other.blocks)
        problem = f"{record.name} files hold one block and the grid has {len(grid.blocks)}"
        raise InputError(problem, f"write one of {able}")
    return grid


_FORMATS: tuple[Format, ...] = (
    _format(
        "hdf5", ".h5 .hdf5", "HDF5 dataset of boundaries or grids",
        "hdf5.read:read_shapes hdf5.read:read_grids hdf5.write:write_grids hdf5.write:write_boundaries",
        sniff=partial(begins, _HDF5 + rb"(?!.*" + _CGNS + rb")"), names_patches=True, many=True,
        one_size=True, blocks="kept", space=_BOTH,
    ),
    _format(
        "vts", ".vts", "VTK XML structured grid", "vtk.vts_read:read_grids vtk.vts:write_grids",
        sniff=partial(holds, (b"<VTKFile", b"StructuredGrid")), names_patches=True,
        space=_BOTH,
    ),
    _format(
        "vtm", ".vtm", "VTK multi-block file: an index file, and a folder with one .vts file per block",
        "vtk.vtm:read_grids vtk.vtm:write_grids",
        sniff=partial(holds, (b"<VTKFile", b"vtkMultiBlockDataSet")),
        names_patches=True, blocks="kept", many=True, beside=True, space=_BOTH,
    ),
    _format(
        "vtk", ".vtk", "legacy VTK structured grid", "vtk.legacy:read_grids vtk.legacy:write_grids",
        sniff=partial(begins, rb"# vtk DataFile"), names_patches=True, choices=(("binary", "ascii"),),
        space=_BOTH,
    ),
    _format(
        "vtu", ".vtu", "VTK XML unstructured grid; coincident nodes are merged, patches have numbers",
        "", write_grids=partial(_write, partial(later, "meshonet.formats.meshio_export:write_vtu"), "vtu"),
        blocks="merged", space=_BOTH,
    ),
    _format(
        "gmsh", ".msh", "Gmsh mesh; patches are physical groups; only the boundary is read",
        "gmsh.read:read_shapes gmsh.msh:write_grids", sniff=partial(holds, (b"$MeshFormat",)),
        names_patches=True, choices=(("binary", "ascii"), ("2.2", "4.1")), blocks="merged", space=_BOTH,
    ),
    _format(
        "cgns", ".cgns", "CGNS structured zones in HDF5, with boundary conditions and families",
        "cgns.read:read_grids cgns.write:write_grids", blocks="kept", names_patches=True, many=True,
        sniff=partial(begins, rb".{0,12}ADF Database Version|" + _HDF5 + rb".*" + _CGNS), space=_BOTH,
    ),
    _format(
        "openfoam", ".foam", "OpenFOAM case: constant/polyMesh beside the .foam file, or in a given folder",
        "openfoam.write:write_grids", choices=(("ascii", "binary"), ("cyclic", "cyclicami")),
        names_patches=True, fills_folder=True,
        blocks="merged", space=_VOLUMES,
    ),
    _format(
        "geo", ".geo", "Gmsh geometry: outer edges are transfinite curves, patches are physical groups",
        "gmsh.geo:write_grids", names_patches=True, blocks="merged",
    ),
    _format(
        "nmf", ".nmf", "NASA neutral map file: boundary conditions and interfaces of Plot3D blocks",
        "plot3d.nmf:write_grids", names_patches=True, blocks="kept", space=_BOTH,
    ),
    _format(
        "su2", ".su2", "SU2 mesh (text); patches are markers; only the boundary is read",
        "su2:read_shapes su2:write_grids", sniff=partial(holds, (b"NDIME", b"=")),
        names_patches=True, blocks="merged", space=_VOLUMES,
    ),
    _format(
        "plot3d", ".p3d .xyz .fmt .x .dat .bin .ufmt .unf",
        "Plot3D: text, C binary (.bin) or Fortran records (.ufmt), and a .nmf file",
        "plot3d.read:read_grids plot3d.write:write_grids plot3d:sniff",
        blocks="kept", many=True, choices=CHOICES, reads_options=True, space=_BOTH,
        suffix_options={".bin": "binary", ".ufmt": "fortran", ".unf": "fortran"},
    ),
    _format(
        "dxf", ".dxf", "DXF drawing; layers are names (needs the extra dxf)", "outlines.dxf:read_shapes",
        sniff=partial(begins, rb"\s*0\s+SECTION\s|AutoCAD Binary DXF"), many=True,
    ),
    _format(
        "step", ".step .stp", "STEP file; faces become patches of a surface (needs the extra cad)", "",
        read_shapes=partial(later, "meshonet.formats.cad.read:read_models", kind="STEP"),
        sniff=partial(begins, rb"\s*ISO-10303-21"),
    ),
    _format(
        "brep", ".brep .brp", "B-rep file of Open Cascade, treated as STEP", "",
        read_shapes=partial(later, "meshonet.formats.cad.read:read_models", kind="B-rep"),
        sniff=partial(begins, rb"\s*(DBRep_DrawableShape|CASCADE Topology)"),
    ),
    _format(
        "wkt", ".wkt", "outlines as well-known text", "", sniff=partial(begins, _WKT), many=True,
        read_shapes=partial(later, "meshonet.formats.outlines.vector:read_wkt"),
    ),
    _format(
        "layout", ".json", "layout of blocks as JSON; read as a coarse grid or as a domain",
        "layout.read:read_shapes layout.read:read_grids layout.write:write_layouts",
        sniff=partial(holds, (b'"meshonet-layout"',)), names_patches=True,
    ),
    _format(
        "geojson", ".geojson .json", "outlines as GeoJSON", "", sniff=partial(begins, rb'\s*\{.*"type"'),
        read_shapes=partial(later, "meshonet.formats.outlines.vector:read_geojson"), many=True,
    ),
    _format(
        "airfoil", ".dat", "airfoil coordinates, Selig or Lednicer",
        "text.airfoil_dat:read_shapes text.airfoil_dat:sniff",
    ),
    _format(
        "points", ".csv .txt .xy", "points of a closed curve or of four edges",
        "text.points:read_shapes text.points:sniff",
    ),
    _format("png", ".png", "picture of a grid", "", write_grids=partial(later, _DRAW, kind="png")),
    _format(
        "svg", ".svg", "vector graphics of a grid; read as outlines, ids are names",
        "outlines.svg:read_shapes", write_grids=partial(later, _DRAW, kind="svg"), many=True,
        sniff=partial(holds, (b"<svg",)),
    ),
    _format(
        "html", ".html .htm", "interactive page of a grid, for browsers", "figure.page.page:write_grids",
        blocks="kept", space=_BOTH,
    ),
    _format(
        "pdf", ".pdf", "vector graphics of a grid", "",
        write_grids=partial(later, _DRAW, kind="pdf"),
    ),
    _format(
        "meshio", " ".join(_MESHIO), "formats of viewers and of solid mechanics, without patches",
        "meshio_export:write_grids", blocks="merged", suffix_options=_MESHIO,
        choices=(tuple(dict.fromkeys(_MESHIO.values())),),
    ),
)  # fmt: skip

TABLE: dict[str, Format] = {}  # formats by name
BY_SUFFIX: dict[str, list[Format]] = {}
"""Formats by extension: the first that can write is used, and the first that recognises the content, else the
last.
"""
for _record in _FORMATS:
    TABLE[_record.name] = _record
    for _suffix in _record.suffixes:
        BY_SUFFIX.setdefault(_suffix, []).append(_record)
