"""Wall cells on both sides of a base corner: if their sizes differ much, cells off the corner grow fast."""

import numpy as np

from meshonet.geometry.arrays import Floats

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
