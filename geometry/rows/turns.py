"""Profiles of one blade that are given a whole pitch or a whole turn apart around the axis."""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Floats

_WHOLE = 0.2
"""Part of the pitch by which a displacement may differ from whole pitches: more is lean of the blade."""


def whole_pitches(angles: Floats, heights: Floats, pitch: float) -> Floats:
    """Return how many pitches (p,) profiles lie away from the blade that most of them are of.

    A step from one profile to the next is a displacement if it exceeds the lean between other profiles by
    whole pitches, since blades may lean by more than a pitch.

    Parameters
    ----------
    angles : (p,) theta of the profiles in radians, on average.
    heights : (p,) their places along the span, ascending.
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
