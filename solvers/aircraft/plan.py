"""Plan of an aircraft grid: lines of wings, sections on key levels, counts."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from meshonet.geometry.aircraft.aircraft import Aircraft
from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.growth import cells_for_growth
from meshonet.solvers.aircraft.body_map import BodyMap
from meshonet.solvers.aircraft.body_plane import LevelPlan, planned
from meshonet.solvers.aircraft.collar_level import Hole
from meshonet.solvers.aircraft.holes import columns_of, grouped, holes_of, ordered
from meshonet.solvers.aircraft.request import AircraftRequest
from meshonet.solvers.aircraft.tip_fill import canted_tip_patches, half_tip_patches
from meshonet.solvers.aircraft.wing_lines import WingLines
from meshonet.solvers.rows.span_lines import key_heights
from meshonet.solvers.rows.span_spacing import SAMPLES, spaced_cells
from meshonet.solvers.stacking.wing_surface import DEFAULT_AROUND, DEFAULT_SPAN

GROWTHS = 1.2, 1.225, 1.25
"""Growth ratios if none is given: the first, or the first that permits the number of cells."""
_PLANNED = (0, 4, 8, 12, 16)  # number of key levels from which numbers of cells are derived
_TRIED = 59, 97  # node counts around a wing from which others are derived; with fewer, cells grow too much
_ALONG = (DEFAULT_SPAN - 1) / (DEFAULT_AROUND - 1)  # cells along the span per cell around sections
_ACUTE = math.radians(45.0)  # angle of wing and body below which an error names it as the cause of folds
_OBLIQUE = math.radians(40.0)  # smallest angle between wing and body across the root; below it cells fold
_AHEAD = 1e-3  # fraction of the span over which the direction of a wing at its root is measured
_ENOUGH = 1.15  # ratio of the number of cells to the requested number from which on a note says so


@dataclass(frozen=True, eq=False)
class AircraftPlan:
    """What is known before an aircraft grid is made: lines along the wings, sections, numbers of cells."""

    wings: tuple[WingLines, ...]  # lines of each wing, from nose to tail; a fin follows the wing below it
    sections: tuple[Floats, ...]  # (SAMPLES, n, 3) s, theta and zeta around each wing on the key levels
    holes: tuple[tuple[tuple[Hole, ...], ...], ...]  # sections by column, wing and key level
    levels: LevelPlan  # numbers of cells that are the same on all levels
    tips: tuple[tuple[Floats, Floats], ...]  # nodes (m, k, 3) of ring and core that fill the tip of each wing
    span: int  # number of cells from the body to the tips
    beyond: int  # number of cells from the tips to the far field
    growth: float  # largest growth ratio away from walls
    halves: int  # 2 if the grid has both halves of the aircraft, else 1

    @classmethod
    def of(cls, aircraft: Aircraft, request: AircraftRequest, space: BodyMap, around: int) -> Self:
        """Return the plan of a grid with `around` nodes around each wing.

        Raises InputError for a wing that does not begin inside the body, does not leave it, or is too close
        to another wing or to the top or bottom of the body.
        """
        chord = aircraft.wing.chord
        first, growth = request.height() * chord, request.growth or GROWTHS[0]
        wings = [
            WingLines.of(wing, name, aircraft.body, around, request.base)
            for wing, (name, _) in zip(aircraft.wings, aircraft.patches, strict=True)
        ]
        wings.sort(key=lambda wing: float(wing.points(np.zeros((1, len(wing.roots))))[..., 0].mean()))
        sections = [_on_keys(space, wing) for wing in wings]
        if not request.allow_invalid:
            for wing, each in zip(wings, sections, strict=True):
                _refuse_oblique(space, wing, each[0])
        columns = columns_of(space, wings, sections)
        wings, sections = ordered(columns, wings), ordered(columns, sections)
        holes = holes_of(space, grouped(columns, wings), grouped(columns, sections))
        known = [[[each[k] for k in _PLANNED] for each in column] for column in holes]
        levels = planned(space, known, first, growth)
        for wing, each, made in zip(wings, sections, levels.collars, strict=True):
            if made.sine <= 0.0 and not request.allow_invalid:
                _refuse_acute(space, wing.name, each[0])
        length = max(wing.length for wing in wings)
        span = spaced_cells(length, (first, first), growth, length / (request.surface.span - 1), 8)
        beyond = cells_for_growth(first, request.far_field * chord, growth)
        tips = tuple(_tip(wing, first) for wing in wings)
        halves = 1 if aircraft.half else 2
        return cls(tuple(wings), tuple(sections), tuple(holes), levels, tips, span, beyond, growth, halves)

    @property
    def notes(self) -> tuple[str, ...]:
        """Sentences that tell the user how sections of the wings were changed."""
        return tuple(dict.fromkeys(note for wing in self.wings for note in wing.notes))

    @property
    def cells(self) -> int:
        """Approximate number of cells."""
        columns = sum(
            (each.shape[1] - 1) * made.rows
            for each, made in zip(self.sections, self.levels.collars, strict=True)
        )
        half = (self.sections[0].shape[1] - 1) // (1 if self.wings[0].fin else 2)
        for column in self.levels.columns:
            columns += (half - column.collars[0].edge - column.collars[0].nose) * column.bands
        for each, cells in zip(self.levels.columns, self.levels.between, strict=False):
            columns += cells * (each.beside[1] + each.bands)
        for end in self.levels.ends:
            columns += (len(end.theta) - 1) * (len(end.core.rows) - 1 + end.cells) + _cells(end.core.nodes)
        filled = sum(_cells(patch) for tip in self.tips for patch in tip)
        return self.halves * (columns * (self.span + self.beyond) + filled * self.beyond)


def plan_of(
    aircraft: Aircraft, request: AircraftRequest, space: BodyMap
) -> tuple[AircraftPlan, tuple[str, ...]]:
    """Return the plan of a grid (numbers of cells, shapes of wings), and notes for the user.

    The grid has about as many cells, or nodes around wings, as requested. Raises as `AircraftPlan.of`.
    """
    if request.cells is None:
        plan = AircraftPlan.of(aircraft, request, space, request.surface.around)
        return plan, plan.notes

    def made(nodes: int, growth: float) -> AircraftPlan:
        span = request.span or round((nodes - 1) * _ALONG) + 1
        return AircraftPlan.of(aircraft, replace(request, span=span, growth=growth), space, nodes)

    for growth in (request.growth,) if request.growth else GROWTHS:
        plan = made(_TRIED[0], growth)
        if plan.cells <= request.cells:
            break
    else:
        return plan, (*plan.notes, *_too_many(plan, request.cells), *_steeper(plan, request))
    slope = (made(_TRIED[1], growth).cells - plan.cells) / (_TRIED[1] - _TRIED[0])
    half = round(0.5 * (request.cells - plan.cells) / slope)
    if half > 0:
        plan = made(_TRIED[0] + 2 * half, growth)
    return plan, (*plan.notes, *_steeper(plan, request))


def _too_many(plan: AircraftPlan, cells: int) -> Iterator[str]:
    """Yield a note if the fewest cells are clearly more than requested."""
    if plan.cells > _ENOUGH * cells:
        yield f"layers need about {plan.cells} cells, more than {cells}"


def _steeper(plan: AircraftPlan, request: AircraftRequest) -> Iterator[str]:
    """Yield a note if cells grow by more than usual so that there are few enough."""
    if request.growth is None and plan.growth != GROWTHS[0]:
        yield f"cells grow by {plan.growth:g} in place of {GROWTHS[0]:g}, so that there are fewer"


def _refuse_oblique(space: BodyMap, wing: WingLines, root: Floats) -> None:
    """Raise InputError for a wing that leans too much on its `root` (n, 3), as by sweep."""
    at, step = space.points(root), _AHEAD * space.body.length
    along_s, along_theta = (
        _unit(space.points(root + np.eye(3)[axis] * way) - at) for axis, way in ((0, step), (1, _AHEAD))
    )
    tangent = np.diff(at, axis=0, append=at[1:2])
    if wing.fin:
        tangent[-1] = tangent[-2]
    tangent = _unit(tangent)
    turns = np.stack([(tangent * each).sum(axis=1) for each in (along_s, along_theta)], axis=1)
    outwards = _unit(turns[:, 1:] * along_s - turns[:, :1] * along_theta)
    span = _unit(wing.points(np.full((1, len(root)), _AHEAD))[0] - at)
    cosines = (outwards * span).sum(axis=1)
    worst = int(cosines.argmax())
    angle = math.acos(min(float(cosines[worst]), 1.0))
    if angle < _OBLIQUE:
        x, y, z = at[worst]
        problem = (
            f"the {wing.name} meets the {space.body.name} at {math.degrees(angle):.0f} degrees, "
            f"at x={x:.6g}, y={y:.6g}, z={z:.6g}, where cells would be folded"
        )
        least = math.degrees(_OBLIQUE)
        raise InputError(problem, f"sweep it less, or move it: {least:g} degrees are needed", place="wings")


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / norms(vectors)[..., None])


def _refuse_acute(space: BodyMap, name: str, root: Floats) -> None:
    """Raise InputError for a `root` (n, 3) so near to keel or crown that collars fold."""
    angles = space.steepness(root)
    least = int(angles.argmin())
    if angles[least] < _ACUTE:
        x, y, z = space.points(root[least])
        angle = math.degrees(angles[least])
        problem = (
            f"the {name} meets the {space.body.name} at {angle:.0f} degrees, at x={x:.6g}, y={y:.6g}, "
            f"z={z:.6g}, and cells between it and the plane of symmetry are folded"
        )
        raise InputError(problem, "move it towards the axis, or make its root thinner", place="wings")


def _tip(wing: WingLines, first: float) -> tuple[Floats, Floats]:
    loop = wing.points(np.ones((1, len(wing.roots))))[0]
    if wing.fin:
        return half_tip_patches(loop, first)
    return canted_tip_patches(loop, first, wing.loft.cant)


def _cells(patch: Floats) -> int:
    return (patch.shape[0] - 1) * (patch.shape[1] - 1)


def _on_keys(space: BodyMap, wing: WingLines) -> Floats:
    """Return s, theta, zeta (SAMPLES, n, 3) around a wing on the key levels."""
    sections = space.places(wing.points(key_heights(SAMPLES)[:, None] + np.zeros(len(wing.roots))))
    sections[0, :, 2] = 0.0
    if wing.fin:
        sections[:, [0, -1], 1] = np.pi
    return sections
