"""Reading CGNS: the structured zones of a file, each a plane grid or a layer one cell thick."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from meshonet.formats.cgns.nodes import Node, array, children, is_adf, text
from meshonet.formats.hdf5.check import opened
from meshonet.formats.mesh.metadata import grid_with
from meshonet.formats.mesh.slices import planar
from meshonet.formats.source import Source, printable
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError

_FACTS = ("topology", "name", "parts", "provenance")
_MOST_NODES = 1 << 40


def read_grids(source: Source) -> Iterator[Grid]:
    """Yield the grid of every structured zone, named by its zone when the file has several.

    Parts are those that this package wrote, or the boundary conditions of the zone where its nodes are
    taken as they stand.

    Raises InputError: a container of the old kind, no HDF5, no structured zone, a zone that is not right.
    """
    if is_adf(source.head(64)):
        raise InputError("is CGNS in an ADF container", "turn it into HDF5: adf2hdf OLD.cgns NEW.cgns")
    with opened(source) as file:
        zones = [item for _, base in children(file, "CGNSBase_t") for item in children(base, "Zone_t")]
        structured = [(name, zone) for name, zone in zones if _kind(zone) == "Structured"]
        if not structured:
            problem = "its zones are unstructured" if zones else "holds no CGNS zone"
            raise InputError(problem, "give a CGNS file with a structured zone")
        for name, zone in structured:
            try:
                yield _grid(zone, printable(name) if len(structured) > 1 else source.stem)
            except InputError as error:
                error.place = error.place or f"zone {printable(name)!r}"
                raise


def _grid(zone: Node, name: str) -> Grid:
    nodes = planar(_coordinates(zone))
    facts = {
        label: text(node).split("\n") for label, node in children(zone, "Descriptor_t") if label in _FACTS
    }
    grid = grid_with(nodes, facts, name)
    if facts.get("topology") or not np.array_equal(grid.nodes, nodes):
        return grid
    return replace(grid, patches=tuple(_conditions(zone, grid)) or grid.patches)


def _coordinates(zone: Node) -> list[Floats]:
    """Return x, y[, z] as (ni, nj, nk) views of what is stored, which is checked against the zone's size."""
    size = array(zone, 2).astype(np.int64)
    if size.shape[0] != 3 or size.shape[1] not in (2, 3) or not (size[0] > 0).all():
        raise InputError(f"its size has shape {size.shape}", "write vertex, cell and boundary sizes")
    dims = tuple(int(n) for n in size[0])
    if np.prod(dims, dtype=float) > _MOST_NODES:
        raise InputError(f"its size {dims} is not plausible", "write the file again")
    arrays = dict(children(next(iter(children(zone, "GridCoordinates_t")), ("", zone))[1], "DataArray_t"))
    coordinates = []
    for label in ("CoordinateX", "CoordinateY", "CoordinateZ"):
        if label not in arrays:
            continue
        values = array(arrays[label], len(dims)).T
        if values.shape != dims:
            problem = f"{label} has {values.shape} values and the zone {dims} nodes"
            raise InputError(problem, "write the zone without rind planes")
        coordinates.append(np.asarray(values, np.float64).reshape((*dims, 1)[:3]))
    if len(coordinates) < 2:
        raise InputError("has no CoordinateX and CoordinateY", "write Cartesian coordinates")
    return coordinates


def _conditions(zone: Node, grid: Grid) -> Iterator[Patch]:
    """Yield the boundary conditions that cover a stretch of one side, called by their family."""
    for _, group in children(zone, "ZoneBC_t"):
        for name, condition in children(group, "BC_t"):
            family = next((text(node) for _, node in children(condition, "FamilyName_t")), name)
            ranges = dict(children(condition, "IndexRange_t"))
            span = array(ranges["PointRange"], 2) if "PointRange" in ranges else np.empty((0, 0))
            if span.shape not in ((2, 2), (2, 3)):
                continue
            (i0, j0), (i1, j1) = (np.sort(span, axis=0)[:, :2].astype(np.int64) - 1).tolist()
            if j0 == j1 and j0 in (0, grid.nj - 1) and 0 <= i0 < i1 < grid.ni:
                yield Patch(printable(family) or "part", "south" if j0 == 0 else "north", i0, i1)
            elif i0 == i1 and i0 in (0, grid.ni - 1) and 0 <= j0 < j1 < grid.nj:
                yield Patch(printable(family) or "part", "west" if i0 == 0 else "east", j0, j1)


def _kind(zone: Node) -> str:
    return next((text(node) for _, node in children(zone, "ZoneType_t")), "Structured")
