"""The surface of a wing: a patch around its sections, and two patches of its cap."""

import math
from dataclasses import dataclass, replace

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.elementary import cos, power, product, sin
from meshonet.geometry.errors import InputError
from meshonet.geometry.sections.stack import STEEP, Stack
from meshonet.solvers.stacking.section_nodes import BASE_CELLS, GAP, around, nose_notes, unit_nodes
from meshonet.solvers.stacking.span_heights import span_heights
from meshonet.solvers.stacking.tip import Cap

DEFAULT_AROUND, DEFAULT_SPAN = 129, 49  # nodes
LEAST_SPAN, MOST_SPAN = 5, 10_001  # nodes
EDGE, MOST_EDGE = 2.2, 2.5  # intended and largest ratio of neighbouring cells at the edge of a tip
_SWEEPS = 20  # of smoothing around the section
FADE = 8  # number of cells from the tip whose lengths vary around the section
REACH = 0.05  # largest distance of these cells from the tip, in chords of the tip
_NEAR = 1e-3  # part of the last panel over which the slope of grid lines at the tip is measured


@dataclass(frozen=True)
class WingSurface:
    """Node counts of the surface of a wing, checked on construction."""

    around: int = DEFAULT_AROUND  # odd number of nodes around a section, with the repeated first node
    span: int = DEFAULT_SPAN  # number of nodes from the root to the last section
    base: float = GAP  # smallest height of trailing edges in chords

    def __post_init__(self) -> None:
        if not LEAST_SPAN <= self.span <= MOST_SPAN:
            remedy = f"use {LEAST_SPAN} to {MOST_SPAN}"
            raise InputError(f"{self.span} nodes", remedy, parameter="span")


def wing_surface(stack: Stack, settings: WingSurface | None = None) -> tuple[Grid, tuple[str, ...]]:
    """Return the surface patches of a wing, with outward normals, and notes, e.g. on thickened edges.

    The first block goes around the sections, upper side first, and along the span. A round or flat tip adds
    two blocks that close it: a ring, and the core inside. The edge at the root is the patch ``symmetry``.

    Raises InputError if node counts are too small, or if outlines of sections intersect themselves.
    """
    settings = settings or WingSurface()
    plan = around(settings.around, gap=settings.base, edge=stack.te_spacing, nose=stack.le_spacing)
    units, notes = zip(*(unit_nodes(section, plan) for section in stack.sections), strict=True)
    unit = np.stack(units)
    refuse_crossing(stack, unit)
    cap = cap_of(stack)
    tip = _tip(stack, unit, cap) if cap else None
    main = _lofted(stack, unit, tip[0] if tip else None, settings.span)
    n, levels = main.shape[:2]
    blocks, patches = [Block(main)], [Patch("symmetry", "south", 0, n - 1)]
    whole = ((0, levels - 1),)
    connections = [Connection(0, "west", whole, 0, "east", whole, (1,))]
    if cap is None or tip is None:
        patches.append(Patch("symmetry", "north", 0, n - 1))
    else:
        blocks += [Block(tip[0]), Block(tip[1])]
        edge = ((0, n - 1),)
        connections.append(Connection(0, "north", edge, 1, "south", edge, (1,)))
        connections += cap.connections(n, 1, 2)
    zones = {"zones": ("wing", "tip", "tip")[: len(blocks)]}
    grid = Grid(tuple(blocks), tuple(patches), tuple(connections), stack.name, zones)
    changes = dict.fromkeys(note for note in notes if note)
    return grid, (*stack.notes, *changes, *nose_notes(stack.sections, plan))


def refuse_crossing(stack: Stack, unit: Floats) -> None:
    """Raise InputError if rotated sections intersect; `unit` (sections, n, 2) are nodes at unit chord."""
    cants = stack.cants
    if not cants.any():
        return
    steps = np.diff(stack.lofted(unit, stack.z), axis=0)
    normals = np.stack([sin(cants), cos(cants)], axis=1)
    for k, step in enumerate(steps):
        apart = min(float(product(step[:, 1:], normals[end]).min()) for end in (k, k + 1))
        if apart <= 0.0:
            low, high = stack.z[k : k + 2]
            turn = math.degrees(cants[k + 1])
            problem = f"the sections at z={low:g} and {high:g} cross, at {turn:.4g} degrees"
            raise InputError(problem, "turn them less, or move them apart", place=f"sections[{k + 1}].cant")


