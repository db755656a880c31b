"""Writing Gmsh's ``.msh`` 2.2 (by meshio) and 4.1: merged seams, patches as physical groups.

https://gmsh.info/doc/texinfo/gmsh.html#MSH-file-format
"""

import struct
from collections.abc import Iterable
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple, TypeAlias

import numpy as np

from meshonet.formats.format import Options, only_one
from meshonet.formats.mesh.collapsed import refuse_collapsed
from meshonet.formats.mesh.unstructured import CELLS, Indices, unstructured, with_z
from meshonet.formats.source import printable
from meshonet.formats.text.number_table import write_rows
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion

INTERIOR = "fluid"  # name of the group of all cells
_KINDS = {2: 1, 4: 3, 8: 5}  # Gmsh's numbers of lines, quads and hexahedra by their nodes


class Link(NamedTuple):
    """A periodic patch: tag, tag of the master patch, affine map from the master, node pairs (n, 2)."""

    tag: int
    master: int
    affine: list[float]
    nodes: Indices


CellGroup: TypeAlias = "tuple[str, Indices]"  # name of a group of cells and their nodes (m, k) counted from 0


def write_grids(path: Path, grids: Iterable[Grid], *, options: Options = frozenset()) -> None:
    """Write the only grid of `grids`; its boundary elements form groups named after patches."""
    grid = only_one(grids, "a .msh file")
    refuse_collapsed(grid, "a .msh file")
    mesh = unstructured(grid)
    tags = {name: tag for tag, name in enumerate(mesh.faces, start=1)}
    links = [
        Link(tags[pair.partner], tags[pair.name], _affine(pair.motion), pair.nodes[:, ::-1])
        for pair in mesh.periodic
    ]
    inside = INTERIOR if INTERIOR not in mesh.faces else f"{INTERIOR}-cells"
    write = _write_41 if "4.1" in options else _write_22
    blocks = [*mesh.faces.items(), (inside, mesh.cells)]
    write(path, with_z(mesh.points), blocks, links, text="ascii" in options)


def _affine(motion: Motion) -> list[float]:
    """Return a motion as the 16 entries of an affine matrix (4, 4), row by row."""
    matrix = np.eye(4)
    if motion.turn:
        d = len(motion.turn)
        matrix[:d, :d] = motion.turn
    matrix[: len(motion.translation), 3] = motion.translation
    return [float(value) for value in matrix.ravel()]


def quotable(name: str) -> str:
    """Return `name` with a replacement for each character that may not stand between double quotes."""
    return printable(name).replace('"', "'")


def _write_22(path: Path, points: Floats, blocks: list[CellGroup], links: list[Link], *, text: bool) -> None:
    import meshio

    tags = [np.full(len(nodes), tag) for tag, (_, nodes) in enumerate(blocks, start=1)]
    mesh = meshio.Mesh(
        points,
        [(CELLS[nodes.shape[1]], nodes) for _, nodes in blocks],
        field_data={
            quotable(name): np.array([tag, _dimension(nodes)])
            for tag, (name, nodes) in enumerate(blocks, start=1)
        },
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        gmsh_periodic=[
            [_dimension(blocks[0][1]), (link.tag, link.master), link.affine, link.nodes] for link in links
        ]
        or None,
    )
    meshio.gmsh.write(str(path), mesh, fmt_version="2.2", binary=not text, float_fmt=".16e")


def _dimension(nodes: Indices) -> int:
    return int(nodes.shape[1]).bit_length() - 1


def _write_41(path: Path, points: Floats, blocks: list[CellGroup], links: list[Link], *, text: bool) -> None:
    """Write the patches, entities 1, 2 ... of a dimension, and the cells, entity 1 of the next."""
    dim = _dimension(blocks[-1][1])
    entities = [(dim - 1, tag, nodes) for tag, (_, nodes) in enumerate(blocks[:-1], start=1)]
    entities.append((dim, 1, blocks[-1][1]))
    with path.open("wb") as stream:
        file = _File(stream, text)
        stream.write(f"$MeshFormat\n4.1 {int(not text)} 8\n".encode())
        stream.write(b"" if text else struct.pack("<i", 1) + b"\n")
        stream.write(f"$EndMeshFormat\n$PhysicalNames\n{len(blocks)}\n".encode())
        for k, (name, nodes) in enumerate(blocks, start=1):
            stream.write(f'{_dimension(nodes)} {k} "{quotable(name)}"\n'.encode())
        stream.write(b"$EndPhysicalNames\n$Entities\n")
        _write_entities(file, points, entities)
        stream.write(b"$EndEntities\n$Nodes\n")
        count = len(points)
        file.line(("q", 1, count, 1, count))
        file.line(("i", dim, 1, 0), ("q", count))
        file.rows(np.arange(1, count + 1)[:, None])
        file.rows(points)
        stream.write(b"$EndNodes\n$Elements\n")
        total = sum(len(nodes) for _, nodes in blocks)
        file.line(("q", len(blocks), total, 1, total))
        first = 1
        for dimension, tag, nodes in entities:
            file.line(("i", dimension, tag, _KINDS[nodes.shape[1]]), ("q", len(nodes)))
            file.rows(np.column_stack([np.arange(first, first + len(nodes)), nodes + 1]))
            first += len(nodes)
        stream.write(b"$EndElements\n")
        if links:
            _write_periodic(file, dim - 1, links)


class _File(NamedTuple):
    """A file of version 4.1 being written, as text or as bytes."""

    stream: BinaryIO
    text: bool

    def line(self, *groups: tuple[Any, ...]) -> None:
        """Write a few numbers, in groups that begin with their type: ``i``, ``q`` (8 bytes) or ``d``."""
        if self.text:
            words = [f"{v:.17g}" if kind == "d" else str(v) for kind, *values in groups for v in values]
            self.stream.write(" ".join(words).encode() + b"\n")
        else:
            packed = (struct.pack(f"<{len(values)}{kind}", *values) for kind, *values in groups)
            self.stream.write(b"".join(packed))

    def rows(self, rows: Floats | Indices) -> None:
        """Write rows of numbers, integers in 8 bytes."""
        floats = rows.dtype.kind == "f"
        if self.text:
            write_rows(self.stream, " ".join(["%e" if floats else "%d"] * rows.shape[1]), rows)
        else:
            self.stream.write(np.ascontiguousarray(rows, "<f8" if floats else "<i8").data)


def _write_periodic(file: _File, dimension: int, links: list[Link]) -> None:
    file.stream.write(b"$Periodic\n")
    file.line(("q", len(links)))
    for link in links:
        file.line(("i", dimension, link.tag, link.master))
        file.line(("q", len(link.affine)), ("d", *link.affine))
        file.line(("q", len(link.nodes)))
        file.rows(link.nodes + 1)
    file.stream.write(b"$EndPeriodic\n")


def _write_entities(file: _File, points: Floats, entities: list[tuple[int, int, Indices]]) -> None:
    """Write bounding box and physical group of each entity, without its bounding entities."""
    dimensions = [dimension for dimension, _, _ in entities]
    file.line(("q", *map(dimensions.count, range(4))))
    for group, (_, tag, nodes) in enumerate(entities, start=1):
        own = points[nodes.ravel()]
        box = *own.min(axis=0).tolist(), *own.max(axis=0).tolist()
        file.line(("i", tag), ("d", *box), ("q", 1), ("i", group), ("q", 0))
