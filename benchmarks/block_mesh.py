"""Transfinite grids of block structures, built as OpenFOAM's blockMesh builds them.

A structure is a dictionary, as JSON holds it::

    vertices  [[x, y], ...]
    blocks    [{"corners": [a, b, c, d], "counts": [cells along ab, cells along ad], "grading": four}, ...]
    edges     [{"type": "arc", "start": a, "end": b, "points": [[x, y]]}, ...], or "spline", "polyLine"
    patches   {name: {"type": ..., "edges": [[a, b], ...]}}

Gradings belong to ab, dc, ad and bc: the last cell over the first, or rows of part of the length, part of
the cells and grading. Corners run counter-clockwise. Nodes are blockMesh's to rounding. Source: OpenFOAM,
src/mesh/blockMesh: lineDivide.C, arcEdge.C, blockCreate.C.
"""

from typing import Any

import numpy as np

from meshonet.geometry.arrays import Floats, Side
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.find_connections import find_connections
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Kind, Patch
from meshonet.geometry.blocks.shared_nodes import with_equal_nodes
from meshonet.geometry.curves.curve import Curve

_ENDS: dict[Side, tuple[int, int]] = {"south": (0, 1), "north": (3, 2), "west": (0, 3), "east": (1, 2)}


def block_mesh(structure: dict[str, Any], name: str = "") -> Grid:
    """Return the grid of a structure, its blocks connected and its outer sides named."""
    vertices = np.array(structure["vertices"], dtype=float)
    edges = {(edge["start"], edge["end"]): edge for edge in structure.get("edges", ())}
    blocks = [Block(_nodes(block, vertices, edges)) for block in structure["blocks"]]
    connections = find_connections(blocks)
    joined = with_equal_nodes(blocks, connections)
    return Grid(joined, tuple(_patches(structure)), connections, name or structure.get("name", ""))


def _patches(structure: dict[str, Any]) -> list[Patch]:
    named = {frozenset(pair): name for name, row in structure["patches"].items() for pair in row["edges"]}
    kinds: dict[str, Kind] = {
        name: "wall" if row["type"] == "wall" else "other" for name, row in structure["patches"].items()
    }
    patches = []
    for number, block in enumerate(structure["blocks"]):
        for side, (a, b) in _ENDS.items():
            pair = frozenset((block["corners"][a], block["corners"][b]))
            if pair in named:
                cells = block["counts"][0 if side in ("south", "north") else 1]
                name = named[pair]
                patches.append(Patch(name, side, 0, cells, block=number, kind=kinds[name]))
    return patches


def _nodes(block: dict[str, Any], vertices: Floats, edges: dict[tuple[int, int], Any]) -> Floats:
    """Return the nodes (ni, nj, 2) of a block: weighted means of its straight edges, and what curves add."""
    places, off = {}, {}
    for side, grading in zip(_ENDS, block["grading"], strict=True):
        cells = block["counts"][0 if side in ("south", "north") else 1]
        a, b = (block["corners"][k] for k in _ENDS[side])
        places[side] = divisions(cells, grading)
        off[side] = _edge(a, b, places[side], vertices, edges) - _line(a, b, places[side], vertices)
    s, n = places["south"][:, None], places["north"][:, None]
    w, e = places["west"][None, :], places["east"][None, :]
    x1, x2 = (1 - s) * (1 - w) + s * (1 - e), (1 - n) * w + n * e
    y1, y2 = (1 - w) * (1 - s) + w * (1 - n), (1 - e) * s + e * n
    z = np.stack([(1 - s) * (1 - w), s * (1 - e), n * e, (1 - n) * w])
    x1, x2, y1, y2, z = x1 / (x1 + x2), x2 / (x1 + x2), y1 / (y1 + y2), y2 / (y1 + y2), z / z.sum(axis=0)
    corners = vertices[block["corners"]]
    a, b, c, d = corners
    along_x = x1[..., None] * (a + s[..., None] * (b - a)) + x2[..., None] * (d + n[..., None] * (c - d))
    along_y = y1[..., None] * (a + w[..., None] * (d - a)) + y2[..., None] * (b + e[..., None] * (c - b))
    nodes = (along_x + along_y + np.einsum("cij,cd->ijd", z, corners)) / 3
    nodes = nodes + x1[..., None] * off["south"][:, None] + x2[..., None] * off["north"][:, None]
    return np.asarray(nodes + y1[..., None] * off["west"][None] + y2[..., None] * off["east"][None])


def divisions(cells: int, grading: float | list[list[float]]) -> Floats:
    """Return the places (cells + 1,) of nodes along an edge, from 0 to 1."""
    rows = np.array([[1.0, 1.0, grading]] if np.isscalar(grading) else grading, dtype=float)
    lengths, shares = rows[:, 0] / rows[:, 0].sum(), rows[:, 1] / rows[:, 1].sum()
    counts = np.floor(shares * cells + 0.5).astype(int)
    counts[int(np.argmax(shares))] += cells - counts.sum()
    places, start = [np.zeros(1)], 0.0
    for length, count, ratio in zip(lengths, counts, rows[:, 2], strict=True):
        steps = ratio ** (np.arange(count) / max(count - 1, 1))
        places.append(start + length * np.cumsum(steps) / steps.sum())
        start += length
    nodes = np.concatenate(places)
    nodes[-1] = 1.0
    return nodes


def _line(a: int, b: int, places: Floats, vertices: Floats) -> Floats:
    return np.asarray(vertices[a] + places[:, None] * (vertices[b] - vertices[a]))


def _edge(a: int, b: int, places: Floats, vertices: Floats, edges: dict[tuple[int, int], Any]) -> Floats:
    if (a, b) not in edges and (b, a) in edges:
        return _edge(b, a, 1 - places[::-1], vertices, edges)[::-1]
    if (a, b) not in edges:
        return _line(a, b, places, vertices)
    edge = edges[a, b]
    between = np.array(edge["points"], dtype=float)
    if edge["type"] == "arc":
        return _arc(vertices[a], between[0], vertices[b], places)
    points = np.concatenate([vertices[a : a + 1], between, vertices[b : b + 1]])
    straight = np.full(len(points) - 1, edge["type"] == "polyLine")
    curve = Curve(points, corners=np.arange(len(points)) if straight.all() else (), straight=straight)
    return curve.at(places * curve.length)


def _arc(first: Floats, middle: Floats, last: Floats, places: Floats) -> Floats:
    """Return points on the circle through three points, at equal angles for equal places."""
    u, v = middle - first, last - first
    cross = 2 * (u[0] * v[1] - u[1] * v[0])
    squares = np.array([u @ u, v @ v])
    centre = (
        first
        + np.array([v[1] * squares[0] - u[1] * squares[1], u[0] * squares[1] - v[0] * squares[0]]) / cross
    )
    start, through, stop = (np.arctan2(*(p - centre)[::-1]) for p in (first, middle, last))
    turn = (stop - start) % (2 * np.pi)
    turn = turn if (through - start) % (2 * np.pi) < turn else turn - 2 * np.pi
    angle = start + places * turn
    points = centre + np.hypot(*(first - centre)) * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    points[0], points[-1] = first, last
    return np.asarray(points)
