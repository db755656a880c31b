"""The volume grid around an aircraft: levels from the body past the tips of wings to the far field.

On each level the section of a wing is a hole with a collar around it; beyond the tip the hole is filled.
"""

from collections.abc import Iterator, Sequence
from itertools import islice, pairwise

import numpy as np

from meshonet.geometry.aircraft.aircraft import Aircraft
from meshonet.geometry.aircraft.dimensions import aircraft_dimensions
from meshonet.geometry.arrays import Floats, Indices, arc_lengths, arc_parts, norms
from meshonet.geometry.blocks.block import Block, face_of
from meshonet.geometry.blocks.find_connections import find_connections
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.halves import with_image
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.blocks.shared_nodes import with_equal_nodes
from meshonet.geometry.curves.cubic import sampled
from meshonet.solvers.aircraft.body_map import BodyMap
from meshonet.solvers.aircraft.body_plane import level_patches
from meshonet.solvers.aircraft.exact_cells import at_height, between_walls
from meshonet.solvers.aircraft.lofted_map import map_around, points_above
from meshonet.solvers.aircraft.plan import AircraftPlan, plan_of
from meshonet.solvers.aircraft.request import AircraftRequest
from meshonet.solvers.aircraft.tip_cells import arcs_beyond, last_cells
from meshonet.solvers.aircraft.wall_normals import across_tip, off_body, off_tip, off_wing
from meshonet.solvers.rows.columns import resampled, with_first
from meshonet.solvers.rows.span_lines import SpanLines
from meshonet.solvers.rows.span_spacing import SAMPLES, Ends, LineArcs, spaced_cells, two_sided

_UNBOUNDED = 1e9  # length of the last cells of lines: they are limited by the growth ratio only
_FLAT = 1e-13  # nodes nearer to the plane of symmetry than this fraction of the body's length lie in it
# relative error of a first cell above which its whole line is measured, as at a pointed nose or tail
_UNEVEN = 0.08
_MEASURED = 3  # number of times that these lines are measured
_FINE = 129  # number of levels of the table by which lines beyond the tip are measured


def aircraft_grid(aircraft: Aircraft, request: AircraftRequest) -> tuple[Grid, float, tuple[str, ...]]:
    """Return the grid of an aircraft or of half an aircraft, the planned growth ratio, and notes.

    Raises InputError if a wing does not begin inside the body or does not leave it, or if wings are too close
    to each other.
    """
    sizes = aircraft_dimensions(aircraft, request.height(), request.far_field)
    space = map_around(aircraft.body, sizes.far_field)
    plan, notes = plan_of(aircraft, request, space)
    first, growth = sizes.first_cell, plan.growth
    levels = [_level(space, plan, k, first) for k in range(SAMPLES)]
    caps = [space.places(patch) for tip in plan.tips for patch in tip]
    lattices = _columns([*levels[0], *caps])
    table = np.stack([np.concatenate([patch.reshape(-1, 3) for patch in level]) for level in levels])
    rings = [lattices[number] for number in plan.levels.collar_patches]
    walls = np.concatenate([ring[:, 0] for ring in rings])
    points = space.points(table)
    lines = LineArcs.through(points)
    last = last_cells(points[-1], walls, lines.lengths / plan.span, first, growth)
    beside = _along_wings(space, plan, table, rings, lines, (first, last), growth)
    tip = np.concatenate([beside[-1], *(patch.reshape(-1, 3) for patch in caps)])
    on_tip = np.append(walls, np.arange(len(last), len(tip)))
    ends = np.append(last, np.full(len(tip) - len(last), first))
    beyond = _beyond_tip(space, tip, on_tip, ends, growth)
    low, high = (_flat(space.points(places), aircraft) for places in (beside, beyond))
    for wing, ring in zip(plan.wings, rings, strict=True):
        low, high = across_tip(low, high, ring, wing, first)
    low = off_body(low, points_above(space, beside[0], first), rings, first)
    for wing, ring in zip(plan.wings, rings, strict=True):
        low = off_wing(low, ring, first, closed=not wing.fin)
        wall, near = ring[:, 0], ring[:, 1]
        low[1, near] = between_walls((low[1, wall], low[0, near]), low[1, near], first)
    inside = lattices[plan.levels.patches :]
    for wing, ring, *cap in zip(plan.wings, rings, inside[::2], inside[1::2], strict=True):
        high = off_tip(high, np.concatenate([each.ravel() for each in cap]), ring, wing)
    half = _joined(aircraft, plan, lattices, low, high)
    whole = aircraft.axes.to_file(half if aircraft.half else with_image(half))
    return whole, growth, (*aircraft.notes, *notes, *_flat_tips(aircraft))


