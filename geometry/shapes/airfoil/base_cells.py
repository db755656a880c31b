"""Notes on blunt bases: how they were changed, and where cell sizes jump at their corners."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.notes import Change

if TYPE_CHECKING:
    from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
    from meshonet.geometry.spacing.sampling import TrailingEdge

UNLIKE = 1.5
"""Ratio of the two wall cells at a corner of the base beyond which it is noted."""


def base_note(wall: Floats, corner: Floats, base: float, chord: float) -> tuple[str, ...]:
    """Return a note if wall cell sizes jump at the lower corner of a base; the upper corner mirrors it.

    `wall` (n, 2) runs from the middle of the base, which has length `base` and ends at `corner` (2,).
    """
    k = int(np.argmin(np.hypot(*(wall[: len(wall) // 2] - corner).T)))
    if k == 0:
        return ()
    on, beside = (float(np.hypot(*(wall[i + 1] - wall[i]))) for i in (k - 1, k))
    ratio = beside / on
    if 1.0 / UNLIKE <= ratio <= UNLIKE:
        return ()
    times, word = (ratio, "smaller") if ratio > 1.0 else (1.0 / ratio, "larger")
    return (
        f"cells on the base are {times:.2g} times {word} than those beside it: use {{te_spacing}} near "
        f"{base / (2 * k) / chord:.2g}, the base over its {2 * k} cells, or {{te}} round",
    )


def edge_notes(before: Airfoil, after: Airfoil, te: TrailingEdge, asked: TrailingEdge) -> tuple[str, ...]:
    """Return a note on how `te` changed a base, or that there is none although a change was `asked` for."""
    base = f"the outline is changed: its base, {before.gap / before.chord:.3g} chords wide,"
    if before.blunt and te == "wedge":
        length = float(np.hypot(*(after.trailing_edge - before.trailing_edge))) / before.chord
        return (Change(f"{base} is closed by a wedge {length:.3g} chords long"),)
    if before.blunt and te == "round":
        return (Change(f"{base} is rounded at its corners"),)
    if not before.blunt and asked in ("round", "wedge"):
        return (f"{{te}} {te} changes nothing, as the trailing edge is not blunt",)
    return ()
