"""Profiles of one blade that are whole pitches or turns apart."""

import numpy as np

from meshonet.geometry.arrays import Floats

_WHOLE = 0.2  # largest deviation of a displacement from whole pitches; beyond it the blade leans


def whole_pitches(angles: Floats, heights: Floats, pitch: float) -> Floats:
    """Return the number of pitches (p,) between each profile and the blade of most profiles.

    A step of theta counts only if it exceeds the lean between other profiles by whole pitches.

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