def _flat_tips(aircraft: Aircraft) -> Iterator[str]:
    """Yield notes on tips that are flat, though the file says otherwise."""
    for wing, (name, _) in zip(aircraft.wings, aircraft.patches, strict=True):
        if wing.tip != "flat":
            yield f"the tip of the {name} is flat"


def _columns(patches: Sequence[Floats]) -> list[Indices]:
    """Return the node numbers (ni, nj) of each patch (ni, nj, 3), patch after patch."""
    sizes = [ni * nj for ni, nj, _ in (patch.shape for patch in patches)]
    numbers = np.split(np.arange(sum(sizes)), np.cumsum(sizes)[:-1])
    return [each.reshape(patch.shape[:2]) for each, patch in zip(numbers, patches, strict=True)]


def _flat(points: Floats, aircraft: Aircraft) -> Floats:
    """Return points (..., 3), those near the plane of symmetry moved into it."""
    points[np.abs(points[..., 2]) < _FLAT * aircraft.body.length, 2] = 0.0
    return points


def _level(space: BodyMap, plan: AircraftPlan, k: int, first: float) -> list[Floats]:
    """Return the patches (ni, nj, 3) of s, theta, zeta on the key level `k`."""
    columns = [[each[k] for each in column] for column in plan.holes]
    patches = level_patches(space, plan.levels, columns)
    holes = [hole for column in columns for hole in column]
    for number, hole, sections in zip(plan.levels.collar_patches, holes, plan.sections, strict=True):
        made = patches[number]
        lift = sections[k][:, None, 2] - hole.zeta
        made[..., 2] = hole.zeta + lift * _fade(made[..., :2] * hole.scale)
        ring = made
        for _ in range(2):
            steps = norms(np.diff(space.points(ring), axis=1))
            ring = resampled(ring, steps, with_first(steps, np.full(len(steps), first)))
        ring[:, 0], ring[:, -1] = made[:, 0], made[:, -1]
        if hole.fin:
            ring[[0, -1], :, 1] = np.pi
        else:
            ring[-1] = ring[0]
        patches[number] = ring
    return patches


def _fade(columns: Floats) -> Floats:
    """Return weights (n, m) from 1 to 0 by arc length along columns of nodes (n, m, 2 or 3)."""
    return np.asarray(1.0 - arc_parts(columns))


def _along_wings(
    space: BodyMap, plan: AircraftPlan, table: Floats, rings: Sequence[Indices], lines: LineArcs,
    ends: tuple[float, Floats], growth: float,
) -> Floats:  # fmt: skip
    """Return places (cells + 1, p, 3) on the levels from body to tips, given those of key levels."""
    first, last = ends
    arcs = two_sided(lines.lengths, ends, growth, plan.span) / lines.lengths[:, None]
    parts = lines.parts_at(arcs.T)
    places = SpanLines.through(table).at(parts)
    places[0], places[-1] = table[0], table[-1]
    walls = [ring[:, 0] for ring in rings]
    for wing, ring in zip(plan.wings, rings, strict=True):
        wall, near = ring[:, 0], ring[:, 1]
        on_wing = space.places(wing.points(wing.with_first(parts[:, wall], first)), places[:, wall])
        moved = on_wing - places[:, wall]
        moved[0] = 0.0
        places[:, ring] += moved[:, :, None] * _fade(table[0, ring])[..., None]
        places[:, near] = at_height(space, places[:, wall], places[:, near], first)
    rest = np.setdiff1d(np.arange(places.shape[1]), np.concatenate(walls))
    height = norms(space.points(places[1]) - space.points(places[0]))
    uneven = rest[np.abs(height[rest] - first) > _UNEVEN * first]
    if len(uneven):
        places[:, uneven] = _spaced(space, places[:, uneven], (first, last[uneven]), growth)
    places[1, rest] = at_height(space, places[0, rest], places[1, rest], first)
    return places


def _spaced(space: BodyMap, places: Floats, ends: Ends, growth: float) -> Floats:
    """Return places (k, p, 3) on the same lines, at the arcs of `two_sided` in space."""
    lines = np.moveaxis(places, 0, 1)
    for _ in range(_MEASURED):
        arcs = arc_lengths(space.points(lines))
        lines = sampled(lines, arcs, two_sided(arcs[:, -1], ends, growth, len(places) - 1))
    return np.moveaxis(lines, 1, 0)


