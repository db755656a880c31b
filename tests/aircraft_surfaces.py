"""Half an aircraft as patches of a surface in files, of which all is known: a round body and a NACA wing."""

from pathlib import Path

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.shapes.airfoil.naca import naca_points

LENGTH, RADIUS, SPAN = 10.0, 0.6, 5.0


def radius(x: Floats) -> Floats:
    """Of the body: a cylinder between two halves of ellipsoids."""
    nose, tail = np.clip(1.0 - x / 2.0, 0.0, 1.0), np.clip((x - 6.0) / 4.0, 0.0, 1.0)
    return RADIUS * np.sqrt(np.maximum((1.0 - nose**2) * (1.0 - tail**2), 0.0))


def body_patch(end: float = LENGTH, keel: float = 0.0) -> Floats:
    """The half z >= 0 of the body (13, 121, 3) from nose to `end`, from keel (or beside) to crown."""
    x = 0.5 * LENGTH * (1.0 - np.cos(np.linspace(0.0, np.pi, 121)))
    x = x[x <= end]
    angles, r = np.linspace(keel, np.pi, 13)[:, None], radius(x)
    return np.stack([x + 0.0 * angles, -r * np.cos(angles), r * np.sin(angles)], axis=-1)


def wing_patches(begin: float = 0.3, closing: bool = False) -> list[Floats]:
    """Upper and lower side (stations, 61, 3) of a tapered, swept NACA 2415, from the height `begin`.

    A `closing` tip goes on by 0.1, where it is half an ellipse.
    """
    z = np.linspace(begin, SPAN, 6)
    more = 0.1 * np.sin(np.linspace(0.0, 0.5 * np.pi, 7))[1:-1] if closing else np.empty(0)
    heights = np.concatenate([z, SPAN + more])
    thin = np.concatenate([np.ones(6), np.sqrt(1.0 - (more / 0.1) ** 2)])
    loop = naca_points("2415", 61)
    sides = []
    for side in (loop[:61], loop[60:]):
        chord = 2.0 - heights / SPAN
        x = 3.4 + 0.4 * heights[:, None] + chord[:, None] * side[:, 0]
        y = 0.05 * heights[:, None] + (chord * thin)[:, None] * side[:, 1]
        sides.append(np.stack([x, y, heights[:, None] + 0.0 * x], axis=-1))
    return sides


def written(path: Path, patches: list[Floats], axes: tuple[int, ...] = (0, 1, 2), sign: float = 1.0) -> Path:
    """The patches as a Plot3D file, with y and z (of the half z >= 0, or of the other) on these axes."""
    blocks = []
    for nodes in patches:
        turned = np.empty_like(nodes)
        turned[..., axes] = nodes * [1.0, 1.0, sign]
        blocks.append(Block(turned))
    Grid(tuple(blocks)).write(path)
    return path


TOML = 'kind = "aircraft"\n[[bodies]]\nsurface = "jet.xyz"\n[[wings]]\nsurface = "jet.xyz"\n'
