"""The grid of a blade row: blocks around the blade in each zone of the span, and inside it in gaps.

Patches are blade, tip (or foot, at a hub gap), hub, shroud, inlet, outlet, and the connected periodic1 and
periodic2.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, Side
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.extrude import thick
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import NoValidGridError
from meshonet.geometry.layout.lattice import lattice_quads
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.geometry.layout.to_grid import to_grid
from meshonet.geometry.rows.row import Row
from meshonet.geometry.threads import in_threads, run_in_threads
from meshonet.kernels._native import stacked_block
from meshonet.solvers.rows.gap_blocks import GapBlocks, gap_blocks
from meshonet.solvers.rows.key_tables import key_tables
from meshonet.solvers.rows.request import RowRequest
from meshonet.solvers.rows.stacked import StackedRow
from meshonet.solvers.rows.zones import Zone, fewest_cells, section_cells, zones_of

_OTHER = 0.15  # relative difference from the requested number of cells above which a note says so


def row_grid(row: Row, request: RowRequest) -> tuple[Grid, tuple[str, ...]]:
    """Return the grid of one passage of a row, and notes.

    Raises InputError if there is no room for layers, inlet or outlet; NoValidGridError if cells are folded.
    """
    first, growth = request.height() * row.chord, request.ratio
    zones = zones_of(row, first, growth, request.cells)
    keys = key_tables(row, first, growth, section_cells(zones, request.cells, growth), zones)
    stacked = StackedRow(row, keys, zones, first, growth)
    ends = dict(zip([k for k, zone in enumerate(zones) if zone.gap], keys.gaps, strict=True))
    made, rest = stacked.nodes()

    def section(k: int) -> "ZoneSection":
        if not zones[k].gap:
            return ZoneSection(to_grid(stacked.layout), stacked.layout, None)
        low, high = stacked.bounds[k]
        outline = made.blade[low : high + 1]
        inside = gap_blocks(row, ends[k], stacked.columns[:, 0], outline, zones[k], growth)
        layout = _with_inside(stacked.layout, inside)
        return ZoneSection(to_grid(layout), layout, inside)

    sections = run_in_threads([*(partial(section, k) for k in range(len(zones))), *rest])[: len(zones)]
    del rest  # and what it holds of layers
    space, turn = made.space, turned_by(row.pitch)
    second, partner = stacked.twins
    space[:, second] = turn(space[:, partner])
    grid = _joined(row, stacked, zones, sections, space, turn)
    return grid, (
        *_notes(zones, first),
        *_other_cells(grid, request.cells, fewest_cells(zones, growth), growth),
    )


def turned_by(angle: float) -> Motion:
    """Return the rotation about the x axis that adds `angle`, in radians, to theta = atan2(y, z)."""
    c, s = math.cos(angle), math.sin(angle)
    return Motion(turn=((1.0, 0.0, 0.0), (0.0, c, s), (0.0, -s, c)))


@dataclass(frozen=True, eq=False)
class ZoneSection:
    """The blocks on one level of a zone (the blade, or a gap at hub or casing)."""

    # plane, layout: those around the blade, as a planar grid and as a layout
    plane: Grid
    layout: Layout
    inside: GapBlocks | None  # those inside its outline, in a gap


def _joined(
    row: Row, stacked: StackedRow, zones: Sequence[Zone], sections: Sequence[ZoneSection], space: Floats,
    turn: Motion,
) -> Grid:  # fmt: skip
    blocks: list[tuple[Floats, Indices]] = []
    patches: list[Patch] = []
    connections: list[Connection] = []
    starts: list[int] = []
    whole = len(stacked.layout.blocks)
    for zone, section, (low, high) in zip(zones, sections, stacked.bounds, strict=True):
        start = len(blocks)
        starts.append(start)
        blocks += [(space[low : high + 1], ids) for ids in stacked.layout.blocks]
        if section.inside:
            blocks += [(section.inside.space, ids[::-1]) for ids in section.inside.fill.layout.blocks]
        patches += [replace(patch, block=patch.block + start) for patch in section.plane.patches]
        patches += _end_patches(zone, section.layout, start, whole)
        for each in section.plane.connections:
            own = replace(each, block=each.block + start, donor=each.donor + start, transform=None)
            moved = turn if each.transform else None
            connections.append(replace(thick(own, high - low + 1), transform=moved))
    for below, above in pairwise(starts):
        for number, ids in enumerate(stacked.layout.blocks):
            face = tuple((0, n - 1) for n in ids.shape)
            ends = (below + number, "top", face), (above + number, "bottom", face)
            connections.append(Connection(*ends[0], *ends[1], (1, 2)))  # type: ignore[arg-type]
    made = in_threads(lambda block: _block(*block), blocks)
    facts = {"method": "row"}
    return Grid(tuple(made), tuple(patches), tuple(connections), row.name, facts)


def _block(nodes: Floats, ids: Indices) -> Block:
    """Return the block of nodes (levels, n, 3) with indices `ids` (ni, nj) in each level."""
    block = np.empty((3, *ids.shape, len(nodes)))
    stacked_block(nodes, ids.ravel(), block.reshape(3, ids.size, -1))
    if not np.isfinite(block).all():
        problem = "lines off the blade have no length, because its profiles lie far beside each other"
        raise NoValidGridError(f"{problem}; give profiles of one blade, or more of them")
    return Block(np.moveaxis(block, 0, -1), finite=True)


def _end_patches(zone: Zone, layout: Layout, start: int, whole: int) -> list[Patch]:
    """Return the patches at both ends of a zone; blocks from `whole` on are in a gap."""
    patches = []
    sides: tuple[Side, Side] = ("bottom", "top")
    for number, ids in enumerate(layout.blocks):
        for side in sides:
            name = _end_name(zone, side, number >= whole)
            if name:
                i, j = (n - 1 for n in ids.shape)
                patches.append(Patch(name, side, 0, i, (0, j), start + number, "wall"))
    return patches


def _end_name(zone: Zone, side: Side, inside: bool) -> str:
    """Return the name of the patch at the end of a block, empty where another block follows."""
    if side == "bottom" and zone.low == 0.0:
        return "hub"
    if side == "top" and zone.high == 1.0:
        return "shroud"
    return ("tip" if side == "bottom" else "foot") if inside else ""


def _with_inside(layout: Layout, inside: GapBlocks) -> Layout:
    mesh, own, k = layout.mesh, inside.fill.layout, len(inside.outline)
    count = len(mesh.nodes)
    number = np.concatenate([inside.outline, count + np.arange(len(own.mesh.nodes) - k)])
    blocks = (*layout.blocks, *(number[block][::-1] for block in own.blocks))
    nodes = np.concatenate([mesh.nodes, own.mesh.nodes[k:]])
    more = Places.inside(len(nodes) - count)
    pairs = zip(vars(mesh.places).values(), vars(more).values(), strict=True)
    places = Places(*(np.concatenate(pair) for pair in pairs))
    places.loop[inside.outline] = -1
    return Layout(QuadMesh(mesh.domain, nodes, lattice_quads(blocks), places), blocks)


def _other_cells(grid: Grid, wanted: int, fewest: int, growth: float) -> tuple[str, ...]:
    """Return a note if the number of cells is far from the requested one."""
    cells = sum(block.cells for block in grid.blocks)
    if abs(cells - wanted) <= _OTHER * wanted:
        return ()
    why = "numbers along the sides of blocks are whole"
    if fewest > wanted:
        why = f"layers and cells that grow by {growth:g} at most need about {round(fewest, -4)}"
    return (f"{cells} cells in a passage instead of {wanted}: {why}",)


def _notes(zones: Sequence[Zone], first: float) -> tuple[str, ...]:
    narrow = [zone for zone in zones if zone.gap and zone.ends[0] < first]
    return tuple(
        f"first cells at the walls of a gap are {zone.ends[0]:.4g} high instead of {first:.4g}: "
        f"{zone.cells} cells of this height fill the gap" for zone in narrow
    )  # fmt: skip