def _beyond_tip(space: BodyMap, tip: Floats, on_tip: Indices, first: Floats, growth: float) -> Floats:
    """Return places (k, p, 3) from the tip (p, 3) to the far field; first cells are `first` (p,) high.

    Where lines are `on_tip`, this height is exact.
    """
    table = np.repeat(tip[:, None], _FINE, axis=1)
    table[..., 2] += np.linspace(0.0, 1.0, _FINE) * (1.0 - tip[:, 2:])
    arcs = arc_lengths(space.points(table))
    cells = spaced_cells(float(arcs[:, -1].max()), (float(first.min()), _UNBOUNDED), growth, _UNBOUNDED, 8)
    places = np.moveaxis(sampled(table, arcs, arcs_beyond(arcs[:, -1], first, cells)), 1, 0)
    places[1, on_tip] = at_height(space, places[0, on_tip], places[1, on_tip], float(first.min()))
    return places


def _joined(
    aircraft: Aircraft, plan: AircraftPlan, lattices: Sequence[Indices], low: Floats, high: Floats
) -> Grid:
    """Return the grid of points (k, p, 3) from the body to the tips, and beyond.

    The first of `lattices` (ni, nj) are columns of all levels, the others fill the sections beyond the tips.
    """
    tip = len(low) - 1
    blocks: list[Block] = []
    for number, columns in enumerate(lattices):
        nodes = high[:, columns]
        if number < plan.levels.patches:
            nodes = np.concatenate([low[:-1, columns], nodes])
        blocks.append(_right_handed(np.moveaxis(nodes, 0, 2)))
    connections = find_connections(blocks)
    joined = with_equal_nodes(blocks, connections)
    patches, facts = tuple(_patches(joined, plan, tip, aircraft)), {"zones": _names(plan, aircraft)}
    return Grid(joined, patches, connections, aircraft.name, facts)


def _names(plan: AircraftPlan, aircraft: Aircraft) -> list[str]:
    """Return the names of the blocks, by wing and by part of the body."""
    body, tips = aircraft.body.name, dict(aircraft.patches)
    wings = [wing.name for wing in plan.wings]
    names, firsts, members = list[str](), list[str](), iter(wings)
    for column in plan.levels.columns:
        first, *fins = islice(members, len(column.collars))
        firsts.append(first)
        parts = ("collar", "below") if column.fin_alone else ("collar", "above", "below")
        names += [*(f"{first}-{part}" for part in parts), *(f"{name}-collar" for name in fins)]
    names += [f"{before}-to-{after}" for before, after in pairwise(firsts)]
    names += [f"{body}-{part}" for part in ("nose", "nose-core", "tail", "tail-core")]
    return [*names, *(f"{tips[name]}-{part}" for name in wings for part in ("ring", "core"))]


def _right_handed(nodes: Floats) -> Block:
    """Return the block of nodes (ni, nj, nk, 3), with i reversed if it is left-handed."""
    i, j, k = (
        nodes[tuple(1 if axis == other else 0 for other in range(3))] - nodes[0, 0, 0] for axis in range(3)
    )
    return Block(np.ascontiguousarray(nodes if float((np.cross(i, j) * k).sum()) > 0.0 else nodes[::-1]))


def _patches(blocks: tuple[Block, ...], plan: AircraftPlan, tip: int, aircraft: Aircraft) -> Iterator[Patch]:
    """Yield the patches: body, wings, tips, far field and plane of symmetry."""
    tips = dict(aircraft.patches)
    names = [wing.name for wing in plan.wings]
    collars = dict(zip(plan.levels.collar_patches, names, strict=True))
    for number, block in enumerate(blocks):
        ni, nj, nk = (count - 1 for count in block.counts)
        inside = number - plan.levels.patches
        name = aircraft.body.name if inside < 0 else tips[names[inside // 2]]
        yield Patch(name, "bottom", 0, ni, (0, nj), number, "wall")
        yield Patch("farfield", "top", 0, ni, (0, nj), number)
        if number in collars:
            yield Patch(collars[number], "south", 0, ni, (0, tip), number, "wall")
        for side in ("west", "east", "south", "north"):
            if not face_of(block.nodes[..., 2], side).any():
                yield Patch("symmetry", side, 0, ni if side in ("south", "north") else nj, (0, nk), number)
