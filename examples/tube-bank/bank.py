"""A cell of a staggered tube bank as GeoJSON: a tube in the middle, quarters of four others at the corners.

python examples/tube-bank/bank.py bank.geojson --across 1.8 --along 1.5

The pitches are in diameters of the tubes: across between tubes of a row, along between one row and the next.
The sides are called left, right, bottom and top, the tubes tube and tubes.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]


def arc(x: float, y: float, radius: float, first: float, last: float, cells: int) -> Points:
    """Return points (cells + 1, 2) along an arc between two angles in degrees."""
    at = np.radians(np.linspace(first, last, cells + 1))
    return np.round(np.stack([x + radius * np.cos(at), y + radius * np.sin(at)], axis=1), 12)


def rings(length: float, height: float, radius: float) -> tuple[list[Points], list[int], list[str]]:
    """Return the rings of a cell from (0, 0) to (length, height), corners of the outer one, and its names."""
    r = radius
    parts = [
        ("bottom", np.array([[r, 0.0], [length - r, 0.0]])),
        ("tubes", arc(length, 0.0, r, 180.0, 90.0, 24)),
        ("right", np.array([[length, r], [length, height - r]])),
        ("tubes", arc(length, height, r, 270.0, 180.0, 24)),
        ("top", np.array([[length - r, height], [r, height]])),
        ("tubes", arc(0.0, height, r, 0.0, -90.0, 24)),
        ("left", np.array([[0.0, height - r], [0.0, r]])),
        ("tubes", arc(0.0, 0.0, r, 90.0, 0.0, 24)),
    ]
    counts = [len(points) - 1 for _, points in parts]
    corners = np.cumsum([0, *counts[:-1]]).tolist()
    outer = np.concatenate([points[:-1] for _, points in parts])
    tube = arc(0.5 * length, 0.5 * height, r, 0.0, 360.0, 96)[:-1]
    return [outer, tube], corners, [name for name, _ in parts]


def feature(length: float, height: float, radius: float, **properties: object) -> str:
    """Return the cell as a GeoJSON feature, with more `properties` such as the pairs of periodic sides."""
    (outer, tube), corners, names = rings(length, height, radius)
    facts = {"names": [names, "tube"], "corners": [corners, []], **properties}
    closed = [[*ring.tolist(), ring[0].tolist()] for ring in (outer, tube)]
    shape = {"type": "Polygon", "coordinates": closed}
    return json.dumps({"type": "Feature", "properties": facts, "geometry": shape})


def main() -> None:
    """Write the cell."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("file", type=Path, help="GeoJSON file to write")
    parser.add_argument("--across", type=float, default=1.8, help="pitch across the flow in diameters")
    parser.add_argument("--along", type=float, default=1.5, help="pitch from row to row in diameters")
    parser.add_argument("--diameter", type=float, default=1.0, help="diameter of the tubes")
    options = parser.parse_args()
    sizes = (
        2.0 * options.along * options.diameter,
        options.across * options.diameter,
        0.5 * options.diameter,
    )
    options.file.write_text(feature(*sizes))


if __name__ == "__main__":
    main()
