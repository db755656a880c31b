"""Trailing edges of blades made from airfoils: thin ones are opened, and bases are rounded."""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import product
from meshonet.geometry.notes import Change
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil

LEAST_EDGE = 0.01
"""Thickness of trailing edges, in chords, to which thinner ones are opened: layers go around them."""


def round_edged(airfoil: Airfoil) -> tuple[Airfoil, tuple[str, ...]]:
    """Return the airfoil with a round trailing edge at least `LEAST_EDGE` chords thick, and notes."""
    notes: tuple[str, ...] = ()
    body, height = airfoil, airfoil.gap / airfoil.chord
    name = airfoil.name or "a section"
    if height < LEAST_EDGE * (1.0 - 1e-9):
        body = Airfoil(_opened(airfoil, LEAST_EDGE * airfoil.chord), airfoil.name, notes=airfoil.notes)
        change = (
            f"{name} is changed: its trailing edge, {height:.2g} chords thick, is opened to {LEAST_EDGE:g}"
        )
        notes = (Change(f"{change} and rounded"),)
    elif body.blunt:
        notes = (Change(f"{name} is changed: its base, {height:.2g} chords thick, is rounded"),)
    return body.rounded(), notes


def _opened(airfoil: Airfoil, gap: float) -> Floats:
    """Return points (n, 2) with the sides moved apart in proportion to the distance from the leading edge."""
    curve = airfoil.curve
    _, nose, _ = airfoil._arcs
    lower = curve.points[(curve.knots > 0.0) & (curve.knots < nose)]
    upper = curve.points[curve.knots > nose]
    ends = [curve.points[:1], curve.points[:1]]
    if airfoil.blunt:
        ends = [lower[:0], upper[:0]]
    chord = airfoil.trailing_edge - airfoil.leading_edge
    normal = np.array([-chord[1], chord[0]]) / airfoil.chord
    missing = 0.5 * (gap - airfoil.gap)
    sides = []
    for side, sign in ((np.concatenate([ends[0], lower]), -1.0), (np.concatenate([upper, ends[1]]), 1.0)):
        along = product(side - airfoil.leading_edge, chord) / airfoil.chord**2
        sides.append(side + sign * missing * np.clip(along, 0.0, None)[:, None] * normal)
    return np.concatenate([sides[0], airfoil.leading_edge[None], sides[1]])
