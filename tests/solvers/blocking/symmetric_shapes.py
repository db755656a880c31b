"""Symmetric domains, and how far their grids are from their mirror images."""

import numpy as np
from planar_domains import SHAPES, box, circle, polygon
from scipy.spatial import cKDTree

from meshonet.geometry.domain.domain import Domain

WING = np.concatenate(
    [np.stack([x, sign * 0.3 * np.sqrt(x) * (1 - x)], axis=1)
     for x, sign in ((0.5 + 0.5 * np.cos(np.linspace(0, np.pi, 40)[:-1]), 1),
                     (0.5 - 0.5 * np.cos(np.linspace(0, np.pi, 40)[:-1]), -1))]
)  # fmt: skip


def holes(*places, radius=0.25, count=80):
    return [circle(x, y, radius, count) for x, y in places]


def stadium(count=40):
    turn = np.pi * np.arange(count + 1) / count - 0.5 * np.pi
    half = np.stack([1.0 + np.cos(turn), np.sin(turn)], axis=1)
    return np.concatenate([half, -half])


def around(count, distance, start=0.0):
    """Return holes at a distance from the origin, the first in a direction in degrees."""
    angles = np.radians(start + 360.0 / count * np.arange(count))
    return holes(*zip(distance * np.cos(angles), distance * np.sin(angles), strict=True), count=60)


def flower(petals, count=240):
    turn = 2.0 * np.pi * np.arange(count) / count
    return (1.0 + 0.2 * np.cos(petals * turn))[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1)


ALL = (0, 45, 90, 135)
EIGHT = tuple(np.arange(8) * 22.5)
SYMMETRIC = {
    # name: polygons, a point on all mirrors, and the directions of these in degrees
    "disc": ([circle(0, 0, 1, 160)], (0, 0), ALL),
    "ellipse": (SHAPES["ellipse"], (0, 0), (0, 90)),
    "square": ([box(-1, 1, -1, 1)], (0, 0), ALL),
    "rectangle": ([box(-2, 2, -1, 1)], (0, 0), (0, 90)),
    "stadium": ([stadium()], (0, 0), (0, 90)),
    "cross": (
        [polygon(1, -1, 3, -1, 3, 1, 1, 1, 1, 3, -1, 3, -1, 1, -3, 1, -3, -1, -1, -1, -1, -3, 1, -3)],
        (0, 0),
        ALL,
    ),
    "annulus": ([circle(0, 0, 1, 120), circle(0, 0, 0.5, 80)], (0, 0), ALL),
    "eccentric annulus": ([circle(0, 0, 1, 120), circle(0.2, 0, 0.5, 80)], (0, 0), (0,)),
    "square with a square hole": ([box(-2, 2, -2, 2), box(-0.7, 0.7, -0.7, 0.7)], (0, 0), ALL),
    "plate with four holes": (
        [box(-2, 2, -2, 2), *holes((-1, -1), (1, -1), (1, 1), (-1, 1))],
        (0, 0),
        ALL,
    ),
    "row of tubes": (
        [box(-1, 7, -1, 1), *holes((0, 0), (2, 0), (4, 0), (6, 0), radius=0.4)],
        (3, 0),
        (0, 90),
    ),
    "tube bank": ([box(0, 5, 0, 2), *holes((1, 0.5), (1, 1.5), (2, 1), (3, 0.5), (3, 1.5))], (0, 1), (0,)),
    "cylinder in a channel": ([box(-2, 6, -2, 2), *holes((0, 0), radius=0.5)], (0, 0), (0,)),
    "cylinder amid a channel": ([box(-4, 4, -2, 2), *holes((0, 0), radius=0.5)], (0, 0), (0, 90)),
    "cylinder in a far field": ([circle(0, 0, 40, 200), *holes((0, 0), radius=0.5)], (0, 0), ALL),
    "square turned in a channel": ([box(-2, 6, -2, 2), circle(0, 0, 0.7, 4)], (0, 0), (0,)),
    "H": (
        [polygon(0, 0, 1, 0, 1, 2, 3, 2, 3, 0, 4, 0, 4, 5, 3, 5, 3, 3, 1, 3, 1, 5, 0, 5)],
        (2, 2.5),
        (0, 90),
    ),
    "T": ([polygon(-0.5, 0, 0.5, 0, 0.5, 3, 2, 3, 2, 4, -2, 4, -2, 3, -0.5, 3)], (0, 0), (90,)),
    "L": ([polygon(0, 0, 2, 0, 2, 1, 1, 1, 1, 2, 0, 2)], (0, 0), (45,)),
    "two wings": (
        [box(-3, 5, -3, 3), np.add(WING, [0, 0.6]), np.add(WING * [1, -1], [0, -0.6])],
        (0, 0),
        (0,),
    ),
    "wing": ([box(-3, 5, -3, 3), WING], (0, 0), (0,)),
    "hexagon": (SHAPES["hexagon"], (0, 0), (0, 30, 60, 90, 120, 150)),
    "hexagon in a hexagon": ([circle(0, 0, 1, 6), circle(0, 0, 0.4, 6)], (0, 0), (0, 30, 60, 90, 120, 150)),
    "hexagon with six holes": (
        [circle(0, 0, 2, 6), *around(6, 1.1, 30)],
        (0, 0),
        (0, 30, 60, 90, 120, 150),
    ),
    "triangle": ([polygon(0, 0, 1, 0, 0.5, 0.8)], (0.5, 0), (90,)),
    "equal triangle": ([circle(0, 0, 1, 3)], (0, 0), (0, 60, 120)),
    "disc with three holes": ([circle(0, 0, 2, 120), *around(3, 1.0)], (0, 0), (0, 60, 120)),
    "disc with five holes": ([circle(0, 0, 2, 120), *around(5, 1.2)], (0, 0), (0, 36, 72, 108, 144)),
    "star": (SHAPES["star"], (0, 0), (0, 36, 72, 108, 144)),
    "octagon": ([circle(0, 0, 1, 8)], (0, 0), EIGHT),
    "octagon in a circle": ([circle(0, 0, 3, 160), circle(0, 0, 0.8, 8)], (0, 0), EIGHT),
    "dodecagon": ([circle(0, 0, 1, 12)], (0, 0), (0, 30, 60, 90, 120, 150)),
    "flower": ([flower(4)], (0, 0), ALL),
}


def turned(polygons, degrees):
    """Return polygons turned about the origin."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return [np.stack([c * p[:, 0] - s * p[:, 1], s * p[:, 0] + c * p[:, 1]], axis=1) for p in polygons]


def symmetric_domain(name, degrees=0.0):
    """Return a domain, turned by some degrees."""
    return Domain.of_polygons(turned(SYMMETRIC[name][0], degrees), name)


def amiss(name, nodes, degrees=0.0):
    """Return how far the images of nodes (n, 2) in all mirrors of a domain are from nodes, by its extent."""
    polygons, centre, angles = SYMMETRIC[name]
    nodes = turned([np.asarray(nodes)], -degrees)[0] - centre
    tree, extent = cKDTree(nodes), np.ptp(np.concatenate(polygons), axis=0).max()
    worst = 0.0
    for angle in angles:
        turn = turned([nodes], -angle)[0] * [1.0, -1.0]
        worst = max(worst, tree.query(turned([turn], angle)[0])[0].max() / extent)
    return worst
