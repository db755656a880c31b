"""Topology, name, patches and provenance of a grid as texts, for formats that can store text."""

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, astuple
from typing import TypeAlias

from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import kind_of

Facts: TypeAlias = Mapping[str, Sequence[str]]  # texts by key


def facts_of(grid: Grid, block: int = 0, number: int = 0) -> dict[str, list[str]]:
    """Return topology, name, patches and provenance of a block as lists of texts by key, for `grid_with`.

    `block` is the index of the block in `grid`, `number` that of the grid in the file. Only block 0 has
    connections and provenance. The key ``parts`` has a text ``side start stop name`` for each patch. The keys
    ``kinds``, for the kinds of patches, and ``across``, for their ranges along a second direction, may be
    missing. An extruded grid has the texts of its planar grid.
    """
    space = grid.form != "plane"
    if space:
        from meshonet.geometry.blocks.extrude import plane_of_extruded

        grid = plane_of_extruded(grid) or grid
        space = grid.form != "plane"
    of_blocks = grid.topology == "blocks"
    facts: dict[str, list[str]] = {"topology": [grid.topology]}
    if grid.name:
        facts["name"] = [grid.name]
    parts: list[str] = []
    kinds: list[str] = []
    across: list[str] = []
    by_name = True
    for patch in grid.patches:
        if patch.block == block:
            parts.append(f"{patch.side} {patch.start} {patch.stop} {patch.name}")
            kinds.append(patch.kind)
            across.append(" ".join(map(str, patch.across or ())))
            by_name &= patch.kind == kind_of(patch.name)
    if parts:
        facts["parts"] = parts
    if not by_name:
        facts["kinds"] = kinds
    if any(across):
        facts["across"] = across
    if space:
        facts["coordinates"] = ["3"]
    if grid.provenance and block == 0:
        facts["provenance"] = [json.dumps(dict(grid.provenance), default=plain)]
    if of_blocks and (len(grid.blocks) > 1 or not space):
        facts["block"] = [f"{number} {block}"]
    if of_blocks and block == 0:
        facts["connections"] = [connections_text(grid.connections)]
    return facts


def plain(value: object) -> object:
    """Return a value that JSON can store: a number or lists for NumPy numbers and arrays, else text."""
    return value.tolist() if hasattr(value, "tolist") else str(value)


def connections_text(connections: Iterable[Connection]) -> str:
    """Return connections as JSON: a list of the fields of each; the last field, `transform`, may be null."""
    return json.dumps([[*astuple(c)[:-1], asdict(c.transform) if c.transform else None] for c in connections])
