"""Domains with periodic sides, made here."""

import runpy
from pathlib import Path

import numpy as np

from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.ring import ring_loop

LENGTH, HEIGHT, RADIUS = 2.0, 1.2, 0.3
BANK = runpy.run_path(str(Path(__file__).parents[1] / "examples" / "tube-bank" / "bank.py"))
BOTH = (("left", "right"), ("bottom", "top"))


def circle(x: float, y: float, radius: float, first: float = 0.0, last: float = 360.0, cells: int = 96):
    """Return points (cells + 1, 2) along an arc between two angles in degrees."""
    at = np.radians(np.linspace(first, last, cells + 1))
    return np.round(np.stack([x + radius * np.cos(at), y + radius * np.sin(at)], axis=1), 12)


def bank_rings():
    """Return the rings of a cell of a staggered tube bank, its corners and names: quarter tubes, one tube."""
    return BANK["rings"](LENGTH, HEIGHT, RADIUS)


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
    more = {} if periodic is None else {"periodic": periodic}
    path.write_text(BANK["feature"](LENGTH, HEIGHT, RADIUS, **more))
