"""Writes layouts; every node occurs once, at a vertex, on an edge or in a face."""

import json
from collections.abc import Iterable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from meshonet.geometry.arrays import Indices
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.domain.places_on_loops import place_at
from meshonet.geometry.errors import InputError
from meshonet.geometry.layout.layout import Layout

NAME, VERSION = "meshonet-layout", 1  # format and version in the file


def write_layouts(path: Path, layouts: Iterable[Layout]) -> None:
    """Write the only block layout of `layouts` as JSON. Raises InputError if there are several."""
    first, *others = layouts
    if others:
        remedy = "write one file each ({output} 'name-{{index}}.json')"
        raise InputError(f"a file holds one layout and there are {1 + len(others)}", remedy)
    path.write_text(as_text(first), encoding="utf-8")


def as_text(layout: Layout) -> str:
    """Return a block layout as JSON, with one line for each boundary loop, vertex, edge and face."""
    parts = []
    for key, value in as_dict(layout).items():
        rows = isinstance(value, list) and value and isinstance(value[0], dict)
        text = "[\n  " + ",\n  ".join(map(_dumped, value)) + "\n ]" if rows else _dumped(value)
        parts.append(f" {json.dumps(key)}: {text}")
    return "{\n" + ",\n".join(parts) + "\n}\n"


def _dumped(value: Any) -> str:
    return json.dumps(value, allow_nan=False)


def as_dict(layout: Layout) -> dict[str, Any]:
    """Return a block layout as a dictionary for JSON; `meshonet.formats.layout` describes its keys."""
    domain = layout.mesh.domain
    drawn = _WrittenLayout(layout)
    facts: dict[str, Any] = {
        "format": NAME, "version": VERSION, "name": domain.name, "cells": layout.cells,
        "loops": [
            _loop(loop) | ({"front": True} if k in layout.fronts else {})
            for k, loop in enumerate(domain.loops)
        ],
        "vertices": [drawn.vertex(int(node)) for node in layout.vertices],
        "edges": drawn.edges, "faces": drawn.faces,
    }  # fmt: skip
    if domain.periodic:
        facts["periodic"] = [
            {name: list(value) for name, value in vars(each).items()} for each in domain.periodic
        ]
    return facts


def _loop(loop: Loop) -> dict[str, Any]:
    curve = loop.curve
    facts = {"points": curve.points.tolist(), "corners": list(loop.corners), "names": list(loop.names)}
    if curve.straight is not None and curve.straight.all():
        return facts | {"straight": True}
    straight = [] if curve.straight is None else np.flatnonzero(curve.straight).tolist()
    return facts | {"straight": straight, "kinks": curve.corner_index.tolist()}


class _WrittenLayout:
    """The edges and faces of a layout in the form of the file."""

    def __init__(self, layout: Layout) -> None:
        self.nodes, self.places, self.loops = layout.mesh.nodes, layout.mesh.places, layout.mesh.domain.loops
        vertices = layout.vertices
        self.is_vertex = np.zeros(len(self.nodes), dtype=bool)
        self.is_vertex[vertices] = True
        self.number = np.cumsum(self.is_vertex) - 1
        self.lines: list[Indices] = []
        self.known: dict[bytes, int] = {}
        sides = [self._sides(block) for block in layout.blocks]
        met = np.bincount([k if k >= 0 else -1 - k for four in sides for side in four.values() for k in side])
        self.edges = [self._edge(line, wall=met[k] == 1) for k, line in enumerate(self.lines)]
        self.faces = [
            {
                **four,
                "cells": [len(block) - 1, block.shape[1] - 1],
                "points": self.nodes[block[1:-1, 1:-1]].reshape(-1, 2).tolist(),
                "layers": int(layout.layers.get(k, 0)),
            }
            for k, (block, four) in enumerate(zip(layout.blocks, sides, strict=True))
        ]

    def vertex(self, node: int) -> dict[str, Any]:
        """Return the entry of the file for the vertex at `node`."""
        facts: dict[str, Any] = {"at": self.nodes[node].tolist()}
        loop, cells, partner = (
            int(values[node]) for values in (self.places.loop, self.places.cells, self.places.partner)
        )
        if loop >= 0:
            facts |= {"loop": loop, "place": float(place_at(self.loops[loop], self.places.arc[[node]])[0])}
        if cells:
            facts["cells"] = cells
        if partner >= 0:
            facts["partner"] = int(self.number[partner])
        return facts

    def _sides(self, block: Indices) -> dict[str, list[int]]:
        """Return the indices of the edges of each side, which is divided at vertices."""
        lines = {"south": block[:, 0], "east": block[-1], "north": block[:, -1], "west": block[0]}
        return {
            side: [self._numbered(line[a : b + 1]) for a, b in pairwise(np.flatnonzero(self.is_vertex[line]))]
            for side, line in lines.items()
        }

    def _numbered(self, line: Indices) -> int:
        same, turned = line.tobytes(), line[::-1].tobytes()
        if same in self.known:
            return self.known[same]
        if turned in self.known:
            return -1 - self.known[turned]
        self.known[same] = len(self.lines)
        self.lines.append(line)
        return len(self.lines) - 1

    def _edge(self, line: Indices, *, wall: bool) -> dict[str, Any]:
        facts: dict[str, Any] = {"vertices": self.number[line[[0, -1]]].tolist(), "cells": len(line) - 1}
        inner = line[1:-1]
        if not wall:
            return facts | {"points": self.nodes[inner].tolist()}
        loop = int(self.places.loop[line[0]])
        facts |= {"loop": loop, "places": place_at(self.loops[loop], self.places.arc[inner]).tolist()}
        partners = self.places.partner[line]
        if (partners >= 0).all():
            facts["partner"] = self._numbered(partners)
        return facts
