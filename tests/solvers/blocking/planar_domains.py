"""Domains that tests of the decomposition share: polygons and smooth loops with holes."""

import numpy as np

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.to_grid import to_grid
from meshonet.solvers.blocking.block_grid import fine_layout
from meshonet.solvers.blocking.decomposition.decompose import decompose


def circle(x: float, y: float, radius: float, count: int = 120, squash: float = 1.0) -> np.ndarray:
    angle = 2.0 * np.pi * np.arange(count) / count
    return np.stack([x + radius * np.cos(angle), y + squash * radius * np.sin(angle)], axis=1)


def box(left: float, right: float, low: float, high: float) -> np.ndarray:
    return np.array([[left, low], [right, low], [right, high], [left, high]], dtype=float)


def polygon(*coordinates: float) -> np.ndarray:
    return np.array(coordinates, dtype=float).reshape(-1, 2)


def blob(seed: int, radius: float = 1.0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    angle = 2.0 * np.pi * np.arange(160) / 160
    r = np.ones(160)
    for k in range(2, 6):
        r += 0.25 / k * rng.normal() * np.cos(k * angle + rng.uniform(0.0, 6.3))
    r = radius * np.clip(r, 0.35, 2.0)
    return np.stack([r * np.cos(angle), r * np.sin(angle)], axis=1)


def spiky(seed: int, count: int = 8) -> np.ndarray:
    rng = np.random.default_rng(seed)
    angle = (np.arange(count) + rng.uniform(-0.35, 0.35, count)) * 2.0 * np.pi / count
    radius = rng.uniform(0.6, 1.3, count)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


def wedge(degrees: float) -> np.ndarray:
    a = np.radians(degrees)
    return polygon(0, 0, 1, 0, np.cos(a), np.sin(a))


SHAPES = {
    "rectangle": [box(0, 2, 0, 1)],
    "step": [polygon(0, 0.5, 1, 0.5, 1, 0, 4, 0, 4, 1, 0, 1)],
    "tilted L": [polygon(0, 0, 2, 0.4, 1.8, 1.4, 0.8, 1.2, 0.6, 2.2, -0.4, 2.0)],
    "disc": [circle(0, 0, 1)],
    "ellipse": [circle(0, 0, 1, squash=0.5)],
    "annulus": [circle(0, 0, 1), circle(0.1, 0.05, 0.4)],
    "cylinder in a channel": [box(-2, 6, -2, 2.1), circle(0, 0, 0.5, 80)],
    "two holes": [box(0, 4, 0, 2), circle(1.2, 1, 0.4, 60), box(2.4, 3.0, 0.6, 1.3)],
    "five holes": [circle(0, 0, 2), *(circle(np.cos(a), np.sin(a), 0.25, 40) for a in np.arange(5) * 1.2566)],
    "hexagon": [circle(0, 0, 1, 6)],
    "triangle": [wedge(60)],
    "needle": [wedge(12)],
    "thin needle": [wedge(6)],
    "star": [np.repeat([1.0, 0.45], 1)[np.arange(10) % 2][:, None] * circle(0, 0, 1, 10)],
    "blob": [blob(3)],
    "blob with a blob": [blob(5, 1.5), blob(8, 0.35)],
    "spiky": [spiky(2)],
    "spiky with a hole": [spiky(7, 9), circle(0, 0, 0.2, 40)],
    "slit": [box(-1, 2, -1, 1), polygon(0, 0, 0.5, 0.06, 1, 0, 0.5, -0.06)],
}


def domain(name: str) -> Domain:
    return Domain.of_polygons(SHAPES[name], name)


def block_grid(domain: Domain, cells: int) -> tuple[Grid, Layout]:
    """Return the grid of the blocks of a domain, and the layout that it is made of."""
    layout = fine_layout(decompose(domain), cells=cells)
    return to_grid(layout), layout
