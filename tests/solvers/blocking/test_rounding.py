"""Blocks of symmetric domains are the same when their coordinates change in the last digits."""

import numpy as np
import pytest
from planar_domains import block_grid

from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.solvers.blocking.decomposition.collapse.collapse import irregular_inside

TURN = -2 * np.pi * np.arange(96) / 96


def box(half, high):
    return np.array([[-half, -high], [half, -high], [half, high], [-half, high]])


def circle(x, y, radius):
    return np.c_[x + radius * np.cos(TURN), y + radius * np.sin(TURN)]


def loop(ring):
    """Straight sides between few points, a smooth curve through many."""
    if len(ring) < 9:
        return Loop.of_polygon(ring, tuple(range(len(ring))), ("straight",))
    return Loop(Curve(ring, closed=True, corners=()), (), ("smooth",))


HEXAGON = np.c_[np.cos(np.radians(60 * np.arange(6))), np.sin(np.radians(60 * np.arange(6)))]
SYMMETRIC = {
    "hexagon": [HEXAGON],
    "plate with a hole": [box(1, 1), circle(0, 0, 0.4)],
    "plate with four holes": [box(2, 2), *(circle(x, y, 0.4) for x in (-1, 1) for y in (-1, 1))],
    "diamond in a tunnel": [box(3, 1.5), np.array([[-0.6, 0], [0, 0.4], [0.6, 0], [0, -0.4]])],
    "tubes": [box(3, 1.5), *(circle(x, y, 0.25) for x in (-1.5, 0, 1.5) for y in (-0.6, 0.6))],
}


@pytest.mark.parametrize("name", SYMMETRIC)
def test_blocks_do_not_hang_on_the_last_digits_of_coordinates(name):
    results = set()
    for seed in range(3):
        rng = np.random.default_rng(seed)
        size = 1e-13 if seed else 0.0
        rings = [ring * (1.0 + size * rng.uniform(-1, 1, ring.shape)) for ring in SYMMETRIC[name]]
        layout = block_grid(Domain(tuple(map(loop, rings))), cells=1500)[1]
        results.add((len(layout.blocks), irregular_inside(layout.mesh), layout.mesh.quads.tobytes()))
    assert len(results) == 1
