"""The volume grid around an aircraft: levels from the body past the tip of the wing to the far field.

On each level the section of the wing is a hole, around which lies a collar; beyond the tip it is filled. So
the junction of wing and body is no concave edge of a march: lines leave the body along the wing. The other
half is the mirror image.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from meshonet.geometry.aircraft.aircraft import Aircraft
from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.blocks.block import Block, face_of
from meshonet.geometry.blocks.find_connections import find_connections
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.halves import with_image
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.blocks.shared_nodes import with_equal_nodes
from meshonet.solvers.aircraft.body_map import BodyMap
from meshonet.solvers.aircraft.body_plane import LevelPlan, level_patches
from meshonet.solvers.aircraft.exact_cells import at_height, between_walls
from meshonet.solvers.aircraft.plan import GROWTH, plan_of
from meshonet.solvers.aircraft.request import AircraftRequest
from meshonet.solvers.aircraft.tip_fill import tip_patches
from meshonet.solvers.aircraft.wall_normals import off_body, off_wing
from meshonet.solvers.aircraft.wing_lines import WingLines
from meshonet.solvers.blocking.layers.attach import sampled
from meshonet.solvers.rows.columns import arcs_of, resampled, with_first
from meshonet.solvers.rows.span_lines import SpanLines
from meshonet.solvers.rows.span_spacing import Ends, line_parts, spaced_cells, two_sided

_UNBOUNDED = 1e9
"""Length of the last cells of lines, which nothing limits but their growth."""
LEVEL_PATCHES = 7
"""Patches of a level (`level_patches`)."""
_FLAT = 1e-13
"""Distance from the plane of symmetry in lengths of the body, within which nodes are in it."""
_ABOVE = 1e-3
"""Step in zeta of the point by which the normal of the body is known."""
_UNEVEN = 0.08
"""Error of the first cell of a line, over its height, above which the line is measured in all its nodes: at a
pointed nose or tail distances from the body are no smooth function of zeta."""
_MEASURED = 3
"""Times these lines are measured: between their nodes the map is taken to be linear."""
_FINE = 129
"""Levels of the table by which lines beyond the tip are measured."""


def aircraft_grid(aircraft: Aircraft, request: AircraftRequest) -> tuple[Grid, tuple[str, ...]]:
    """Return the grid of an aircraft or its half, and notes.

    Raises InputError: a wing that does not begin inside the body or does not leave it.
    """
    chord = aircraft.wing.chord
    first, growth = request.height() * chord, request.growth or GROWTH
    space = BodyMap(aircraft.body, request.far_field * chord + 0.5 * aircraft.body.extent)
    plan, notes = plan_of(aircraft, request, space)
    wing, sections, scales = plan.wing, plan.sections, plan.scales
    levels = [_level(space, plan.levels, *each, first) for each in zip(sections, scales, strict=True)]
    shapes = [patch.shape[:2] for patch in levels[0]]
    table = np.stack([np.concatenate([patch.reshape(-1, 3) for patch in level]) for level in levels])
    ring = np.arange(shapes[0][0] * shapes[0][1]).reshape(shapes[0])
    beside = _along_wing(space, wing, table, ring, plan.span, first, growth)
    caps = _cap(space, wing, first)
    tip = np.concatenate([beside[-1], *(patch.reshape(-1, 3) for patch in caps)])
    beyond = _beyond_tip(space, tip, first, growth)
    shapes += [patch.shape[:2] for patch in caps]
    flat = () if aircraft.wing.tip == "flat" else ("the tip of the wing is flat",)
    normal = at_height(space, beside[0], beside[0] + [0.0, 0.0, _ABOVE], first)
    low = _flat(space.points(beside), aircraft)
    low = off_body(low, space.points(normal), ring, first)
    low = off_wing(low, ring, first)
    wall, near = ring[:, 0], ring[:, 1]
    low[1, near] = between_walls((low[1, wall], low[0, near]), low[1, near], first)
    high = _flat(space.points(beyond), aircraft)
    half = _joined(aircraft, shapes, low, high)
    return half if aircraft.half else with_image(half), (*notes, *flat)


def _flat(points: Floats, aircraft: Aircraft) -> Floats:
    """Return points (..., 3), those next to the plane of symmetry in it."""
    points[np.abs(points[..., 2]) < _FLAT * aircraft.body.length, 2] = 0.0
    return points


def _level(space: BodyMap, plan: LevelPlan, section: Floats, scale: Floats, first: float) -> list[Floats]:
    """Return the patches (ni, nj, 3) of s, theta, zeta of the level on which a section (n, 3) lies."""
    mean = float(section[:, 2].mean())
    patches = [
        np.concatenate([patch, np.full((*patch.shape[:2], 1), mean)], axis=-1)
        for patch in level_patches(plan, section[:, :2], scale)
    ]
    ring = patches[0]
    ring[..., 2] = mean + (section[:, None, 2] - mean) * _fade(ring[..., :2] * scale)
    for _ in range(2):
        steps = norms(np.diff(space.points(ring), axis=1))
        ring = resampled(ring, steps, with_first(steps, np.full(len(steps), first)))
    ring[:, 0], ring[:, -1], ring[-1] = patches[0][:, 0], patches[0][:, -1], ring[0]
    patches[0] = ring
    return patches


def _fade(columns: Floats) -> Floats:
    """Return 1 at the first to 0 at the last of the nodes of columns (n, m, 2 or 3), by arc length."""
    steps = norms(np.diff(columns, axis=1))
    arcs = arcs_of(steps)
    return np.asarray(1.0 - arcs / arcs[:, -1:])


def _along_wing(
    space: BodyMap, wing: WingLines, table: Floats, ring: Floats, cells: int, first: float, growth: float
) -> Floats:
    """Return places (cells + 1, p, 3) on the levels from body to tip, given those of key levels."""
    parts = line_parts(space.points(table), (first, first), growth, cells)
    places = SpanLines.through(table).at(parts)
    places[0], places[-1] = table[0], table[-1]
    on_wing = space.places(wing.points(wing.with_first(parts[:, ring[:, 0]], first)), places[:, ring[:, 0]])
    moved = on_wing - places[:, ring[:, 0]]
    moved[0] = 0.0
    places[:, ring] += moved[:, :, None] * _fade(table[0, ring])[..., None]
    wall, near = ring[:, 0], ring[:, 1]
    rest = np.setdiff1d(np.arange(places.shape[1]), wall)
    places[:, near] = at_height(space, places[:, wall], places[:, near], first)
    height = norms(space.points(places[1]) - space.points(places[0]))
    uneven = rest[np.abs(height[rest] - first) > _UNEVEN * first]
    if len(uneven):
        places[:, uneven] = _spaced(space, places[:, uneven], first, growth)
    places[1, rest] = at_height(space, places[0, rest], places[1, rest], first)
    return places


def _spaced(space: BodyMap, places: Floats, first: float, growth: float) -> Floats:
    """Return places (k, p, 3) on their lines again, at the arcs of `two_sided` in space."""
    lines = np.moveaxis(places, 0, 1)
    for _ in range(_MEASURED):
        lines = _resampled(lines, _arcs(space, lines), (first, first), growth, len(places) - 1)
    return np.moveaxis(lines, 1, 0)


def _arcs(space: BodyMap, lines: Floats) -> Floats:
    """Return the arc lengths (p, k) in space at places (p, k, 3) on lines."""
    return arcs_of(norms(np.diff(space.points(lines), axis=1)))


def _resampled(lines: Floats, arcs: Floats, ends: Ends, growth: float, cells: int) -> Floats:
    """Return places (p, cells + 1, 3) on lines (p, k, 3) with `arcs` (p, k), at those of `two_sided`."""
    wanted = two_sided(arcs[:, -1], ends, growth, cells)
    return sampled(lines, arcs, np.minimum(wanted, arcs[:, -1:]))


def _cap(space: BodyMap, wing: WingLines, first: float) -> list[Floats]:
    """Return the patches (ni, nj, 3) of s, theta, zeta that fill the last section: a ring and a core."""
    loop = wing.points(np.ones((1, len(wing.roots))))[0]
    return [space.places(patch) for patch in tip_patches(loop, first)]


def _beyond_tip(space: BodyMap, tip: Floats, first: float, growth: float) -> Floats:
    """Return places (k, p, 3) on the levels from the tip to the far field, given those at the tip (p, 3)."""
    table = np.repeat(tip[:, None], _FINE, axis=1)
    table[..., 2] += np.linspace(0.0, 1.0, _FINE) * (1.0 - tip[:, 2:])
    arcs, ends = _arcs(space, table), (first, _UNBOUNDED)
    cells = spaced_cells(float(arcs[:, -1].max()), ends, growth, _UNBOUNDED, 8)
    places = np.moveaxis(_resampled(table, arcs, ends, growth, cells), 1, 0)
    places[1] = at_height(space, places[0], places[1], first)
    return places


def _joined(aircraft: Aircraft, shapes: Sequence[tuple[int, int]], low: Floats, high: Floats) -> Grid:
    """Return the grid of points (k, p, 3) from the body to the tip, and from there to the far field.

    The first seven of `shapes` are patches of all levels, the others fill the section beyond the tip.
    """
    tip = len(low) - 1
    blocks: list[Block] = []
    start = 0
    for number, (ni, nj) in enumerate(shapes):
        columns = slice(start, start + ni * nj)
        start += ni * nj
        nodes = high[:, columns]
        if number < LEVEL_PATCHES:
            nodes = np.concatenate([low[:-1, columns], nodes])
        blocks.append(_right_handed(np.moveaxis(nodes.reshape(len(nodes), ni, nj, 3), 0, 2)))
    connections = find_connections(blocks)
    joined = with_equal_nodes(blocks, connections)
    return Grid(joined, tuple(_patches(joined, tip, aircraft)), connections, aircraft.name)


def _right_handed(nodes: Floats) -> Block:
    """Return the block of nodes (ni, nj, nk, 3), i reversed where it is left-handed."""
    i, j, k = (
        nodes[tuple(1 if axis == other else 0 for other in range(3))] - nodes[0, 0, 0] for axis in range(3)
    )
    return Block(np.ascontiguousarray(nodes if float((np.cross(i, j) * k).sum()) > 0.0 else nodes[::-1]))


def _patches(blocks: tuple[Block, ...], tip: int, aircraft: Aircraft) -> Iterator[Patch]:
    """Yield the patches: body, wing, tip, far field and plane of symmetry."""
    for number, block in enumerate(blocks):
        ni, nj, nk = (count - 1 for count in block.counts)
        inside = number >= LEVEL_PATCHES
        yield Patch("tip" if inside else aircraft.body.name, "bottom", 0, ni, (0, nj), number, "wall")
        yield Patch("farfield", "top", 0, ni, (0, nj), number)
        if number == 0:
            yield Patch("wing", "south", 0, ni, (0, tip), number, "wall")
        for side in ("west", "east", "south", "north"):
            if not face_of(block.nodes[..., 2], side).any():
                yield Patch("symmetry", side, 0, ni if side in ("south", "north") else nj, (0, nk), number)
