"""First-cell height of a boundary layer, with the skin friction of a flat plate."""

import math

from meshonet.geometry.errors import InputError
from meshonet.geometry.notes import ExactHeights

FORMULA = "y = y+ c / (Re sqrt(Cf/2)), Cf = (2 log10(Re x/c) - 0.65)^-2.3"
SOURCE = "Schlichting, Boundary-Layer Theory, 7th ed. (1979), chapter XXI"
SAME = 1e-6  # largest relative difference of heights that count as the requested ones


def first_cell(y_plus: float, reynolds: float, chord_fraction: float = 0.5) -> float:
    """Return the distance from the wall, in chords, at which y+ has the value `y_plus`.

    The wall is a flat plate with turbulent flow, x = `chord_fraction` chords behind its leading edge: y+ = y
    u_τ/ν, u_τ/U = √(C_f/2), C_f = (2 log₁₀ Re_x - 0.65)^-2.3 (`SOURCE`). `reynolds` is based on the chord.
    Raises InputError: a value out of range, or x too small for a turbulent boundary layer.

    >>> f"{first_cell(1.0, 6e6):.3g}"
    '4.23e-06'
    """
    if not 0 < y_plus <= 1e4:
        raise InputError(f"a y+ of {y_plus:g}", "use more than 0 and at most 1e4", parameter="y_plus")
    if not 1e3 <= reynolds <= 1e12:
        raise InputError(f"a Reynolds number of {reynolds:g}", "use 1e3 to 1e12", parameter="reynolds")
    local, part = reynolds * chord_fraction, f"{chord_fraction:g} of the chord"
    if not 0 < chord_fraction <= 1:
        raise InputError(part, "use more than 0 and at most 1", parameter="chord_fraction")
    if local < 1e3:
        remedy = "use a larger part, so that it is 1e3 or more"
        raise InputError(f"a Reynolds number of {local:g} at {part}", remedy, parameter="chord_fraction")
    friction = math.pow(2.0 * math.log10(local) - 0.65, -2.3)
    return y_plus / (reynolds * math.sqrt(0.5 * friction))


def height_note(y_plus: str, reynolds: float | None, where: str, height: str) -> str:
    """Return a note on how the first-cell `height` follows from y+; `where` names the reference length."""
    cells = f"needs first cells of height {height}; y+ at their centres is half of that"
    return f"y+ {y_plus} at Re {reynolds:g} {where} {cells}. Formula: {FORMULA} ({SOURCE})"


def first_cell_note(
    low: float, high: float, target: float, growth: float | None, where: str = "wall node", chord: float = 1.0
) -> str:
    """Return a sentence that compares first-cell heights, from `low` to `high`, with the height `target`.

    `growth` is the mean growth ratio off the wall. `where` is a name for the nodes. Unless `chord` is 1,
    `target` is also given in chords.
    """
    size = (
        f"{target:.6g}"
        if chord == 1.0
        else f"{target:.6g} in the unit of the points ({target / chord:.6g} chords)"
    )
    if max(abs(low / target - 1.0), abs(high / target - 1.0)) > SAME:
        return f"first cells are {low:.3g} to {high:.3g} instead of {size}"
    rows = "" if growth is None else f"; the mean growth ratio is {growth:.3f}"
    return ExactHeights(f"the first-cell height is {size} at every {where}{rows}")
