"""A section placed in space: an outline in a plane, scaled, twisted, moved and canted."""

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import cos, sin
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.outline import Outline

QUARTER = (0.25, 0.0)  # default centre of the twist, in chords from the leading edge
Cant: TypeAlias = float | Literal["panel"]
MOST_CANT = 90.0  # degrees
MOST_NODES = 10_001  # along the span


@dataclass(frozen=True, eq=False)
class Section:
    """The outline of a wing, blade or duct in a plane, with its size and position.

    Parameters
    ----------
    shape : Airfoil or Outline
        An airfoil, or a closed curve, in any unit.
    chord : float
        Chord to which the shape is scaled, in the unit of x, y and z.
    z : float
        Position of the section's plane.
    x, y : float, optional
        Position of the leading edge before the twist.
    twist : float, optional
        Twist angle in degrees, nose up.
    about : tuple of 2 float, optional
        Centre of the twist, in chords from the leading edge.
    cant : float or 'panel', optional
        Angle in degrees by which the normal of the section is tilted from z towards y, about a line along x
        through the leading edge. ``panel``: the mean of the dihedral angles on both sides of the section.
    nodes : int, optional
        Number of nodes from the previous section to this one, both ends included. None: automatic.

    Raises
    ------
    InputError
        A chord that is not positive; a value that is not finite; a cant beyond 90 degrees; one node.
    """

    shape: Airfoil | Outline
    chord: float
    z: float
    x: float = 0.0
    y: float = 0.0
    twist: float = 0.0
    about: tuple[float, float] = QUARTER
    cant: Cant = 0.0
    nodes: int | None = None

    def __post_init__(self) -> None:
        values = {name: getattr(self, name) for name in ("chord", "z", "x", "y", "twist")}
        for name, value in (*values.items(), *(("about", value) for value in self.about)):
            if not math.isfinite(value) or abs(value) > 1e12:
                raise InputError(f"{name} is {value:g}", "use a finite number", place=name)
        if not self.chord > 0:
            raise InputError(f"a chord of {self.chord:g}", "use more than 0", place="chord")
        if self.cant != "panel" and not (isinstance(self.cant, int | float) and abs(self.cant) <= MOST_CANT):
            remedy = f"use -{MOST_CANT:g} to {MOST_CANT:g} degrees, or panel"
            raise InputError(f"cant is {self.cant!r}", remedy, place="cant")
        if self.nodes is not None and not 2 <= self.nodes <= MOST_NODES:
            raise InputError(f"{self.nodes} nodes", f"use 2 to {MOST_NODES}", place="nodes")

    @property
    def frame(self) -> tuple[Floats, float]:
        """Leading edge (2,) and chord of the given shape, before it is moved to (0, 0) and scaled to 1.

        An airfoil of chord 1 near (0, 0), as in most files, is not moved: the values are (0, 0) and 1.
        """
        if isinstance(self.shape, Airfoil):
            nose, length = self.shape.leading_edge, self.shape.unit
            if length == 1.0 and np.hypot(*nose) < 0.01:
                return np.zeros(2), 1.0
            return nose, length
        low, high = self.shape.curve.points.min(axis=0), self.shape.curve.points.max(axis=0)
        return np.array([low[0], 0.5 * (low[1] + high[1])]), float(high[0] - low[0])

    @property
    def placement(self) -> Floats:
        """Array (6,): chord, twist in radians, leading edge x and y, and centre of twist x and y.

        The centre of twist is in chords from the leading edge.
        """
        return np.array([self.chord, math.radians(self.twist), self.x, self.y, *self.about])


class Fade(NamedTuple):
    """How much of a section's twist and chord its grid nodes get: all at the outline, less away from it."""

    weight: Floats  # (n,) 1: twist and chord of the section; 0: no twist, and `chord`
    chord: float  # chord length by which nodes with weight 0 are scaled


def placed(unit: Floats, placement: Floats, fade: Fade | None = None) -> Floats:
    """Return nodes (..., n, 2), x and y, of sections that are scaled, twisted and moved.

    `unit` are the nodes at unit chord. `placement` (..., 6): see `Section.placement`; `fade`: see `Fade`.
    """
    chord, twist, x, y, about_x, about_y = (placement[..., k, None] for k in range(6))
    if fade is not None:
        chord, twist = fade.chord + (chord - fade.chord) * fade.weight, twist * fade.weight
    away_x, away_y = unit[..., 0] - about_x, unit[..., 1] - about_y
    c, s = cos(twist), sin(twist)
    return np.stack(
        [chord * (about_x + c * away_x + s * away_y) + x, chord * (about_y + c * away_y - s * away_x) + y],
        axis=-1,
    )


def turned(points: Floats, place: Floats, cant: Floats) -> Floats:
    """Return `points` (..., 3) rotated by `cant` (...) radians about lines parallel to x, from z towards y.

    `place` (..., 2) has the y and z of the lines.
    """
    c, s = cos(cant), sin(cant)
    away, along = points[..., 1] - place[..., 0], points[..., 2] - place[..., 1]
    y, z = place[..., 0] + c * away + s * along, place[..., 1] + c * along - s * away
    return np.stack([points[..., 0], y, z], axis=-1)
