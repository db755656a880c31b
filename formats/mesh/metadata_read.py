"""Restores grids from nodes and the texts that `meshonet.formats.mesh.metadata` makes."""

import json
from collections.abc import Sequence
from dataclasses import replace
from operator import itemgetter
from typing import Any, get_args

import numpy as np

from meshonet.formats.mesh.axis_order import nodes_of
from meshonet.formats.mesh.metadata import Facts
from meshonet.formats.mesh.recover_topology import known_topology, recovered, usable
from meshonet.formats.mesh.slices import planar
from meshonet.formats.source import printable
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import Block, Range
from meshonet.geometry.blocks.connection import Connection, check_connections
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.blocks.patches import Kind, Patch
from meshonet.geometry.blocks.shared_nodes import with_equal_nodes
from meshonet.geometry.errors import InputError


def number_of_grid(facts: Facts) -> int | None:
    """Return the number of the grid that a block belongs to, from its metadata `facts`; None: not stored."""
    words = facts["block"][0].split() if facts.get("block") else []
    return int(words[0]) if len(words) == 2 and all(w.isdecimal() and len(w) < 9 for w in words) else None


def says_in_space(facts: Facts) -> bool:
    """Return whether metadata (`facts`) describe a three-dimensional block."""
    return list(facts.get("coordinates", ())) == ["3"]


def nodes_by_facts(coordinates: Sequence[Floats], facts: Facts) -> Floats:
    """Return the nodes of a block from x, y[, z], each (n1, n2, n3); `facts` are its metadata.

    Raises InputError if the block is not planar and its metadata do not say that it is in 3-D.
    """
    if not says_in_space(facts):
        return planar(coordinates)
    return nodes_of([np.squeeze(values) for values in coordinates])


def grid_of_blocks(blocks: Sequence[tuple[Floats, Facts]], name: str = "") -> Grid:
    """Return the grid of blocks given in any order, each by its nodes and its metadata.

    Raises InputError if a block is missing or repeated, or if the connections do not match the nodes.
    """
    rows = sorted(
        ((int(facts["block"][0].split()[1]), nodes, facts) for nodes, facts in blocks), key=itemgetter(0)
    )
    if [k for k, _, _ in rows] != list(range(len(rows))):
        problem = f"has blocks {', '.join(str(k) for k, _, _ in rows[:9])} of a grid"
        raise InputError(problem, "keep all blocks of the grid in the file, once")
    return _grid([(nodes, facts) for _, nodes, facts in rows], name)


def _grid(blocks: Sequence[tuple[Floats, Facts]], name: str) -> Grid:
    facts = blocks[0][1]
    name = printable(facts["name"][0]) if facts.get("name") else name
    connections = connections_from(facts["connections"][0]) if facts.get("connections") else ()
    patches = (replace(patch, block=k) for k, (_, own) in enumerate(blocks) for patch in _parts(own))
    made = tuple(Block(usable(nodes), finite=True) for nodes, _ in blocks)
    check_connections(connections, [block.counts for block in made])
    made = with_equal_nodes(made, connections)
    return Grid(made, tuple(patches), connections, name, _provenance(facts))


def grid_with(nodes: Floats, facts: Facts, name: str = "") -> Grid:
    """Return the grid of a block with these metadata (`facts`); `name` applies if they have no name.

    If `facts` lack the topology of a planar grid, it is found from node positions. A block of a multi-block
    grid becomes a grid without connections.
    """
    if says_in_space(facts):
        alone = number_of_grid(facts) is None
        return _grid([(nodes, facts if alone else {**facts, "connections": []})], name)
    name = printable(facts["name"][0]) if facts.get("name") else name
    if not facts.get("topology"):
        return recovered(nodes, name)
    parts = tuple(_parts(facts))
    if number_of_grid(facts) is not None:  # a block taken out of a grid of several
        return Grid.from_nodes(usable(nodes), "quad", parts, name)
    topology = known_topology(facts["topology"][0])
    return Grid.from_nodes(usable(nodes), topology, parts, name, _provenance(facts))


def _provenance(facts: Facts) -> dict[str, Any]:
    try:
        provenance = json.loads(facts["provenance"][0]) if facts.get("provenance") else {}
    except (ValueError, RecursionError):
        return {}
    return provenance if isinstance(provenance, dict) else {}


def _parts(facts: Facts) -> list[Patch]:
    """Return the patches of a block, with the kinds that the facts or the names give."""
    patches = [_part(text) for text in facts.get("parts", ())]
    spans = facts.get("across", ())
    if len(spans) == len(patches):
        patches = [replace(patch, across=_across(text)) for patch, text in zip(patches, spans, strict=True)]
    kinds: list[Any] = list(facts.get("kinds", ()))
    if len(kinds) != len(patches) or not {*kinds} <= {*get_args(Kind)}:
        return patches
    return [replace(patch, kind=kind) for patch, kind in zip(patches, kinds, strict=True)]


def _across(text: str) -> tuple[int, int] | None:
    words = text.split()
    try:
        return (int(words[0]), int(words[1])) if words else None
    except (ValueError, IndexError):
        raise InputError(f"span {text[:60]!r} is not 'first last'", "remove the field 'across'") from None


def _part(text: str) -> Patch:
    words: list[Any] = text.split(" ", 3)
    try:
        side, start, stop, name = words[0], int(words[1]), int(words[2]), words[3]
    except (ValueError, IndexError):
        problem = f"part {text[:60]!r} is not 'side start stop name'"
        raise InputError(problem, "remove the field 'parts'") from None
    return Patch(printable(name), side, start, stop)


def connections_from(text: str) -> tuple[Connection, ...]:
    """Return the connections in a JSON text that `connections_text` has made."""
    try:
        rows = json.loads(text or "[]")
        return tuple(
            Connection(
                k,
                side,
                _range(span),
                donor,
                face,
                _range(other),
                tuple(ways),
                Motion(tuple(move["shift"]), tuple(map(tuple, move["turn"]))) if move else None,
            )
            for k, side, span, donor, face, other, ways, move in rows
        )
    except (ValueError, TypeError, KeyError, RecursionError):
        raise InputError("its connections are not those of blocks", "write the dataset again") from None


def _range(span: list[list[int]]) -> Range:
    return tuple((int(first), int(last)) for first, last in span)
