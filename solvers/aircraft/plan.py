"""What is planned of a grid before its nodes are made: lines of the wing, sections on key levels, counts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.aircraft.aircraft import Aircraft
from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.spacing.growth import cells_for_growth
from meshonet.solvers.aircraft.body_map import BodyMap
from meshonet.solvers.aircraft.body_plane import LevelPlan, planned
from meshonet.solvers.aircraft.request import AircraftRequest
from meshonet.solvers.aircraft.wing_lines import WingLines
from meshonet.solvers.rows.span_lines import key_heights
from meshonet.solvers.rows.span_spacing import SAMPLES, spaced_cells

GROWTH = 1.2
"""Growth of cells away from walls where none is given."""
_PLANNED = (0, 4, 8, 12, 16)
"""Key levels from which counts are taken."""
_TRIED = 49, 97
"""Nodes around a wing by which others are found; the first is the fewest."""
_ENOUGH = 1.15
"""Cells over those wanted above which a note says so."""


@dataclass(frozen=True, eq=False)
class AircraftPlan:
    """A planned grid.

    Parameters
    ----------
    wing : lines along the span.
    sections : (SAMPLES, n, 3) s, theta and zeta around the wing on the key levels.
    scales : (SAMPLES, 2) lengths in space of units of s and theta there.
    levels : counts that levels share.
    span, beyond : cells from the body to the tip, and from there to the far field.
    halves : 2 if the grid has both halves of the aircraft, else 1.
    """

    wing: WingLines
    sections: Floats
    scales: Floats
    levels: LevelPlan
    span: int
    beyond: int
    halves: int

    @classmethod
    def of(cls, aircraft: Aircraft, request: AircraftRequest, space: BodyMap, around: int) -> AircraftPlan:
        """Return the plan for `around` nodes around the wing.

        Raises InputError: a wing that does not begin inside the body or does not leave it.
        """
        chord = aircraft.wing.chord
        first, growth = request.height() * chord, request.growth or GROWTH
        wing = WingLines.of(aircraft, around, request.base)
        sections = space.places(wing.points(key_heights(SAMPLES)[:, None] + np.zeros(len(wing.roots))))
        sections[0, :, 2] = 0.0
        scales = _scales(space, sections)
        known = [(sections[k][:, :2], scales[k]) for k in _PLANNED]
        levels = planned(known, aircraft.body.length, first, growth)
        span = spaced_cells(wing.length, (first, first), growth, wing.length / (request.span - 1), 8)
        beyond = cells_for_growth(first, request.far_field * chord, growth)
        return cls(wing, sections, scales, levels, span, beyond, 1 if aircraft.half else 2)

    @property
    def cells(self) -> int:
        """About how many cells there will be; the fill of the wing's section beyond its tip is left out."""
        each, around = self.levels, self.sections.shape[1] - 1
        columns = around * each.rows + (around // 2 - each.edge - each.nose) * (each.low + each.top)
        for end in each.ends:
            a, b = end.core.nodes.shape[:2]
            columns += (len(end.theta) - 1) * (len(end.core.rows) - 1 + end.cells) + (a - 1) * (b - 1)
        return self.halves * columns * (self.span + self.beyond)


def plan_of(
    aircraft: Aircraft, request: AircraftRequest, space: BodyMap
) -> tuple[AircraftPlan, tuple[str, ...]]:
    """Return the plan of a grid with the cells or nodes that are wanted, and notes.

    Raises InputError: as `AircraftPlan.of`.
    """
    if request.cells is None:
        plan = AircraftPlan.of(aircraft, request, space, request.around)
        return plan, plan.wing.notes
    few, many = (AircraftPlan.of(aircraft, request, space, nodes) for nodes in _TRIED)
    slope = (many.cells - few.cells) / (_TRIED[1] - _TRIED[0])
    half = max(0, round(0.5 * (request.cells - few.cells) / slope)) if slope > 0.0 else 0
    plan = AircraftPlan.of(aircraft, request, space, _TRIED[0] + 2 * half) if half else few
    if plan.cells <= _ENOUGH * request.cells:
        return plan, plan.wing.notes
    note = f"layers need about {plan.cells} cells, more than {request.cells}"
    return plan, (*plan.wing.notes, note)


def _scales(space: BodyMap, sections: Floats) -> Floats:
    """Return the lengths in space (k, 2) of units of s and theta, the means over sections (k, n, 3)."""
    points = space.points(sections)
    radius = np.hypot(points[..., 1] - space.body.y, points[..., 2]).mean(axis=1)
    half = (sections.shape[1] - 1) // 2
    chord = norms(points[:, 0] - points[:, half])
    return np.stack([chord / np.abs(sections[:, 0, 0] - sections[:, half, 0]), radius], axis=1)
