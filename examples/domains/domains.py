"""Thirty domains that engineers draw, and random ones: lists of loops (n, 2), the outer one first.

python examples/domains/domains.py FOLDER     writes each as GeoJSON into FOLDER
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Loop = NDArray[np.float64]


def circle(x: float, y: float, radius: float, points: int = 96, squash: float = 1.0) -> Loop:
    """Return a circle, or an ellipse `squash` times as high as wide."""
    turn = 2.0 * np.pi * np.arange(points) / points
    return np.stack([x + radius * np.cos(turn), y + squash * radius * np.sin(turn)], axis=1)


def box(left: float, right: float, bottom: float, top: float) -> Loop:
    """Return a rectangle."""
    return np.array([[left, bottom], [right, bottom], [right, top], [left, top]], dtype=float)


def polygon(*coordinates: float) -> Loop:
    """Return the polygon through x, y, x, y ..."""
    return np.array(coordinates, dtype=float).reshape(-1, 2)


def regular(corners: int, radius: float = 1.0, turn: float = 0.0) -> Loop:
    """Return a regular polygon."""
    angle = 2.0 * np.pi * np.arange(corners) / corners + turn
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def arc(x: float, y: float, radius: float, first: float, last: float, points: int = 24) -> Loop:
    """Return points on an arc between two angles in degrees, both included."""
    turn = np.radians(np.linspace(first, last, points))
    return np.stack([x + radius * np.cos(turn), y + radius * np.sin(turn)], axis=1)


def naca4(thickness: float, camber: float = 0.0, at: float = 0.4, points: int = 81) -> Loop:
    """Return a NACA four-digit section of chord 1 with a sharp edge, counter-clockwise from it."""
    x = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, points)))
    half = 5.0 * thickness * (
        0.2969 * np.sqrt(x) - 0.1260 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4
    )  # fmt: skip
    front, rear = (
        camber / at**2 * (2 * at * x - x**2),
        camber / (1 - at) ** 2 * (1 - 2 * at + 2 * at * x - x**2),
    )
    mean = np.where(x < at, front, rear)
    upper, lower = np.stack([x, mean + half], axis=1), np.stack([x, mean - half], axis=1)
    return np.concatenate([upper[::-1], lower[1:-1]])


def moved(loop: Loop, degrees: float, scale: float, x: float, y: float) -> Loop:
    """Return a loop turned clockwise, scaled and moved."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return scale * loop @ np.array([[c, -s], [s, c]]) + np.array([x, y])


def gear(teeth: int, root: float = 1.0, tip: float = 1.25) -> Loop:
    """Return a gear wheel of trapezoidal teeth."""
    points = []
    for k in range(teeth):
        start, pitch = 2.0 * np.pi * k / teeth, 2.0 * np.pi / teeth
        for part, radius in ((0.0, root), (0.25, root), (0.5, root), (0.58, tip), (0.75, tip), (0.92, tip)):
            angle = start + part * pitch
            points.append((radius * np.cos(angle), radius * np.sin(angle)))
    return np.array(points)


def hills(points: int = 60) -> Loop:
    """Return a channel between two sinusoidal hills."""
    x = np.linspace(0.0, 6.0, points)
    floor = 0.6 * np.exp(-((x - 1.5) ** 2) / 0.4) + 0.4 * np.exp(-((x - 4.2) ** 2) / 0.3)
    return np.concatenate([np.stack([x, floor], axis=1), [[6.0, 2.0], [0.0, 2.0]]])


def nozzle(points: int = 50) -> Loop:
    """Return a nozzle with a throat, walls above and below."""
    x = np.linspace(0.0, 4.0, points)
    half = 1.0 - 0.6 * np.exp(-((x - 1.5) ** 2) / 0.35)
    return np.concatenate([np.stack([x, -half], axis=1), np.stack([x, half], axis=1)[::-1]])


def _bend() -> Loop:
    outer, inner = arc(0.0, 0.0, 2.0, -90.0, 0.0), arc(0.0, 0.0, 1.0, 0.0, -90.0)
    return np.concatenate(
        [polygon(-2.0, -2.0), outer, polygon(2.0, 2.0, 1.0, 2.0), inner, polygon(-2.0, -1.0)]
    )


