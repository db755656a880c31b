"""Airfoil coordinate files as found in the wild."""

from __future__ import annotations

import re

import numpy as np

from geometry.airfoil import Airfoil
from geometry.errors import InputError

_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d+)?")


def parse(text: str, source: str) -> Airfoil:
    """Return the airfoil that the text of a coordinate file describes."""
    name, rows = "", []
    for line in text.splitlines():
        words = line.replace(",", " ").replace("(", " ").replace(")", " ").split()
        if len(words) == 2 and all(_NUMBER.fullmatch(word) for word in words):
            rows.append([float(word.lower().replace("d", "e")) for word in words])
        elif not rows and not name:
            name = line.strip()
    if len(rows) < 6:
        raise InputError(f"{len(rows)} coordinate pairs", "an airfoil needs at least 6", source=source)
    points = np.array(rows)
    if points[0, 0] > 1.5 and points[0, 1] > 1.5:
        n = round(points[0, 0])
        upper, lower = points[1 : n + 1], points[n + 1 :]
        points = np.concatenate([upper[::-1], lower])
    keep = np.concatenate([[True], np.hypot(*np.diff(points, axis=0).T) > 1e-9])
    return Airfoil(points[keep], name or source)
