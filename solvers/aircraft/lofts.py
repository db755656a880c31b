"""Lines along the span of a wing, from inside a body to the tip: through its sections, or on its surface."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, Self

import numpy as np

from meshonet.geometry.aircraft.body import Body
from meshonet.geometry.aircraft.fin import Fin
from meshonet.geometry.aircraft.surface_wing import SurfaceWing
from meshonet.geometry.aircraft.wing_strips import on_line
from meshonet.geometry.arrays import Floats
from meshonet.geometry.sections.stack import Stack
from meshonet.solvers.stacking.section_nodes import Around

_INWARDS = 0.0, 0.01, 0.02, 0.05, 0.1  # tried continuations of lines into the body, in chords


class Loft(Protocol):
    """Lines along the span of a wing, one for each node around a section of the wing."""

    @property
    def begin(self) -> Floats:
        """(n,) heights z at which the lines begin, inside the body."""

    @property
    def tip(self) -> float:
        """Height at which all lines end."""

    @property
    def remedy(self) -> str:
        """What users should do if the lines do not begin inside the body, as text for an error."""

    @property
    def cant(self) -> float:
        """Angle in radians by which the normal of the tip's plane is turned about x, from the z axis to y."""

    def line(self, number: int, z: Floats) -> Floats:
        """Return points (m, 3) on a line at heights z (m,)."""


@dataclass(frozen=True, eq=False)
class SectionLoft:
    """Lines through the nodes `unit` (sections, n, 2) around the sections of a `stack`."""

    stack: Stack
    unit: Floats
    remedy: str = "give a first section inside the body, such as in z = 0, and a last one outside"

    @property
    def begin(self) -> Floats:
        """(n,) heights of the first section."""
        return np.full(self.unit.shape[1], self.stack.z[0])

    @property
    def tip(self) -> float:
        """Height of the last section."""
        return float(self.stack.z[-1])

    @property
    def cant(self) -> float:
        """Cant of the last section in radians."""
        return float(self.stack.cants[-1])

    def line(self, number: int, z: Floats) -> Floats:
        """Return points (m, 3) on a line at heights z (m,)."""
        return self.stack.lofted(self.unit[:, number : number + 1], z)[:, 0]


@dataclass(frozen=True, eq=False)
class FinLoft(SectionLoft):
    """Lines along the span of a fin, through the nodes `unit` (sections, n, 2) of its half z >= 0.

    The span is along y: heights of sections are y in space.
    """

    remedy: str = "give a first section inside the body, with a smaller y, and a last one outside"

    @classmethod
    def of(cls, fin: Fin, unit: Floats) -> Self:
        """Return the lines from nose to trailing edge, given nodes (sections, n, 2) around sections."""
        half = (unit.shape[1] - 1) // 2
        upper, lower = unit[:, half::-1], unit[:, half:]
        nodes = 0.5 * (upper + lower * [1.0, -1.0])
        nodes[:, [0, -1], 1] = 0.0
        return cls(fin, nodes)

    def line(self, number: int, z: Floats) -> Floats:
        """Return points (m, 3) on a line at heights (m,)."""
        return np.ascontiguousarray(super().line(number, z)[:, [0, 2, 1]])


@dataclass(frozen=True, eq=False)
class SurfaceLoft:
    """Lines along the span on the surface of a wing; the first and the last are in the middle of its base.

    Parameters
    ----------
    lines : (stations, 3) each, ordered from the upper corner of the base around the nose to the lower corner.
    begin : (n,) height at which each line begins, including the lines in the middle of the base.
    tip : height at which lines end, in a plane without `cant`.
    """

    lines: Sequence[Floats]
    begin: Floats
    tip: float
    cant: float = 0.0
    remedy: str = "give patches of the wing that end on the body or inside of it"

    @classmethod
    def of(cls, wing: SurfaceWing, body: Body, plan: Around) -> Self:
        """Return the lines of a wing on a body, distributed as in `plan`, with two cells on the wing's base.

        Lines that end on the body are continued straight into it, as far as necessary.
        """
        base = float(np.median(wing.base(wing.z)))
        q = np.linspace(0.0, 1.0, plan.cells + 1)
        nose, whole = wing.arc(wing.nose), float(wing.arcs.sum())
        upper = nose * plan.law(base, nose)(q)
        lower = whole - (whole - nose) * plan.law(base, whole - nose)(q)
        places = wing.places(np.concatenate([upper, lower[-2::-1]]))
        places[plan.cells] = wing.nose
        lines = wing.lines(places)
        z = np.array([line[0, 2] for line in lines])
        begin = np.concatenate([[max(z[0], z[-1])], z, [max(z[0], z[-1])]])
        for inwards in _INWARDS:
            loft = cls(lines, begin - inwards * wing.chord, wing.height)
            first = [loft.line(k, loft.begin[k : k + 1])[0] for k in range(len(begin))]
            if body.outside(np.stack(first)).max() < 0.0:
                break
        return loft

    def line(self, number: int, z: Floats) -> Floats:
        """Return points (m, 3) on a line at heights z (m,)."""
        if number in (0, len(self.lines) + 1):
            return 0.5 * (on_line(self.lines[0], z) + on_line(self.lines[-1], z))
        return on_line(self.lines[number - 1], z)