def _keyhole() -> Loop:
    return np.concatenate([arc(0.0, 0.0, 1.0, -60.0, 240.0, 60), polygon(-0.5, -3.0, 0.5, -3.0)])


DOMAINS: dict[str, Callable[[], list[Loop]]] = {
    "channel-cylinder": lambda: [box(0.0, 2.2, 0.0, 0.41), circle(0.2, 0.2, 0.05)],
    "backward-step": lambda: [polygon(0, 1, 4, 1, 4, 0, 14, 0, 14, 2, 0, 2)],
    "forward-step": lambda: [polygon(0, 0, 0.6, 0, 0.6, 0.2, 3, 0.2, 3, 1, 0, 1)],
    "tee": lambda: [polygon(0, 0, 3, 0, 3, 1, 2, 1, 2, 3, 1, 3, 1, 1, 0, 1)],
    "u-bend": lambda: [polygon(0, 0, 3, 0, 3, 3, 2, 3, 2, 1, 1, 1, 1, 3, 0, 3)],
    "y-junction": lambda: [polygon(-0.5, -2, 0.5, -2, 0.5, 0, 2.2, 1.7, 1.5, 2.4, 0, 0.9, -1.5, 2.4, -2.2, 1.7, -0.5, 0)],
    "cavity": lambda: [polygon(0, 0, 2, 0, 2, -1, 3, -1, 3, 0, 5, 0, 5, 1, 0, 1)],
    "pipe-section": lambda: [circle(0.0, 0.0, 1.0)],
    "elliptic-duct": lambda: [circle(0.0, 0.0, 2.0, 128, 0.5)],
    "plate-one-hole": lambda: [box(-2, 2, -1, 1), circle(0, 0, 0.4)],
    "plate-four-holes": lambda: [box(-2, 2, -2, 2), *(circle(x, y, 0.35) for x in (-1, 1) for y in (-1, 1))],
    "plate-slot": lambda: [box(-3, 3, -1.5, 1.5), np.concatenate([arc(1, 0, 0.4, -90, 90), arc(-1, 0, 0.4, 90, 270)])],
    "two-cylinders": lambda: [box(-3, 6, -2, 2), circle(0, 0, 0.5), circle(2.0, 0.3, 0.5)],
    "tube-bank": lambda: [box(-1.5, 3.5, -1.5, 1.5), circle(0, -0.7, 0.3), circle(0, 0.7, 0.3), circle(1, 0, 0.3), circle(2, -0.7, 0.3), circle(2, 0.7, 0.3)],
    "eccentric-annulus": lambda: [circle(0, 0, 1.0, 128), circle(0.3, 0.1, 0.4)],
    "square-in-tunnel": lambda: [box(-3, 7, -3, 3), box(-0.5, 0.5, -0.5, 0.5)],
    "diamond-in-tunnel": lambda: [box(-3, 6, -3, 3), polygon(-0.6, 0, 0, -0.6, 0.6, 0, 0, 0.6)],
    "airfoil-in-tunnel": lambda: [box(-1.5, 3.0, -1.5, 1.5), moved(naca4(0.12), 4.0, 1.0, 0.0, 0.0)],
    "two-elements": lambda: [box(-2, 4, -2, 2), naca4(0.12, 0.03), moved(naca4(0.12, 0.04), 25.0, 0.3, 0.985, -0.05)],
    "bluff-body": lambda: [box(-2, 5, -0.3, 2), np.concatenate([polygon(1.2, 0.1, 1.2, 0.45, 1.05, 0.6), arc(0.2, 0.45, 0.15, 90, 180, 8), arc(0.15, 0.2, 0.1, 180, 270, 8)])],
    "bend": lambda: [_bend()],
    "hills": lambda: [hills()],
    "nozzle": lambda: [nozzle()],
    "hexagon": lambda: [regular(6)],
    "triangle": lambda: [polygon(0, 0, 2, 0, 0.7, 1.6)],
    "star": lambda: [np.stack([np.where(np.arange(10) % 2, 0.5, 1.2)] * 2, axis=1) * regular(10, 1.0, np.pi / 2)],
    "keyhole": lambda: [_keyhole()],
    "half-disc": lambda: [arc(0, 0, 1.0, 0, 180, 60)],
    "gear": lambda: [gear(8), circle(0, 0, 0.4, 48)],
    "stator-slot": lambda: [polygon(0, 0, 4, 0, 4, 1, 2.4, 1, 2.6, 1.4, 2.6, 3, 1.4, 3, 1.4, 1.4, 1.6, 1, 0, 1)],
}  # fmt: skip
"""By name; units are of no matter."""


