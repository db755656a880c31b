"""CGNS structured zones in HDF5, ``.cgns``: boundary conditions, families, the cut joined one to one.

Written so that libraries from 3.4 on read it. Topology, name, parts and provenance are Descriptor_t
nodes of the zone, which others pass over.
https://cgns.org/standard/SIDS/SIDS.html
"""

from collections.abc import Iterable, Iterator
from itertools import chain
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.cgns.nodes import NAME_LENGTH, Node, child, root
from meshonet.formats.format import Heights, at_least_one
from meshonet.formats.hdf5.file import created
from meshonet.formats.mesh.metadata import facts_of
from meshonet.formats.mesh.names import kinds, words
from meshonet.geometry.arrays import Floats, Side
from meshonet.geometry.blocks.block import PLACES
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Kind

Integers = NDArray[np.int32]

_CONDITIONS: dict[Kind, str] = {
    "wall": "BCWall", "farfield": "BCFarfield", "inlet": "BCInflow", "outlet": "BCOutflow",
    "symmetry": "BCSymmetryPlane",
}  # fmt: skip
_METRE = np.array([0, 1, 0, 0, 0], np.float64)
"""Exponents of mass, length, time, temperature and angle in a coordinate."""


def write_grids(path: Path, grids: Iterable[Grid], heights: Heights = ()) -> None:
    """Write one zone for each grid: of two dimensions, or with `heights` of three, repeated in z."""
    rest = iter(grids)
    first = at_least_one(rest)
    dimension = 3 if heights else 2
    with created(path, track_order=True, libver=("earliest", "v108")) as file:
        base = child(root(file), "Base", "CGNSBase_t", np.full(2, dimension, np.int32))
        child(base, "DataClass", "DataClass_t", "NormalizedByUnknownDimensional")
        zones: set[str] = set()
        families: dict[str, Kind] = {}
        for grid in chain([first], rest):
            title = grid.name or "Zone"
            zone = words([title], NAME_LENGTH, {"DataClass", *zones, *families})[title]
            zones.add(zone)
            role = _write_zone(base, zone, grid, heights, zones)
            families = {**role, **families}
        for family, kind in families.items():
            node = child(base, family, "Family_t")
            child(node, "FamilyBC", "FamilyBC_t", _CONDITIONS.get(kind, "BCGeneral"))


def _write_zone(base: Node, name: str, grid: Grid, heights: Heights, zones: set[str]) -> dict[str, Kind]:
    """Add a zone and return the families of its parts, called otherwise than all `zones`."""
    dims = [grid.ni, grid.nj, len(heights)][: 3 if heights else 2]
    size = np.array([dims, [n - 1 for n in dims], [0] * len(dims)], np.int32)
    zone = child(base, name, "Zone_t", size)
    child(zone, "ZoneType", "ZoneType_t", "Structured")
    for fact, texts in facts_of(grid).items():
        child(zone, fact, "Descriptor_t", "\n".join(texts))
    coordinates = child(zone, "GridCoordinates", "GridCoordinates_t")
    for axis, values in enumerate(_coordinates(grid, heights)):
        node = child(coordinates, f"Coordinate{'XYZ'[axis]}", "DataArray_t", values)
        child(node, "DimensionalExponents", "DimensionalExponents_t", _METRE)
    _write_connections(zone, name, grid, len(heights))
    return _write_conditions(zone, grid, len(heights), zones)


def _coordinates(grid: Grid, heights: Heights) -> Iterator[Floats]:
    """Yield x, y[, z] as (nj, ni) or (nk, nj, ni)."""
    for values in (grid.x.T, grid.y.T):
        yield np.stack([values] * len(heights)) if heights else np.ascontiguousarray(values)
    if heights:
        yield np.broadcast_to(np.array(heights)[:, None, None], (len(heights), grid.nj, grid.ni)).copy()


def _write_conditions(zone: Node, grid: Grid, planes: int, zones: set[str]) -> dict[str, Kind]:
    """Add a boundary condition for each outer stretch and, of a layer, for its two planes."""
    patches = grid.outer_patches()
    role = kinds(grid, patches)
    ranges = [(p.name, _range(p.side, p.start, p.stop, grid, planes)) for p in patches]
    for plane, k in (("back", 1), ("front", planes))[:planes]:
        role.setdefault(plane, "symmetry")
        ranges.append((plane, np.array([[1, 1, k], [grid.ni, grid.nj, k]], np.int32)))
    family = words(role, NAME_LENGTH, {"DataClass", *zones})
    node = child(zone, "ZoneBC", "ZoneBC_t")
    taken: set[str] = set()
    for name, span in ranges:
        word = words([name], NAME_LENGTH, taken)[name]
        taken.add(word)
        condition = child(node, word, "BC_t", "FamilySpecified")
        child(condition, "PointRange", "IndexRange_t", span)
        child(condition, "FamilyName", "FamilyName_t", family[name])
    return {family[name]: role[name] for name in role}


def _write_connections(zone: Node, name: str, grid: Grid, planes: int) -> None:
    """Join the two sides of each connection of the block to itself, once from each."""
    if not grid.connections:
        return
    node = child(zone, "ZoneGridConnectivity", "ZoneGridConnectivity_t")
    count = 0
    for connection in grid.connections:
        (along,) = connection.orientation
        first, second = connection.stretches(0)
        for own, donor in ((first, second), (second, first)):
            count += 1
            joint = child(node, f"Cut{count}", "GridConnectivity1to1_t", name)
            (side, *ends), across = donor, PLACES[own[0]]
            start, stop = ends[::along]
            child(joint, "PointRange", "IndexRange_t", _range(*own, grid, planes))
            child(joint, "PointRangeDonor", "IndexRange_t", _range(side, start, stop, grid, planes))
            transform = np.array([along, along, 3], np.int32)[: 3 if planes else 2]
            transform[across[0]] = -1 if across[1] == PLACES[side][1] else 1
            transform[:2] *= [1, 2]
            child(joint, "Transform", '"int[IndexDimension]"', transform)


def _range(side: Side, first: int, last: int, grid: Grid, planes: int) -> Integers:
    """Return the first and the last node (2, 2 or 3) of a stretch, counted from 1."""
    i, j = (1 if side == "west" else grid.ni), (1 if side == "south" else grid.nj)
    ends = [[k + 1, j] if side in ("south", "north") else [i, k + 1] for k in (first, last)]
    return np.array([[*ends[0], 1], [*ends[1], planes]] if planes else ends, np.int32)
