"""Reading CGNS: the structured zones of a file, blocks in the plane, of volume, or patches of a surface.

Zones that this package wrote say which grid they belong to. Of others, those that touch are one grid, be they
joined one to one in the file or found to coincide, whatever bases they are in.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from meshonet.formats.cgns.boundaries import conditions, interfaces, window_of
from meshonet.formats.cgns.nodes import Node, array, children, is_adf, text
from meshonet.formats.hdf5.check import opened
from meshonet.formats.mesh.axis_order import nodes_of
from meshonet.formats.mesh.metadata import (
    Facts,
    grid_of_blocks,
    grid_with,
    number_of_grid,
    says_in_space,
)
from meshonet.formats.mesh.slices import planar
from meshonet.formats.mesh.structured import FileBlock, grids_of_file
from meshonet.formats.mesh.windows import Face, Pair, Triple
from meshonet.formats.source import Source, printable
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError, in_place

_FACTS = ("topology", "name", "parts", "kinds", "provenance", "block", "connections", "across", "coordinates")
_MOST_NODES = 1 << 40


class _Zone(NamedTuple):
    """A structured zone: base, node, name, what this package wrote of it, and x, y[, z] (ni, nj, nk) each."""

    base: Node
    node: Node
    title: str
    facts: Facts
    coordinates: list[Floats]

    @property
    def path(self) -> str:
        return str(self.node.name)

    @property
    def counts(self) -> Triple:
        """Nodes along the three indices, 1 along one that the zone has not."""
        ni, nj, nk = self.coordinates[0].shape
        return ni, nj, nk

    @property
    def nodes(self) -> Floats:
        """Nodes of a zone of this package's, in the plane or in space."""
        if not says_in_space(self.facts):
            return planar(self.coordinates)
        return nodes_of([np.squeeze(values) for values in self.coordinates])


def read_grids(source: Source) -> Iterator[Grid]:
    """Yield the grids of the structured zones, each named by its zone when the file has several.

    Parts are those that this package wrote, or else the boundary conditions, called by their families.

    Raises InputError: a container of the old kind, no HDF5, no structured zone, a zone that is not right.
    """
    if is_adf(source.head(64)):
        raise InputError("is CGNS in an ADF container", "turn it into HDF5: adf2hdf OLD.cgns NEW.cgns")
    with opened(source) as file:
        zones = [
            (base, name, zone)
            for _, base in children(file, "CGNSBase_t")
            for name, zone in children(base, "Zone_t")
        ]
        structured = [item for item in zones if _kind(item[2]) == "Structured"]
        if not structured:
            problem = "its zones are unstructured" if zones else "holds no CGNS zone"
            raise InputError(problem, "give a CGNS file with a structured zone")
        if any("topology" not in _facts(zone) for _, _, zone in structured):
            yield from _foreign([_zone(*item) for item in structured], source.stem)
        else:
            yield from _own(structured, source.stem)


def _own(structured: Sequence[tuple[Node, str, Node]], stem: str) -> Iterator[Grid]:
    """Yield the grids of zones that this package wrote; those of one block as they come."""
    groups: dict[object, list[tuple[Node, str, Node]]] = {}
    for item in structured:
        number = number_of_grid(_facts(item[2]))
        groups.setdefault(item[1] if number is None else number, []).append(item)
    for items in groups.values():
        read = [_zone(*item) for item in items]
        if number_of_grid(read[0].facts) is not None:
            yield grid_of_blocks([(zone.nodes, zone.facts) for zone in read], stem)
            continue
        for zone in read:
            with in_place(f"zone {zone.title!r}"):
                yield grid_with(zone.nodes, zone.facts, zone.title if len(structured) > 1 else stem)


def _foreign(zones: Sequence[_Zone], stem: str) -> Iterator[Grid]:
    """Yield the grids of zones that others wrote."""
    blocks, faces, pairs = [], list[Face](), list[Pair]()
    numbers = {zone.path: k for k, zone in enumerate(zones)}
    for k, zone in enumerate(zones):
        place = f"zone {zone.title!r}"
        with in_place(place):
            blocks.append(FileBlock(zone.coordinates, zone.title, place))
            faces += conditions(zone.base, zone.node, zone.counts, k)
            for title, own, path, points, partner in interfaces(zone.base, zone.node, zone.counts, k):
                donor = numbers.get(path)
                if donor is None:
                    continue
                end = window_of(donor, points, zones[donor].counts)
                if end is None:
                    raise InputError(f"interface {title!r} leaves its donor", "correct its PointRangeDonor")
                pairs.append(Pair(own, end, partner, title))
    yield from grids_of_file(blocks, faces, pairs, stem)


def _zone(base: Node, name: str, node: Node) -> _Zone:
    with in_place(f"zone {printable(name)!r}"):
        return _Zone(base, node, printable(name), _facts(node), _coordinates(node))


def _facts(zone: Node) -> Facts:
    return {
        label: text(node).split("\n") for label, node in children(zone, "Descriptor_t") if label in _FACTS
    }


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
        named = ", ".join(sorted(printable(name) for name in arrays)[:6])
        rest = f", only {named}" if named else ""
        raise InputError(f"has no CoordinateX and CoordinateY{rest}", "write Cartesian coordinates")
    return coordinates


def _kind(zone: Node) -> str:
    return next((text(node) for _, node in children(zone, "ZoneType_t")), "Structured")
