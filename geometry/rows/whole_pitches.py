"""Profiles of one blade that are whole pitches or turns apart."""

import numpy as np

from meshonet.geometry.arrays import Floats

_WHOLE = 0.2  # largest deviation of a displacement from whole pitches; beyond it the blade leans


def whole_pitches(angles: Floats, heights: Floats, pitch: float) -> Floats:
    """Return by how many pitches (p,) each profile is away from the blade to which most profiles belong.

    A step of theta between two profiles counts only if whole pitches remain after subtraction of the lean
    between other profiles.

    Parameters
    ----------
    angles : (p,) mean theta of each profile in radians.
    heights : (p,) ascending positions of the profiles along the span.
    pitch : angle from blade to blade.
    """
    steps, rises = np.diff(angles), np.diff(heights)
    away = np.zeros(len(angles))
    for k, step in enumerate(steps):
        lean = np.append(np.delete(steps / rises, k) * rises[k], 0.0)
        off = (step - lean)[np.abs(step - lean).argmin()] / pitch
        whole = np.rint(off)
        if abs(off - whole) < _WHOLE:
            away[k + 1 :] += whole
    return np.asarray(away - np.sort(away)[(len(away) - 1) // 2])
