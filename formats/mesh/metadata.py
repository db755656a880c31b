"""What a grid is besides its nodes, as short texts, for formats that have room for text."""

import json
from collections.abc import Mapping, Sequence
from typing import Any

from meshonet.formats.mesh.recover_topology import known_topology, recovered, usable
from meshonet.formats.source import printable
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError


def facts_of(grid: Grid) -> dict[str, list[str]]:
    """Return the topology, name, parts and provenance of `grid` as lists of texts by name.

    `grid_with` makes a grid from them. A part reads ``side start stop name``. What is empty is left out.
    """
    facts: dict[str, list[str]] = {
        "topology": [grid.topology],
        "name": [grid.name],
        "parts": [f"{part.side} {part.start} {part.stop} {part.name}" for part in grid.patches],
        "provenance": [json.dumps(dict(grid.provenance), default=plain) if grid.provenance else ""],
    }
    return {name: texts for name, texts in facts.items() if any(texts)}


def grid_with(nodes: Floats, facts: Mapping[str, Sequence[str]], name: str = "") -> Grid:
    """Return the grid of `nodes` (ni, nj, 2) and the facts of its file; without a topology it is recovered.

    `name` is its name when the facts do not say; other facts than `facts_of` makes are passed over.
    """
    name = printable(facts["name"][0]) if facts.get("name") else name
    if not facts.get("topology"):
        return recovered(nodes, name)
    parts = tuple(_part(text) for text in facts.get("parts", ()))
    try:
        provenance = json.loads(facts["provenance"][0]) if facts.get("provenance") else {}
    except (ValueError, RecursionError):
        provenance = {}
    topology = known_topology(facts["topology"][0])
    provenance = provenance if isinstance(provenance, dict) else {}
    return Grid.from_nodes(usable(nodes), topology, parts, name, provenance)


def plain(value: object) -> object:
    """Turn numpy's numbers and arrays into what JSON can say, and anything else into its text."""
    return value.tolist() if hasattr(value, "tolist") else str(value)


def _part(text: str) -> Patch:
    words: list[Any] = text.split(" ", 3)
    try:
        side, start, stop, name = words[0], int(words[1]), int(words[2]), words[3]
    except (ValueError, IndexError):
        problem = f"part {text[:60]!r} is not 'side start stop name'"
        raise InputError(problem, "remove the field 'parts'") from None
    return Patch(printable(name), side, start, stop)
