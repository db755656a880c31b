"""Lines along the span of a wing, from inside a body to the tip: through its sections, or on its surface."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.aircraft.body import Body
from meshonet.geometry.aircraft.fin import Fin
from meshonet.geometry.aircraft.surface_wing import SurfaceWing
from meshonet.geometry.aircraft.wing_strips import on_line
from meshonet.geometry.arrays import Floats
from meshonet.geometry.sections.stack import Stack
from meshonet.solvers.stacking.section_nodes import Around

_INWARDS = 0.0, 0.01, 0.02, 0.05, 0.1  # tried continuations of lines into the body, in chords
_SECTIONS = "give a first section inside the body, {}, and a last one outside"


@dataclass(frozen=True, eq=False)
class Loft:
    """Lines along the span of a wing, one for each node around it."""

    line: Callable[[int, Floats], Floats]  # points (m, 3) of a line by number at heights z (m,)
    begin: Floats  # (n,) heights at which the lines begin, inside the body
    tip: float  # height at which all lines end, in a plane with a cant
    remedy: str  # what the user should do if lines do not begin inside the body
    cant: float = 0.0  # angle in radians by which the normal of this plane is turned about x, from z to y


def section_loft(stack: Stack, unit: Floats) -> Loft:
    """Return lines along a wing's span; `unit` (sections, n, 2) are nodes of sections, scaled to chord 1."""

    def line(number: int, z: Floats) -> Floats:
        return stack.lofted(unit[:, number : number + 1], z)[:, 0]

    begin, remedy = np.full(unit.shape[1], stack.z[0]), _SECTIONS.format("such as in z = 0")
    return Loft(line, begin, float(stack.z[-1]), remedy, float(stack.cants[-1]))


def fin_loft(fin: Fin, unit: Floats) -> Loft:
    """Return lines along the span of an upright fin (y is up), on its half with z >= 0.

    The first line is the leading edge, the last the trailing edge. `unit` (sections, n, 2) are nodes around
    the fin's sections, scaled to chord 1.
    """
    half = (unit.shape[1] - 1) // 2
    upper, lower = unit[:, half::-1], unit[:, half:]
    nodes = 0.5 * (upper + lower * [1.0, -1.0])
    nodes[:, [0, -1], 1] = 0.0
    loft = section_loft(fin, nodes)

    def line(number: int, z: Floats) -> Floats:
        return np.ascontiguousarray(loft.line(number, z)[:, [0, 2, 1]])

    return Loft(line, loft.begin, loft.tip, _SECTIONS.format("with a smaller y"), loft.cant)


def surface_loft(wing: SurfaceWing, body: Body, plan: Around) -> Loft:
    """Return spanwise lines on the surface of a wing, distributed around it as in `plan`.

    Two cells are on the blunt trailing edge; the first and the last line are both in its middle. Where the
    given surface ends on the body, lines are extended into the body.
    """
    base = float(np.median(wing.base(wing.z)))
    q = np.linspace(0.0, 1.0, plan.cells + 1)
    nose, whole = wing.arc(wing.nose), float(wing.arcs.sum())
    upper = nose * plan.law(base, nose)(q)
    lower = whole - (whole - nose) * plan.law(base, whole - nose)(q)
    places = wing.places(np.concatenate([upper, lower[-2::-1]]))
    places[plan.cells] = wing.nose
    lines = wing.lines(places)

    def line(number: int, z: Floats) -> Floats:
        if number in (0, len(lines) + 1):
            return 0.5 * (on_line(lines[0], z) + on_line(lines[-1], z))
        return on_line(lines[number - 1], z)

    z = np.array([each[0, 2] for each in lines])
    begin = np.concatenate([[max(z[0], z[-1])], z, [max(z[0], z[-1])]])
    for inwards in _INWARDS:
        starts = begin - inwards * wing.chord
        first = [line(k, starts[k : k + 1])[0] for k in range(len(starts))]
        if body.outside(np.stack(first)).max() < 0.0:
            break
    return Loft(line, starts, wing.height, "give patches of the wing that end on the body or inside of it")