def random_domain(seed: int) -> list[Loop]:
    """Return a random domain of 0 to 5 holes: polygons for even seeds, smooth outlines for odd ones."""
    rng = np.random.default_rng(seed)
    smooth, holes = bool(seed % 2), (seed // 2) % 6
    outer = _blob(rng, 1.0, 160) if smooth else _ragged(rng, int(rng.integers(5, 11)), 1.0)
    loops = [outer]
    for _ in range(4000):
        if len(loops) > holes:
            break
        size = rng.uniform(0.1, 0.28) / (1.0 + 0.15 * holes)
        hole = _blob(rng, size, 64) if smooth else _ragged(rng, int(rng.integers(3, 7)), size)
        hole = hole + rng.uniform(-1.0, 1.0, 2)
        dense = _dense(hole)
        if not _inside(outer, dense).all() or _gap(outer, dense) < 0.1:
            continue
        if all(_gap(each, dense) > 0.1 and not _inside(each, hole).any() for each in loops[1:]):
            loops.append(hole)
    return loops


def _blob(rng: np.random.Generator, radius: float, points: int) -> Loop:
    turn = 2.0 * np.pi * np.arange(points) / points
    size = 1.0 + sum(
        0.25 / k * rng.normal() * np.cos(k * turn + rng.uniform(0.0, 2.0 * np.pi)) for k in range(2, 6)
    )
    size = np.clip(size, 0.4, 1.8)
    return radius * np.stack([size * np.cos(turn), size * np.sin(turn)], axis=1)


def _ragged(rng: np.random.Generator, corners: int, radius: float) -> Loop:
    turn = 2.0 * np.pi * (np.arange(corners) + rng.uniform(-0.33, 0.33, corners)) / corners
    size = radius * rng.uniform(0.6, 1.3, corners)
    return np.stack([size * np.cos(turn), size * np.sin(turn)], axis=1)


def _dense(loop: Loop) -> Loop:
    part = np.linspace(0.0, 1.0, 8, endpoint=False)[:, None, None]
    return np.asarray((loop * (1.0 - part) + np.roll(loop, -1, axis=0) * part).reshape(-1, 2))


def _gap(loop: Loop, points: Loop) -> float:
    return float(np.hypot(*(_dense(loop)[:, None] - points).transpose(2, 0, 1)).min())


def _inside(loop: Loop, points: Loop) -> NDArray[np.bool_]:
    a, b = loop[:, None], np.roll(loop, -1, axis=0)[:, None]
    spans = (a[..., 1] > points[:, 1]) != (b[..., 1] > points[:, 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        x = a[..., 0] + (points[:, 1] - a[..., 1]) / (b[..., 1] - a[..., 1]) * (b[..., 0] - a[..., 0])
    return np.asarray((spans & (points[:, 0] < x)).sum(axis=0) % 2 == 1)


def geojson(loops: list[Loop], name: str) -> str:
    """Return the text of a GeoJSON feature."""
    rings = [np.concatenate([loop, loop[:1]]).tolist() for loop in loops]
    feature = {
        "type": "Feature",
        "properties": {"name": name},
        "geometry": {"type": "Polygon", "coordinates": rings},
    }
    return json.dumps(feature) + "\n"


def write_all(folder: Path, seeds: range = range(0)) -> list[Path]:
    """Write every named domain, and the random ones of `seeds`, into a folder; return the files."""
    folder.mkdir(parents=True, exist_ok=True)
    named = {name: make() for name, make in DOMAINS.items()}
    named |= {f"random-{seed:03d}": random_domain(seed) for seed in seeds}
    for name, loops in named.items():
        (folder / f"{name}.geojson").write_text(geojson(loops, name), encoding="utf-8")
    return [folder / f"{name}.geojson" for name in named]


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, help="where each domain is written as GeoJSON")
    for path in write_all(parser.parse_args().folder):
        print(path)
