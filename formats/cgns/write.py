"""CGNS structured zones in HDF5, ``.cgns``, for CGNS libraries from 3.4 on; one zone per block.

Metadata are Descriptor_t nodes of the zone. https://cgns.org/standard/SIDS/SIDS.html
"""

from collections.abc import Iterable
from itertools import chain
from pathlib import Path

import numpy as np

from meshonet.formats.cgns.interfaces import range_of, write_connections
from meshonet.formats.cgns.nodes import NAME_LENGTH, VERSIONS, Node, child, root
from meshonet.formats.format import at_least_one
from meshonet.formats.hdf5.file import created
from meshonet.formats.mesh.axis_order import first_fastest
from meshonet.formats.mesh.metadata import Facts, facts_of
from meshonet.formats.mesh.names import kinds, words
from meshonet.geometry.blocks.block import face_counts
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Kind

_CONDITIONS: dict[Kind, str] = {
    "wall": "BCWall", "farfield": "BCFarfield", "inlet": "BCInflow", "outlet": "BCOutflow",
    "symmetry": "BCSymmetryPlane", "wedge": "BCAxisymmetricWedge",
}  # fmt: skip
"""CGNS's names of boundary conditions; other kinds become BCGeneral."""
_IN_MEMORY = 1 << 24  # most coordinates of multi-block grids whose file (many objects) is built in memory
_METRE = np.array([0, 1, 0, 0, 0], np.float64)
"""Exponents of mass, length, time, temperature and angle in a coordinate."""


def write_grids(path: Path, grids: Iterable[Grid]) -> None:
    """Write all grids into a CGNS file, with one zone for each block."""
    rest = iter(grids)
    first = at_least_one(rest)
    small = len(first.blocks) > 1 and sum(block.nodes.size for block in first.blocks) < _IN_MEMORY
    with created(path, in_memory=small, track_order=True, libver=VERSIONS) as file:
        top = root(file)
        bases: dict[tuple[int, int], tuple[Node, dict[str, Kind]]] = {}
        zones: set[str] = set()
        for number, grid in enumerate(chain([first], rest)):
            dimensions = grid.blocks[0].nodes.ndim - 1, grid.blocks[0].nodes.shape[-1]
            if dimensions not in bases:
                title = f"Base{len(bases) + 1}" if bases else "Base"
                made = child(top, title, "CGNSBase_t", np.array(dimensions, np.int32))
                child(made, "DataClass", "DataClass_t", "NormalizedByUnknownDimensional")
                bases[dimensions] = made, {}
            base, families = bases[dimensions]
            names = _zone_names(grid, {"DataClass", *zones, *families})
            zones |= set(names)
            nodes = [
                _write_zone(base, name, grid, k, facts_of(grid, k, number)) for k, name in enumerate(names)
            ]
            write_connections(nodes, names, grid)
            for family, kind in _write_conditions(nodes, grid, zones).items():
                families.setdefault(family, kind)
        for base, families in bases.values():
            for family, kind in families.items():
                node = child(base, family, "Family_t")
                child(node, "FamilyBC", "FamilyBC_t", _CONDITIONS.get(kind, "BCGeneral"))


def _zone_names(grid: Grid, taken: set[str]) -> list[str]:
    """Return a name for the zone of each block: that in its original file, else the grid's with a number."""
    own = grid.provenance.get("zones")
    count = len(grid.blocks)
    if (
        not isinstance(own, list | tuple)
        or len(own) != count
        or not all(isinstance(name, str) for name in own)
    ):
        title = grid.name or "Zone"
        own = [title] if count == 1 else [f"{title[: NAME_LENGTH - 5]}-{k}" for k in range(1, count + 1)]
    names: list[str] = []
    for name in own:
        names.append(words([name], NAME_LENGTH, {*taken, *names})[name])
    return names


def _write_zone(base: Node, name: str, grid: Grid, block: int, facts: Facts) -> Node:
    nodes = grid.blocks[block].nodes
    dims = nodes.shape[:-1]
    size = np.array([dims, [n - 1 for n in dims], [0] * len(dims)], np.int32)
    zone = child(base, name, "Zone_t", size)
    child(zone, "ZoneType", "ZoneType_t", "Structured")
    for fact, texts in facts.items():
        child(zone, fact, "Descriptor_t", "\n".join(texts))
    coordinates = child(zone, "GridCoordinates", "GridCoordinates_t")
    for axis in range(nodes.shape[-1]):
        values = first_fastest(nodes[..., axis], "<f8").reshape(dims[::-1])
        node = child(coordinates, f"Coordinate{'XYZ'[axis]}", "DataArray_t", values)
        child(node, "DimensionalExponents", "DimensionalExponents_t", _METRE)
    return zone


def _write_conditions(zones: list[Node], grid: Grid, names: set[str]) -> dict[str, Kind]:
    """Add a boundary condition for each part of the outer boundary; return kinds by family."""
    patches = grid.outer_patches()
    role = kinds(grid, patches)
    ranges = []
    for p in patches:
        counts = grid.blocks[p.block].counts
        ranges.append((p.block, p.name, range_of(p.side, p.range(face_counts(counts, p.side)), counts)))
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
