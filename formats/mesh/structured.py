"""Structured blocks of a file, with what it says of their faces, as grids in the plane or in space."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from meshonet.formats.mesh.gather import Joint, Piece, Stretch, grids_of
from meshonet.formats.mesh.gather_space import grids_in_space
from meshonet.formats.mesh.metadata import Facts, grid_with, nodes_by_facts
from meshonet.formats.mesh.recover_topology import usable
from meshonet.formats.mesh.slices import Lattice, lattices
from meshonet.formats.mesh.windows import Face, Pair, Part, connection_of, part_of, patch_of
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError, in_place


@dataclass(frozen=True)
class FileBlock:
    """A block of a file: x, y[, z], each (n1, n2, n3), of any number type, its name, its place in messages.

    `iblank` says how many nodes have which mark, where there are marks.
    """

    coordinates: Sequence[Floats]
    name: str = ""
    place: str = ""
    iblank: Mapping[str, int] = field(default_factory=dict)


def grids_of_file(
    blocks: Sequence[FileBlock], faces: Sequence[Face], pairs: Sequence[Pair], name: str
) -> Iterator[Grid]:
    """Yield the grids of the blocks of a file called `name`, by the rule of `meshonet.formats.mesh.slices`.

    Blocks that touch are one grid, and so are all patches of surface; each of the others is one by itself.

    Raises InputError: a block without cells, nodes that are not usable, pairs that do not lie on each other.
    """
    if not blocks:
        return
    read = lattices([block.coordinates for block in blocks], [block.place for block in blocks])
    for lattice, block in zip(read, blocks, strict=True):
        with in_place(block.place):
            usable(lattice.nodes)
    patches: list[list[Patch]] = [[] for _ in blocks]
    for face in faces:
        patch = patch_of(face, read)
        if patch is not None:
            patches[patch.block].append(patch)
    pieces = [
        Piece(lattice.nodes, block.name, tuple(own), block.iblank)
        for lattice, block, own in zip(read, blocks, patches, strict=True)
    ]
    if read[0].nodes.shape[-1] == 2:
        yield from grids_of(pieces, list(_joints(pairs, read)), name)
        return
    connections = [_connected(pair, read) for pair in pairs]
    yield from grids_in_space(pieces, [each for each in connections if each], name)


def grid_of_block(coordinates: Sequence[Floats], facts: Facts, name: str) -> Grid:
    """Return the grid of a file of one block, by its facts where it has any.

    Raises InputError: as `grids_of_file`; facts that do not fit.
    """
    if facts.get("topology"):
        return grid_with(nodes_by_facts(coordinates, facts), facts, name)
    (lattice,) = lattices([coordinates])
    if lattice.nodes.shape[-1] == 2:
        return grid_with(lattice.nodes, facts, name)
    (grid,) = grids_in_space([Piece(usable(lattice.nodes))], (), name)
    return grid


def _connected(pair: Pair, read: Sequence[Lattice]) -> Connection | None:
    try:
        return connection_of(pair, read)
    except ValueError:
        ends = " to ".join(f"block {window.block}" for window in (pair.own, pair.donor))
        problem = f"interface {pair.name!r} of {ends} joins indices that do not lie on each other"
        raise InputError(problem, "correct its ranges and its transform") from None


def _joints(pairs: Sequence[Pair], read: Sequence[Lattice]) -> Iterator[Joint]:
    """Yield what is joined of plane blocks; each runs along an interface against the other."""
    for pair in pairs:
        own, donor = part_of(pair.own, read), part_of(pair.donor, read)
        if own and donor:
            yield Joint(_stretch(pair.own.block, own), _stretch(pair.donor.block, donor), pair.name)


def _stretch(block: int, part: Part) -> Stretch:
    return block, part.side, *part.range[0]
