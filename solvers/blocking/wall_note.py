"""Notes for the report about walls with layers, measured on the grid: first cells, growth, sharp edges."""

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import may_be_wall
from meshonet.geometry.blocks.vertices import vertices
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.polygon.corners import angle_between
from meshonet.geometry.quality.lines import lines
from meshonet.geometry.quality.walls import wall_rows
from meshonet.geometry.spacing.y_plus import first_cell_note
from meshonet.solvers.blocking.layers.marched import BLUNT
from meshonet.solvers.blocking.layers.wall_rows import has_sharp_edge

WIDEST = 150.0  # angle in degrees of a cell at a sharp edge above which a note says how to avoid it


def wall_note(grid: Grid, domain: Domain, names: Collection[str], first: float) -> str:
    """Return a note on the heights of first cells and the growth of rows at the walls with layers.

    Parameters
    ----------
    grid : multi-block grid or O grid.
    names : names of the walls with layers; if empty, the loops `Domain.layered_loops` have layers.
    first : prescribed height in the domain's unit.
    """
    unnamed = (name for number in domain.layered_loops for name in domain.loops[number].names)
    layered = set(names) or set(filter(may_be_wall, unnamed))
    patches = tuple(replace(p, kind="wall") if p.name in layered else p for p in grid.patches)
    grid = replace(grid, patches=patches)
    walls = [patch for patch in grid.walls() if patch.name in layered]
    rows = wall_rows(grid, walls, lines(grid, vertices(grid), all_measures=False).by_wall)
    low, high = min(row.height.min for row in rows), max(row.height.max for row in rows)
    growth = max((row.growth.mean for row in rows if row.growth), default=None)
    where = f"node of {', '.join(names)}" if names else "wall node"
    return first_cell_note(low, high, first, growth, where)


def without_layers(domain: Domain) -> list[str]:
    """Return a note in a list if outer sides have no layers only because they are not named as walls."""
    outer = domain.loops[0].names
    if 0 in domain.layered_loops or len(outer) == 1:
        return []
    periodic = {name for pair in domain.periodic for name in pair.names}
    left = [name for name in dict.fromkeys(outer) if may_be_wall(name) and name not in periodic]
    return [f"no layers at {', '.join(left)}: name all walls in {{walls}} to have them there"] if left else []


def sharp_edge_notes(layout: Layout) -> list[str]:
    """Return a note for each sharp edge where cells have wide angles because no layers follow its wake."""
    notes, mesh = [], layout.mesh
    for loop in mesh.domain.loops[1:]:
        if has_sharp_edge(loop):
            x, y = edge = loop.at(loop.corner_arcs[:1])[0]
            node = int(np.argmin(np.hypot(*(mesh.nodes - edge).T)))
            there = mesh.quads[(mesh.quads == node).any(axis=1)]
            if loop.corner_angles[0] / len(there) > WIDEST:
                corners = mesh.nodes[there]
                after, before = (np.roll(corners, k, axis=1) - corners for k in (-1, 1))
                angles = angle_between(after, before)
                at = f"the sharp edge of {loop.names[0]}, ({x:.6g}, {y:.6g}),"
                has = f"have angles of {np.degrees(angles.max()):.1f} degrees"
                check = "checkMesh of OpenFOAM can find them skew"
                notes.append(f"cells at {at} {has}, and {check}: {BLUNT} makes it blunt")
    return notes
