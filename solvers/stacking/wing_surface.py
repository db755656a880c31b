"""The surface of a wing: one patch around its sections from root to tip, and the two of its cap."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError
from meshonet.geometry.sections.stack import Stack
from meshonet.geometry.spacing.along_curve import on_corners
from meshonet.geometry.spacing.tanh_law import TanhLaw
from meshonet.solvers.stacking.section_nodes import BASE_CELLS, GAP, around, unit_nodes
from meshonet.solvers.stacking.tip import Cap

DEFAULT_AROUND, DEFAULT_SPAN = 129, 49  # nodes
LEAST_SPAN, MOST_SPAN = 5, 10_001  # nodes
_ROOT_CELL = 1.4
"""Cell at the root, in mean cells along the span."""


@dataclass(frozen=True)
class WingSurface:
    """Nodes of the surface of a wing; validates itself.

    Parameters
    ----------
    around : nodes around a section, the first one repeated; odd.
    span : nodes from the root to the last section.
    base : least height of trailing edges, in chords.
    """

    around: int = DEFAULT_AROUND
    span: int = DEFAULT_SPAN
    base: float = GAP

    def __post_init__(self) -> None:
        if not LEAST_SPAN <= self.span <= MOST_SPAN:
            remedy = f"use {LEAST_SPAN} to {MOST_SPAN}"
            raise InputError(f"{self.span} nodes", remedy, parameter="span")


def wing_surface(stack: Stack, settings: WingSurface | None = None) -> tuple[Grid, tuple[str, ...]]:
    """Return the surface patches of a wing, whose normals point outwards, and notes of what was changed.

    The first block goes around the sections, from the trailing edge over the upper side, and along the span;
    a round or flat tip adds the ring and the core of its cap. The root is a patch named ``symmetry``.

    Raises InputError: counts that do not suffice, sections whose nodes cross.
    """
    settings = settings or WingSurface()
    plan = around(stack.sections, settings.around, gap=settings.base)
    units, notes = zip(*(unit_nodes(section, plan) for section in stack.sections), strict=True)
    unit = np.stack(units)
    cap = None if stack.tip == "open" else Cap(BASE_CELLS // 2, bulge=1.0 if stack.tip == "round" else 0.0)
    last = stack.lofted(unit, stack.z[-1:])[0]
    z = span_heights(stack.z, settings.span, cap.first_row(last[:, :2]) if cap else None)
    main = stack.lofted(unit, z).transpose(1, 0, 2)
    main[-1] = main[0]
    n = len(main)
    blocks, patches = [Block(main)], [Patch("symmetry", "south", 0, n - 1)]
    whole = ((0, len(z) - 1),)
    connections = [Connection(0, "west", whole, 0, "east", whole, (1,))]
    if cap is None:
        patches.append(Patch("symmetry", "north", 0, n - 1))
    else:
        ring, core = cap.patches(main[:, -1])
        blocks += [Block(ring), Block(core)]
        edge = ((0, n - 1),)
        connections.append(Connection(0, "north", edge, 1, "south", edge, (1,)))
        connections += cap.connections(n, 1, 2)
    zones = {"zones": ("wing", "tip", "tip")[: len(blocks)]}
    grid = Grid(tuple(blocks), tuple(patches), tuple(connections), stack.name, zones)
    return grid, tuple(dict.fromkeys(note for note in notes if note))


def span_heights(sections: Floats, nodes: int, last: float | None) -> Floats:
    """Return z (nodes,) from the first of the `sections` to the last, all of which are among them.

    Cells shrink towards the tip to the length `last`; without it they are equal but for what that moves.

    Raises InputError: more sections than nodes.
    """
    cells, span = nodes - 1, float(sections[-1] - sections[0])
    q = np.linspace(0.0, 1.0, nodes)
    if last is not None and last < span / cells:
        q = TanhLaw.fitted(cells, _ROOT_CELL / cells, last / span)(q)
    away = on_corners(q, (sections[1:-1] - sections[0]) / span)
    heights = np.asarray(sections[0] + span * away)
    inner = np.searchsorted(away, (sections[1:-1] - sections[0]) / span)
    heights[inner], heights[-1] = sections[1:-1], sections[-1]
    return heights
