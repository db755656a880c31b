"""A body with a wing, small enough for tests."""

import numpy as np

from meshonet.geometry.aircraft.aircraft import Aircraft
from meshonet.geometry.aircraft.body import Body
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
