"""Blank-separated numbers of a text, all at once."""

from __future__ import annotations

import warnings

import numpy as np

from meshonet.geometry.arrays import Floats


def parsed(text: bytes) -> Floats | None:
    """Return the numbers of blank-separated `text`, or None when there is something else in it.

    Examples
    --------
    >>> parsed(b"1 2.5 -3e2").tolist(), parsed(b"1 two")
    ([1.0, 2.5, -300.0], None)
    """
    with warnings.catch_warnings():
        # numpy announces text it cannot parse by a DeprecationWarning that is to become a ValueError
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(text, dtype=np.float64, sep=" ") if text.strip() else np.empty(0)
        except (DeprecationWarning, ValueError):
            return None
