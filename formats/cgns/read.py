"""Structured zones of CGNS files as planar blocks, blocks of volumes, or patches of surfaces.

Zones of this package name their grid. Other zones form one grid if interfaces or equal nodes connect them.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from meshonet.formats.cgns.boundaries import conditions, interfaces, window_of
from meshonet.formats.cgns.nodes import Node, array, children, text
from meshonet.formats.hdf5.check import opened
from meshonet.formats.mesh.metadata import Facts
from meshonet.formats.mesh.metadata_read import number_of_grid
from meshonet.formats.mesh.structured import FileBlock, described_grids, grids_of_file
from meshonet.formats.mesh.windows import Face, Pair
from meshonet.formats.source import Source, printable
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError, in_place

_FACTS = ("topology", "name", "parts", "kinds", "provenance", "block", "connections", "across", "coordinates")
"""Descriptors of a zone that this package writes (`meshonet.formats.mesh.metadata.facts_of`)."""
_MOST_NODES = 1 << 40  # largest plausible number of nodes of a zone; their coordinates would take 24 TB


@dataclass(frozen=True)
class _Zone:
    """A structured zone: the CGNS node of its base, its own node, and its name."""

    base: Node
    node: Node
    title: str

    def block(self, name: str) -> FileBlock:
        """Return the coordinates and metadata of the zone as a block called `name`."""
        place = f"zone {self.title!r}"
        with in_place(place):
            return FileBlock(_coordinates(self.node), name, place, facts=self.facts)

    @cached_property
    def facts(self) -> Facts:
        """The metadata of the zone."""
        return _facts(self.node)


def read_grids(source: Source) -> Iterator[Grid]:
    """Yield the grids of the structured zones of a CGNS file; several grids are named after their zones.

    If meshonet did not write the file, the boundary conditions become patches, named after their families.
    Raises InputError if the file is ADF or not HDF5, has no structured zone, or has an invalid zone.
    """
    if b"ADF Database Version" in source.head(32):
        raise InputError("is CGNS in an ADF container", "turn it into HDF5: adf2hdf OLD.cgns NEW.cgns")
    with opened(source) as file:
        zones = [
            _Zone(base, node, printable(name))
            for _, base in children(file, "CGNSBase_t")
            for name, node in children(base, "Zone_t")
        ]
        structured = [
            zone
            for zone in zones
            if all(text(kind) == "Structured" for _, kind in children(zone.node, "ZoneType_t"))
        ]
        if not structured:
            problem = "its zones are unstructured" if zones else "holds no CGNS zone"
            raise InputError(problem, "give a CGNS file with a structured zone")
        if any("topology" not in zone.facts for zone in structured):
            yield from _foreign(structured, source.stem)
            return
        groups: dict[object, list[_Zone]] = {}
        for zone in structured:
            number = number_of_grid(zone.facts)
            groups.setdefault(zone.title if number is None else number, []).append(zone)
        ordered = (zone for group in groups.values() for zone in group)
        blocks = (zone.block(zone.title if len(structured) > 1 else source.stem) for zone in ordered)
        yield from described_grids(blocks, source.stem)


def _foreign(zones: Sequence[_Zone], stem: str) -> Iterator[Grid]:
    """Yield the grids of zones that other programs wrote."""
    faces, pairs = list[Face](), list[Pair]()
    blocks = [zone.block(zone.title) for zone in zones]
    counts: list[Any] = [block.coordinates[0].shape for block in blocks]
    numbers = {str(zone.node.name): k for k, zone in enumerate(zones)}
    for k, (zone, block) in enumerate(zip(zones, blocks, strict=True)):
        with in_place(block.place):
            faces += conditions(zone.base, zone.node, counts[k], k)
            for title, own, path, points, partner in interfaces(zone.base, zone.node, counts[k], k):
                donor = numbers.get(path)
                if donor is None:
                    continue
                end = window_of(donor, points, counts[donor])
                if end is None:
                    raise InputError(f"interface {title!r} leaves its donor", "correct its PointRangeDonor")
                pairs.append(Pair(own, end, partner, title))
    yield from grids_of_file(blocks, faces, pairs, stem)


def _facts(zone: Node) -> Facts:
    return {
        label: text(node).split("\n") for label, node in children(zone, "Descriptor_t") if label in _FACTS
    }


def _coordinates(zone: Node) -> list[Floats]:
    """Return x, y[, z] as arrays (ni, nj, nk), checked against the size of the zone."""
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
        named = ", ".join(sorted(printable(name) for name in arrays)[:6])
        rest = f", only {named}" if named else ""
        raise InputError(f"has no CoordinateX and CoordinateY{rest}", "write Cartesian coordinates")
    return coordinates
