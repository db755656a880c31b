"""A structured grid: blocks, where they are connected, and the names of what is left of their sides.

::

    o: i runs clockwise around the body from the trailing edge: lower side, leading edge, upper side; south
       is the body, north the far field; west is connected to east, so that column ni-1 is column 0.
    c: south is wake, body, wake; the first wake is connected to the second, reversed.

Nodes are ``[i, j] = (x, y)`` at (xi_i, eta_j); a valid grid is right-handed: every corner of every cell
has a positive Jacobian. `meshonet.geometry.blocks.block` draws the sides.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from meshonet.above import ABOVE
from meshonet.geometry.arrays import Floats, Side, Topology
from meshonet.geometry.blocks.block import Block, Form, Range, check_alike, face_of, form_of, part_of
from meshonet.geometry.blocks.connection import (
    Connected,
    Connection,
    check_connections,
    connections_of,
    topology_of,
    wake_cells,
)
from meshonet.geometry.blocks.patches import Patch, check_patches, default_patches
from meshonet.geometry.errors import InputError

if TYPE_CHECKING:
    from meshonet.geometry.summary import Quality


_COUNTS = attrgetter("counts")


@dataclass(frozen=True)
class Origin:
    """Names and values of the numbers that made a sample, and ``train``, ``test`` or nothing."""

    parameters: tuple[tuple[str, float], ...] = ()
    split: str = ""


UNKNOWN = Origin()
"""Of a sample that no dataset holds."""


@dataclass(frozen=True, eq=False, repr=False)
class Grid(Connected):
    """At least one block, named stretches of the sides, and where sides are the same nodes; validates itself.

    Parameters
    ----------
    blocks : tuple of Block
        Arrays of nodes: (ni, nj, 2) in the plane, (ni, nj, 3) on a surface, (ni, nj, nk, 3) in space.
    patches : tuple of Patch, optional
        Named stretches of the outer sides.
    connections : tuple of Connection, optional
        Sides that are the same nodes.
    name : str, optional
        What the input called the shape.
    provenance : dict, optional
        How the grid was made: method, settings, version.
    origin : Origin, optional
        Origin of its boundary, of a sample of a dataset.

    Raises
    ------
    InputError
        No block; a patch outside its side; connected sides whose nodes differ.
    """

    blocks: tuple[Block, ...]
    patches: tuple[Patch, ...] = ()
    connections: tuple[Connection, ...] = ()
    name: str = ""
    provenance: Mapping[str, Any] = field(default_factory=dict)
    origin: Origin = UNKNOWN

    def __post_init__(self) -> None:
        if not self.blocks:
            raise InputError("a grid without blocks", "give at least one")
        if len(self.blocks) > 1:
            check_alike(self.blocks)
        counts = list(map(_COUNTS, self.blocks))
        check_patches(self.patches, counts)
        check_connections(self.connections, counts)
        for connection in self.connections:
            connection.check(self.face)

    @classmethod
    def from_nodes(
        cls,
        nodes: Floats,
        topology: Topology = "quad",
        patches: tuple[Patch, ...] = (),
        name: str = "",
        provenance: Mapping[str, Any] | None = None,
        origin: Origin = UNKNOWN,
        *,
        finite: bool = False,
    ) -> Grid:
        """Return the grid of a single block (see `Block`), its connections found in the nodes.

        The wake of a ``c`` is where the south side lies on itself; no `patches` means `default_patches`.

        Returns
        -------
        Grid
            The grid of a single block (see `Block`), its connections found in the nodes.

        Raises
        ------
        InputError
            See `Block`; an O grid that is not closed, a C grid without a wake.
        """
        block = Block(nodes, finite)
        ni, nj = block.counts[:2]
        if form_of(block.nodes) == "volume":
            from meshonet.geometry.blocks.outer_patches import outer_patches

            named = tuple(patches) or tuple(outer_patches((), block.counts, ()))
            return cls((block,), named, (), name, provenance or {}, origin)
        if topology == "o" and not np.array_equal(block.nodes[0], block.nodes[-1]):
            j = int(np.argmax((block.nodes[0] != block.nodes[-1]).any(axis=-1)))
            open_at = f"column ni-1 differs from column 0 at j={j}"
            raise InputError(open_at, "close the O grid or call it quad")
        connections = connections_of(topology, block.nodes[:, 0], nj)
        named = tuple(patches) or default_patches(topology, ni, nj, wake_cells(connections))
        return cls((block,), named, connections, name, provenance or {}, origin)

    @cached_property
    def topology(self) -> Topology:  # type: ignore[override]
        """``quad``, ``o`` or ``c`` for a single planar block connected in that way, else ``blocks``."""
        if self.form != "plane":
            return "blocks"
        return topology_of(list(map(_COUNTS, self.blocks)), self.connections)

    @property
    def form(self) -> Form:
        """``plane`` of blocks (ni, nj, 2), ``surface`` of (ni, nj, 3), ``volume`` of (ni, nj, nk, 3)."""
        return form_of(self.blocks[0].nodes)

    @cached_property
    def nodes(self) -> Floats:
        """(ni, nj, 2) nodes of the only block."""
        if len(self.blocks) != 1:
            remedy = "take the nodes of its blocks one by one"
            raise InputError(f"a grid of {len(self.blocks)} blocks", remedy)
        return self.blocks[0].nodes

    @property
    def ni(self) -> int:
        """Nodes of the only block along xi."""
        return int(self.nodes.shape[0])

    @property
    def nj(self) -> int:
        """Nodes of the only block along eta."""
        return int(self.nodes.shape[1])

    @property
    def x(self) -> Floats:
        """(ni, nj) x coordinates, C-contiguous, a view."""
        return self.nodes[..., 0]

    @property
    def y(self) -> Floats:
        """(ni, nj) y coordinates, C-contiguous, a view."""
        return self.nodes[..., 1]

    def __repr__(self) -> str:
        sizes = ", ".join(" x ".join(map(str, block.nodes.shape[:-1])) for block in self.blocks)
        name = f"{self.name!r}, " if self.name else ""
        return f"Grid({name}{self.topology}, {sizes} nodes, patches {[p.name for p in self.patches]})"

    def face(self, block: int, side: Side) -> Floats:
        """Return the nodes of a side of a block."""
        return face_of(self.blocks[block].nodes, side)

    def at(self, patch: Patch) -> Floats:
        """Return the nodes (n, d) or (n, m, d) of a patch."""
        face = self.face(patch.block, patch.side)
        return part_of(face, patch.range(face.shape[:-1]))

    @cached_property
    def box(self) -> tuple[Floats, Floats]:
        """Lowest and highest coordinates (d,) of all nodes."""
        axes = tuple(range(self.blocks[0].nodes.ndim - 1))
        low = np.min([block.nodes.min(axis=axes) for block in self.blocks], axis=0)
        return low, np.max([block.nodes.max(axis=axes) for block in self.blocks], axis=0)

    def outer_patches(self) -> list[Patch]:
        """Return the outer boundary, each cell at it in one patch (`outer_patches`)."""
        from meshonet.geometry.blocks.outer_patches import outer_patches

        named: list[list[Patch]] = [[] for _ in self.blocks]
        for patch in self.patches:
            named[patch.block].append(patch)
        inside = self.joined_ranges()
        outer: list[Patch] = []
        for number, block in enumerate(self.blocks):
            outer += outer_patches(named[number], block.counts, inside[number], number)
        return outer

    def joined_ranges(self) -> list[list[tuple[Side, Range]]]:
        """Return for every block the sides and ranges of nodes that are connected."""
        inside: list[list[tuple[Side, Range]]] = [[] for _ in self.blocks]
        for each in self.connections:
            for block, side, span in each.ends:
                inside[block].append((side, span))
        return inside

    def walls(self) -> list[Patch]:
        """Return patches named as walls; without these, a body's or south's and north's unnamed stretches.

        A grid of several blocks has walls only where they are named.
        """
        outer = self.outer_patches()
        body = ("south",) if self.around_body else ()
        walls = [p for p in outer if p.kind == "wall" or (p.kind == "other" and p.side in body)]
        if walls or self.around_body or self.topology == "blocks":
            return walls
        return [patch for patch in outer if patch.side in ("south", "north") and patch.kind == "other"]

    def with_nodes(self, nodes: Floats, *, finite: bool = False) -> Grid:
        """Return the same grid with other nodes (ni, nj, 2) of the same counts."""
        return replace(self, blocks=(Block(nodes, finite),))

    def with_provenance(self, **facts: Any) -> Grid:
        """Return the same grid with `facts` added to its provenance."""
        return replace(self, provenance={**self.provenance, **facts})

    def quality(self) -> Quality:
        """Return the summaries of all metrics (`meshonet.geometry.quality.measure.measure`).

        Returns
        -------
        Quality
            The summaries of all metrics (`meshonet.geometry.quality.measure.measure`).
        """
        quality: Quality = ABOVE["measure"](self)
        return quality

    def write(self, path: str | Path, *, to_format: str | None = None) -> None:
        """Write the grid to a file, whole or not at all; the ending says the format (`meshonet.write`)."""
        ABOVE["write"](self, path, to_format=to_format)

    def to_pyvista(self) -> Any:
        """Return the grid as a `pyvista.StructuredGrid`, many blocks as a `pyvista.MultiBlock` of these.

        What is in the plane has z = 0.

        Returns
        -------
        pyvista.StructuredGrid or pyvista.MultiBlock
            The grid as a `pyvista.StructuredGrid`, many blocks as a `pyvista.MultiBlock` of these.

        Raises
        ------
        InputError
            PyVista is not installed.
        """
        try:
            from pyvista import MultiBlock, StructuredGrid
        except ImportError:
            remedy = "install it: pip install 'meshonet[pyvista]'"
            raise InputError("to_pyvista needs pyvista, which is not installed", remedy) from None
        grids = [StructuredGrid(*_coordinates(block.nodes)) for block in self.blocks]
        if len(grids) == 1:
            return grids[0]
        return MultiBlock({f"block-{number}": grid for number, grid in enumerate(grids)})


def _coordinates(nodes: Floats) -> list[Floats]:
    """Return x, y, z, each (ni, nj, nk), of nodes; nk is 1 but in volumes, z 0 in the plane."""
    planes = [np.ascontiguousarray(nodes[..., axis]) for axis in range(nodes.shape[-1])]
    if form_of(nodes) == "plane":
        planes.append(np.zeros_like(planes[0]))
    return planes if form_of(nodes) == "volume" else [plane[..., None] for plane in planes]
