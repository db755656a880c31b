"""Trailing edges of blades made from airfoils: thin ones are opened, and bases are rounded."""

from meshonet.geometry.notes import Change
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.airfoil.trailing_edge import opened_base

LEAST_EDGE = 0.01
"""Thickness in chords to which thinner trailing edges are opened, so that layers can go around them."""


def round_edged(airfoil: Airfoil) -> tuple[Airfoil, tuple[str, ...]]:
    """Return the airfoil with a round trailing edge at least `LEAST_EDGE` chords thick, and notes."""
    notes: tuple[str, ...] = ()
    body, height = airfoil, airfoil.gap / airfoil.chord
    name = airfoil.name or "a section"
    if height < LEAST_EDGE * (1.0 - 1e-9):
        body = Airfoil(opened_base(airfoil, LEAST_EDGE * airfoil.chord), airfoil.name, notes=airfoil.notes)
        change = (
            f"{name} is changed: its trailing edge, {height:.2g} chords thick, is opened to {LEAST_EDGE:g}"
        )
        notes = (Change(f"{change} and rounded"),)
    elif body.blunt:
        notes = (Change(f"{name} is changed: its base, {height:.2g} chords thick, is rounded"),)
    return body.rounded(), notes
