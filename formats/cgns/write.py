"""CGNS structured zones in HDF5, ``.cgns``: boundary conditions, families, connected sides joined one to one.

Written so that libraries from 3.4 on read it: a zone for every block. Topology, name, parts and provenance
are Descriptor_t nodes of the zone, which others pass over.
https://cgns.org/standard/SIDS/SIDS.html
"""

from collections.abc import Iterable, Iterator
from itertools import chain
from pathlib import Path

import numpy as np

from meshonet.formats.cgns.joints import write_connections
from meshonet.formats.cgns.nodes import NAME_LENGTH, Node, child, root
from meshonet.formats.cgns.ranges import range_of
from meshonet.formats.format import Heights, at_least_one
from meshonet.formats.hdf5.file import created
from meshonet.formats.mesh.metadata import facts_of
from meshonet.formats.mesh.names import kinds, words
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Kind

_CONDITIONS: dict[Kind, str] = {
    "wall": "BCWall", "farfield": "BCFarfield", "inlet": "BCInflow", "outlet": "BCOutflow",
    "symmetry": "BCSymmetryPlane",
}  # fmt: skip
_IN_MEMORY = 1 << 24
"""Numbers up to which a grid of many blocks, thousands of small objects, is put together in memory."""
_METRE = np.array([0, 1, 0, 0, 0], np.float64)
"""Exponents of mass, length, time, temperature and angle in a coordinate."""


def write_grids(path: Path, grids: Iterable[Grid], heights: Heights = ()) -> None:
    """Write one zone for each block of each grid: of two dimensions, or with `heights` of three, extruded."""
    rest = iter(grids)
    first = at_least_one(rest)
    dimension = 3 if heights else 2
    small = len(first.blocks) > 1 and sum(block.nodes.size for block in first.blocks) < _IN_MEMORY
    with created(path, in_memory=small, track_order=True, libver=("earliest", "v108")) as file:
        base = child(root(file), "Base", "CGNSBase_t", np.full(2, dimension, np.int32))
        child(base, "DataClass", "DataClass_t", "NormalizedByUnknownDimensional")
        zones: set[str] = set()
        families: dict[str, Kind] = {}
        for number, grid in enumerate(chain([first], rest)):
            names = _zone_names(grid, {"DataClass", *zones, *families})
            zones |= set(names)
            nodes = [_write_zone(base, names[k], grid, k, number, heights) for k in range(len(names))]
            write_connections(nodes, names, grid, len(heights))
            role = _write_conditions(nodes, grid, len(heights), zones)
            families = {**role, **families}
        for family, kind in families.items():
            node = child(base, family, "Family_t")
            child(node, "FamilyBC", "FamilyBC_t", _CONDITIONS.get(kind, "BCGeneral"))


def _zone_names(grid: Grid, taken: set[str]) -> list[str]:
    """Return a name for the zone of each block: those it had in its file, else the grid's, with numbers."""
    own = grid.provenance.get("zones")
    count = len(grid.blocks)
    if not isinstance(own, list) or len(own) != count or not all(isinstance(name, str) for name in own):
        title = grid.name or "Zone"
        own = [title] if count == 1 else [f"{title[: NAME_LENGTH - 5]}-{k}" for k in range(1, count + 1)]
    names: list[str] = []
    for name in own:
        names.append(words([name], NAME_LENGTH, {*taken, *names})[name])
    return names


def _write_zone(base: Node, name: str, grid: Grid, block: int, number: int, heights: Heights) -> Node:
    """Add the zone of a block of a grid, the file's `number`, and return it."""
    dims = [*grid.blocks[block].counts, len(heights)][: 3 if heights else 2]
    size = np.array([dims, [n - 1 for n in dims], [0] * len(dims)], np.int32)
    zone = child(base, name, "Zone_t", size)
    child(zone, "ZoneType", "ZoneType_t", "Structured")
    for fact, texts in facts_of(grid, block, number).items():
        child(zone, fact, "Descriptor_t", "\n".join(texts))
    coordinates = child(zone, "GridCoordinates", "GridCoordinates_t")
    for axis, values in enumerate(_coordinates(grid.blocks[block], heights)):
        node = child(coordinates, f"Coordinate{'XYZ'[axis]}", "DataArray_t", values)
        child(node, "DimensionalExponents", "DimensionalExponents_t", _METRE)
    return zone


def _coordinates(block: Block, heights: Heights) -> Iterator[Floats]:
    """Yield x, y[, z] as (nj, ni) or (nk, nj, ni)."""
    ni, nj = block.counts
    for values in (block.nodes[..., 0].T, block.nodes[..., 1].T):
        yield np.stack([values] * len(heights)) if heights else np.ascontiguousarray(values)
    if heights:
        yield np.broadcast_to(np.array(heights)[:, None, None], (len(heights), nj, ni)).copy()


def _write_conditions(zones: list[Node], grid: Grid, planes: int, names: set[str]) -> dict[str, Kind]:
    """Add a boundary condition for each outer stretch and, of layers, for their outermost planes."""
    patches = grid.outer_patches()
    role = kinds(grid, patches)
    counts = [block.counts for block in grid.blocks]
    ranges = [(p.block, p.name, range_of(p.side, p.start, p.stop, counts[p.block], planes)) for p in patches]
    for plane, k in (("back", 1), ("front", planes))[:planes]:
        role.setdefault(plane, "symmetry")
        for block, (ni, nj) in enumerate(counts):
            ranges.append((block, plane, np.array([[1, 1, k], [ni, nj, k]], np.int32)))
    family = words(role, NAME_LENGTH, {"DataClass", *names})
    conditions: dict[int, tuple[Node, set[str]]] = {}
    for block, name, span in ranges:
        if block not in conditions:
            conditions[block] = child(zones[block], "ZoneBC", "ZoneBC_t"), set()
        node, taken = conditions[block]
        word = words([name], NAME_LENGTH, taken)[name]
        taken.add(word)
        condition = child(node, word, "BC_t", "FamilySpecified")
        child(condition, "PointRange", "IndexRange_t", span)
        child(condition, "FamilyName", "FamilyName_t", family[name])
    return {family[name]: role[name] for name in role}
