"""Cells at the nose of a section, so short that the outline turns little between them."""

import math

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import geomspace
from meshonet.geometry.polygon.corners import angle_between
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil

TURN = math.radians(15.0)  # angle between neighbouring cells at a nose, within the next two bounds
MOST = 0.35  # length of the longest cells at a nose, in mean cells of a side
_LEAST = 90.0  # shortest length, in mean cells, times the square of their number: few cells grow little
_FEWEST = 24  # fewest cells on a side with which nose cells follow the curvature; volumes of fewer could fold
_ROUND = math.radians(25.0)  # angle between nose cells above which a note names a remedy
_SHORTEST = 1.0 / 64.0  # ratio of the shortest spacing that a note recommends to that of the shortest cells
_TRIED = 33  # lengths that are tried
_BESIDE = 4  # cells on each side of the nose whose angles count


def nose_cell(shape: Airfoil, cells: int) -> float | None:
    """Return the length in chords of cells at a section's nose; None if it has too few `cells` per side."""
    return float(np.interp(TURN, *_turns(shape, cells, 1.0))) if cells >= _FEWEST else None


def nose_note(shape: Airfoil, cells: int, nose: float | None) -> str:
    """Return a note if the angle between nose cells is large and shorter cells would reduce it, else ''.

    `cells` is the number of cells on a side, `nose` a prescribed length of nose cells in chords.
    """
    turns, lengths = _turns(shape, cells, _SHORTEST)
    turn = float(np.interp(nose or nose_cell(shape, cells) or lengths[-1], lengths, turns))
    if turn <= _ROUND or turns[0] > TURN:
        return ""
    helps = float(np.interp(TURN, turns, lengths))
    return (
        f"neighbouring cells at the nose of {shape.name or 'a section'} turn by up to "
        f"{math.degrees(turn):.0f} degrees; le_spacing = {helps:.1g} makes this about "
        f"{math.degrees(TURN):.0f}, with more nodes {{around}} cells there grow less"
    )


def _turns(shape: Airfoil, cells: int, part: float) -> tuple[Floats, Floats]:
    """Return the largest angles (k,) between nose cells of different lengths (k,), in chords, both ascending.

    The shortest is `part` of the shortest default length.
    """
    mean = 0.5 * (shape.upper_end - shape.half_base) / (cells * shape.unit)
    lengths = geomspace(part * min(_LEAST / cells**2, MOST) * mean, MOST * mean, _TRIED)
    places = shape.nose_arc + shape.unit * lengths[:, None] * np.arange(-_BESIDE, _BESIDE + 1)
    steps = np.diff(shape.curve.at(places.ravel()).reshape(*places.shape, 2), axis=1)
    turns = np.abs(angle_between(steps[:, :-1], steps[:, 1:])).max(axis=1)
    return np.maximum.accumulate(turns), lengths
