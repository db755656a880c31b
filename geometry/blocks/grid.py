"""A structured grid: blocks, their connections, and the named patches of the other parts of their sides.

::

    o: i runs clockwise around the body from the trailing edge: lower side, leading edge, upper side; south
       is the body, north the far field; west is connected to east, so that i = ni-1 and i = 0 coincide.
    c: south is wake, body, wake; the first wake part is connected to the second, in reverse order.

Nodes are ``[i, j] = (x, y)`` at (xi_i, eta_j); a valid grid is right-handed: the Jacobian is positive at
every corner of every cell. `meshonet.geometry.blocks.block` draws the sides.
"""

from __future__ import annotations

import math
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
_MOST_SHOWN = 6  # largest number of blocks whose sizes are listed in the text form of a grid


@dataclass(frozen=True)
class Origin:
    """Where a sample of a dataset comes from.

    `parameters` are shape parameters. `split` is ``train``, ``test`` or empty. `title` is the shape's own
    name, such as the first line of its file, if the sample is named otherwise; else it is empty.
    """

    parameters: tuple[tuple[str, float], ...] = ()
    split: str = ""
    title: str = ""


UNKNOWN = Origin()  # origin of a grid that is not a sample of a dataset


@dataclass(frozen=True, eq=False, repr=False)
class Grid(Connected):
    """Blocks of nodes, named boundary patches, and connections between blocks; checked on construction.

    Parameters
    ----------
    blocks : tuple of Block
        Arrays of nodes: (ni, nj, 2) in the plane, (ni, nj, 3) on a surface, (ni, nj, nk, 3) in a volume.
    patches : tuple of Patch, optional
        Named parts of the boundary.
    connections : tuple of Connection, optional
        Parts of sides that share their nodes.
    name : str, optional
        Name of the shape in the input.
    provenance : dict, optional
        How the grid was made: method, settings, version.
    origin : Origin, optional
        For a sample of a dataset: its parameters, and whether it is for training or for tests.
    notes : tuple of str, optional
        Notes of the function that made the grid, as the commands print them. They are not stored in files.

    Raises
    ------
    InputError
        No block; a patch that is longer than its side; connected sides with different nodes.
    """

    blocks: tuple[Block, ...]
    patches: tuple[Patch, ...] = ()
    connections: tuple[Connection, ...] = ()
    name: str = ""
    provenance: Mapping[str, Any] = field(default_factory=dict)
    origin: Origin = UNKNOWN
    notes: tuple[str, ...] = ()

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
        """Return the grid of a single block (see `Block`); its connections are found from its nodes.

        In the topology ``c``, the south side starts and ends with the nodes of the wake, in opposite order.
        Without `patches`, the grid gets the `default_patches`. Raises InputError: as `Block`; an O grid that
        is not closed, a C grid without a wake.
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
        """``quad``, ``o`` or ``c`` for a single planar block, by its connections; ``blocks`` otherwise."""
        if self.form != "plane":
            return "blocks"
        return topology_of(list(map(_COUNTS, self.blocks)), self.connections)

    @property
    def form(self) -> Form:
        """Form of the blocks: ``plane`` (ni, nj, 2), ``surface`` (ni, nj, 3), ``volume`` (ni, nj, nk, 3)."""
        return form_of(self.blocks[0].nodes)

    @cached_property
    def nodes(self) -> Floats:
        """Nodes of the only block: (ni, nj, 2), on a surface (ni, nj, 3), in a volume (ni, nj, nk, 3).

        Raises InputError: a grid of several blocks.
        """
        if len(self.blocks) != 1:
            remedy = "take the nodes of its blocks one by one"
            raise InputError(f"a grid of {len(self.blocks)} blocks", remedy)
        return self.blocks[0].nodes

    @property
    def ni(self) -> int:
        """Number of nodes along xi of a grid of one block. Raises InputError: several blocks."""
        return int(self.nodes.shape[0])

    @property
    def nj(self) -> int:
        """Number of nodes along eta of a grid of one block. Raises InputError: several blocks."""
        return int(self.nodes.shape[1])

    @property
    def cells(self) -> int:
        """Number of cells of all blocks."""
        return sum(block.cells for block in self.blocks)

    @property
    def x(self) -> Floats:
        """The x coordinates (ni, nj[, nk]) of the only block. Raises InputError: several blocks."""
        return self.nodes[..., 0]

    @property
    def y(self) -> Floats:
        """The y coordinates (ni, nj[, nk]) of the only block. Raises InputError: several blocks."""
        return self.nodes[..., 1]

    def __repr__(self) -> str:
        shapes = [block.nodes.shape[:-1] for block in self.blocks]
        sizes = ", ".join(" x ".join(map(str, shape)) for shape in shapes)
        if len(shapes) > _MOST_SHOWN:
            sizes = f"{len(shapes)} blocks of {sum(map(math.prod, shapes))}"
        name = f"{self.name!r}, " if self.name else ""
        names = list(dict.fromkeys(patch.name for patch in self.patches))
        return f"Grid({name}{self.topology}, {sizes} nodes, patches {names})"

    def face(self, block: int, side: Side) -> Floats:
        """Return the nodes (n, d) or (n, m, d) of a side of a block."""
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
        """Return patches that cover the outer boundary of all blocks, each cell exactly once."""
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
        """Return, for each block, the side and the index range of every part that is connected to a block."""
        inside: list[list[tuple[Side, Range]]] = [[] for _ in self.blocks]
        for each in self.connections:
            for block, side, span in each.ends:
                inside[block].append((side, span))
        return inside

    def walls(self) -> list[Patch]:
        """Return the walls: patches of kind wall and, in some grids of one block, patches of unknown kind.

        In O and C grids, patches of unknown kind on the body are walls. In a four-sided grid where no patch
        has the kind wall, patches of unknown kind on south and north are walls. The default kind of a patch
        follows from its name.
        """
        outer = self.outer_patches()
        body = ("south",) if self.around_body else ()
        walls = [p for p in outer if p.kind == "wall" or (p.kind == "other" and p.side in body)]
        if walls or self.around_body or self.topology == "blocks":
            return walls
        return [patch for patch in outer if patch.side in ("south", "north") and patch.may_be_wall]

    def with_nodes(self, nodes: Floats, *, finite: bool = False) -> Grid:
        """Return the grid of one block with other nodes of the same shape.

        With `finite` the nodes are known to be finite, and are not checked.
        """
        return replace(self, blocks=(Block(nodes, finite),))

    def with_provenance(self, **facts: Any) -> Grid:
        """Return the same grid with `facts` added to its provenance; facts that are None are removed."""
        known = {**self.provenance, **facts}
        for name, fact in facts.items():
            if fact is None:
                del known[name]
        return replace(self, provenance=known)

    def quality(self) -> Quality:
        """Return statistics of all metrics, by name (see `meshonet.geometry.quality.measure.measure`)."""
        quality: Quality = ABOVE["measure"](self)
        return quality

    def write(self, path: str | Path, *, to_format: str | None = None) -> None:
        """Write the grid to a file, in the format of the extension (see `meshonet.write`)."""
        ABOVE["write"](self, path, to_format=to_format)

    def to_pyvista(self) -> Any:
        """Return the grid as a `pyvista.StructuredGrid`, several blocks as a `pyvista.MultiBlock` of these.

        Planar grids get z = 0. Raises InputError: PyVista is not installed.
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
    """Return x, y, z of nodes, each (ni, nj, nk): nk is 1 except in volumes, z is 0 in the plane."""
    planes = [np.ascontiguousarray(nodes[..., axis]) for axis in range(nodes.shape[-1])]
    if form_of(nodes) == "plane":
        planes.append(np.zeros_like(planes[0]))
    return planes if form_of(nodes) == "volume" else [plane[..., None] for plane in planes]
