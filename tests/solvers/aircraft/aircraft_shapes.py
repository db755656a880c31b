"""A body with wings, small enough for tests, and what is looked up in its grids."""

import numpy as np

from meshonet.geometry.aircraft.aircraft import Aircraft
from meshonet.geometry.aircraft.body import Body
from meshonet.geometry.aircraft.fin import Fin
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.sections.section import Section
from meshonet.geometry.sections.stack import Stack
from meshonet.geometry.shapes.airfoil.naca import naca


def body(radius: float = 0.6, length: float = 10.0) -> Body:
    """A cylinder between two halves of ellipsoids, the tail longer than the nose."""
    x = 0.5 * length * (1.0 - np.cos(np.linspace(0.0, np.pi, 121)))
    nose = np.clip(1.0 - x / (0.2 * length), 0.0, 1.0)
    tail = np.clip((x - 0.6 * length) / (0.4 * length), 0.0, 1.0)
    r = radius * np.sqrt(np.maximum((1.0 - nose**2) * (1.0 - tail**2), 0.0))
    r[[0, -1]] = 0.0
    return Body(np.stack([x, r], axis=1), y=0.1)


def aircraft(y: float = 0.1, sweep: float = 2.0, section: str = "2415") -> Aircraft:
    """The body with a tapered wing at height `y`, whose tip lies `sweep` behind its root."""
    root = Section(naca(section), 2.0, 0.0, x=3.4, y=y)
    tip = Section(naca(section), 1.0, 5.0, x=3.4 + sweep, y=y + 0.3)
    return Aircraft(body(), Stack((root, tip), tip="flat"))


def tail(x: float = 8.2, y: float = 0.3, span: float = 1.9, name: str = "tail") -> Stack:
    """A tail plane of the body, whose root begins at `x`, with a tip at z = `span`."""
    root = Section(naca("0010"), 0.9, 0.0, x=x, y=y)
    return Stack((root, Section(naca("0010"), 0.5, span, x=x + 0.8, y=y + 0.1)), tip="flat", name=name)


def fin(x: float = 8.0, chord: float = 1.2, sweep: float = 35.0, height: float = 2.2) -> Fin:
    """A fin of the body, whose root begins at `x`, with a tip of half its chord at y = `height`."""
    root = Section(naca("0010"), chord, 0.1, x=x)
    behind = (height - 0.1) * float(np.tan(np.radians(sweep)))
    return Fin((root, Section(naca("0010"), 0.5 * chord, height, x=x + behind)), tip="flat", name="fin")


def wall(grid: Grid, name: str) -> list[tuple[Floats, Floats]]:
    """The nodes on a wall and those next to them, of each of its patches."""
    pairs = []
    for patch in grid.patches:
        if patch.name == name:
            nodes = grid.blocks[patch.block].nodes
            if patch.side == "south":
                nodes = np.moveaxis(nodes, 1, 2)
                assert patch.across is not None
                nodes = nodes[:, patch.across[0] : patch.across[1] + 1]
            pairs.append((nodes[:, :, 0], nodes[:, :, 1]))
    return pairs


def unclaimed_faces(grid: Grid) -> int:
    """How many faces on sides of blocks are in no patch and no connection; nodes of the latter are equal."""
    cells = [[count - 1 for count in block.counts] for block in grid.blocks]
    every = sum(2 * (a * b + b * c + c * a) for a, b, c in cells)
    named = sum(_count(each.range(grid.face(each.block, each.side).shape[:2])) for each in grid.patches)
    for connection in grid.connections:
        connection.check(grid.face)
    return every - named - sum(2 * _count(each.range) for each in grid.connections)


def _count(ranges: tuple[tuple[int, int], ...]) -> int:
    return int(np.prod([abs(b - a) for a, b in ranges]))
