"""Domains with periodic sides, made here."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.ring import ring_loop

LENGTH, HEIGHT, RADIUS = 2.0, 1.2, 0.3
BOTH = (("left", "right"), ("bottom", "top"))


def circle(x: float, y: float, radius: float, first: float = 0.0, last: float = 360.0, cells: int = 96):
    """Return points (cells + 1, 2) along an arc between two angles in degrees."""
    at = np.radians(np.linspace(first, last, cells + 1))
    return np.round(np.stack([x + radius * np.cos(at), y + radius * np.sin(at)], axis=1), 12)


def bank_rings():
    """Return the rings of a cell of a staggered tube bank, its corners and names: quarter tubes, one tube."""
    long, high, r = LENGTH, HEIGHT, RADIUS
    parts = [
        ("bottom", np.array([[r, 0.0], [long - r, 0.0]])),
        ("tubes", circle(long, 0.0, r, 180.0, 90.0, 24)),
        ("right", np.array([[long, r], [long, high - r]])),
        ("tubes", circle(long, high, r, 270.0, 180.0, 24)),
        ("top", np.array([[long - r, high], [r, high]])),
        ("tubes", circle(0.0, high, r, 0.0, -90.0, 24)),
        ("left", np.array([[0.0, high - r], [0.0, r]])),
        ("tubes", circle(0.0, 0.0, r, 90.0, 0.0, 24)),
    ]
    counts = [len(points) - 1 for _, points in parts]
    corners = np.cumsum([0, *counts[:-1]]).tolist()
    outer = np.concatenate([points[:-1] for _, points in parts])
    return [outer, circle(0.5 * long, 0.5 * high, r)[:-1]], corners, [name for name, _ in parts]


def bank() -> Domain:
    """Return a cell of a staggered tube bank."""
    (outer, tube), corners, names = bank_rings()
    return Domain(
        (
            ring_loop(outer, hole=False, corners=corners, names=names),
            ring_loop(tube, hole=True, names=["tube"]),
        ),
        "bank",
    )


def parallelogram(skew: float = 0.4, tube: tuple[float, float] = (0.9, 0.45)) -> Domain:
    """Return a sheared box with a tube that lies nowhere in particular, its lower left side at (0.1, 0.2)."""
    box = np.array([[0.0, 0.0], [1.7, 0.0], [1.7 + skew, 1.1], [skew, 1.1]]) + np.array([0.1, 0.2])
    sides = ["bottom", "right", "top", "left"]
    return Domain.of_polygons([box, circle(*tube, 0.21)[:-1]], "sheared", [sides, "tube"])


def write_bank(path: Path, periodic: object = BOTH) -> None:
    """Write the tube bank as GeoJSON."""
    (outer, tube), corners, names = bank_rings()
    facts = {"names": [names, "tube"], "corners": [corners, []], "periodic": periodic}
    if periodic is None:
        del facts["periodic"]
    rings = [[*ring.tolist(), ring[0].tolist()] for ring in (outer, tube)]
    feature = {"type": "Feature", "properties": facts, "geometry": {"type": "Polygon", "coordinates": rings}}
    path.write_text(json.dumps(feature))