def cap_of(stack: Stack) -> Cap | None:
    """Return the cap of the tip of a wing; None for an open tip."""
    return None if stack.tip == "open" else Cap(BASE_CELLS // 2, bulge=1.0 if stack.tip == "round" else 0.0)


def _tip(stack: Stack, unit: Floats, cap: Cap) -> tuple[Floats, Floats]:
    """Return ring and core of a cap; it leans towards a steep last panel and has the section's cant."""
    end, flat = stack.z[-1:], replace(stack.sections[-1], cant=0.0)
    loop = replace(stack, sections=(*stack.sections[:-1], flat)).lofted(unit, end)[0]
    patches = cap.patches(loop)
    inclined = float(stack.dihedrals[-1] - stack.cants[-1])
    lean = math.copysign(max(abs(inclined) - math.radians(STEEP), 0.0), inclined)
    if lean:
        for patch in patches:
            height = patch[..., 2] - end
            patch[..., 1] += math.sin(lean) * height
            patch[..., 2] = end + math.cos(lean) * height
    if stack.cants[-1]:
        patches = stack.canted(patches[0][None], end)[0], stack.canted(patches[1][None], end)[0]
    return patches


def _tip_cells(ring: Floats) -> Floats:
    """Return the last cells along the span (n,), about as long as those of the cap's ring (n, ., 3)."""
    first = norms(ring[:-1, 1] - ring[:-1, 0])
    cells = np.maximum(EDGE * first.min(), first / EDGE)
    for _ in range(_SWEEPS):  # where cells of the ring change from one line to the next
        cells = 0.5 * cells + 0.25 * (np.roll(cells, 1) + np.roll(cells, -1))
    cells = np.clip(cells, first / MOST_EDGE, first * MOST_EDGE)
    return np.append(cells, cells[:1])


def _lofted(stack: Stack, unit: Floats, ring: Floats | None, nodes: int) -> Floats:
    """Return the nodes (n, nodes, 3) around the sections of a wing whose tip has a ring (n, ., 3)."""
    if ring is None or stack.tip_spacing is not None:
        tip = None if stack.tip_spacing is None else stack.tip_spacing * stack.sections[-1].chord
        main = stack.lofted(unit, span_heights(stack.z, nodes, tip, stack.panel_cells)).transpose(1, 0, 2)
    else:
        last = _tip_cells(ring) / _slant(stack, unit)
        z = span_heights(stack.z, nodes, float(last.min()), stack.panel_cells)
        panel = int(np.searchsorted(z, stack.z[-2]))
        heights = np.tile(z, (len(last), 1))
        heights[:, panel:] = _with_last(z[panel:], last, REACH * stack.sections[-1].chord)
        columns = [stack.lofted(unit[:, k : k + 1], heights[k])[:, 0] for k in range(len(last))]
        main = np.stack(columns)
        main[:, -1] = ring[:, 0]
    main[-1] = main[0]
    return main


def _slant(stack: Stack, unit: Floats) -> Floats:
    """Return the lengths (n,) of lines along the span per unit of height at the tip."""
    height = _NEAR * (stack.z[-1] - stack.z[-2])
    below, tip = stack.lofted(unit, np.array([stack.z[-1] - height, stack.z[-1]]))
    return norms(tip - below) / height


def _with_last(z: Floats, last: Floats, reach: float) -> Floats:
    """Return heights (n, m) between the ends of `z` (m,) whose last cells are `last` (n,)."""
    steps = np.diff(z)
    cells = len(steps)
    faded = np.maximum(np.arange(cells)[::-1] / min(FADE, 0.5 * cells), (z[-1] - z[1:]) / reach)
    share = np.clip(1.0 - faded, 0.0, None)
    made = steps * power(last[:, None] / steps[-1], share)
    made += (steps.sum() - made.sum(axis=1))[:, None] * (weight := (1.0 - share) * steps) / weight.sum()
    heights = z[0] + np.concatenate([np.zeros((len(last), 1)), np.cumsum(made, axis=1)], axis=1)
    heights[:, -1] = z[-1]
    return np.asarray(heights)
