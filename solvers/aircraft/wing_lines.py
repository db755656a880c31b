"""The lines along the span of a wing, from its root on a body to its tip."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

import numpy as np

from meshonet.geometry.aircraft.body import Body
from meshonet.geometry.aircraft.fin import Fin
from meshonet.geometry.aircraft.surface_wing import SurfaceWing
from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.errors import InputError
from meshonet.geometry.sections.section import turned
from meshonet.geometry.sections.stack import Stack
from meshonet.solvers.aircraft.lofts import Loft, fin_loft, section_loft, surface_loft
from meshonet.solvers.rows.span_spacing import spaced_cells, two_sided
from meshonet.solvers.stacking.section_nodes import GAP, Around, around, unit_nodes
from meshonet.solvers.stacking.wing_surface import refuse_crossing

# growth ratios around sections, in order of attempts; longer nose cells cost 4 % of lift on coarse grids
_TRIED = 1.2, 1.25, 1.3, 1.35, 1.4, 1.5, 2.0
_BASE = 2  # number of cells across a base
_SHARP = 0.001  # default smallest height of the base of a wing given as a surface, in chords
_ROUNDS = 6  # scalings of a fraction: lines are nearly straight over a first cell
_PLACES = 65  # number of heights at which a line is compared with the body in each step
_PASSES = 6  # number of steps; each divides the interval around a crossing


@dataclass(frozen=True)
class EvenAround(Around):
    """Distribution of nodes around sections with the smallest possible growth."""

    follows_nose = False  # cells at the nose are a fraction of the mean cell

    def law(self, height: float, length: float, nose: float | None = None) -> Callable[[Floats], Floats]:
        """Return the node distribution on a side of a section, from the base to the nose.

        The `height` of the base, the `length` of the side and the cell length at the `nose` are in chords.
        """
        ends = self.ends(height, length, nose)
        for growth in _TRIED:
            if spaced_cells(1.0, ends, growth, 1.0, 4) <= self.cells:
                break
        arcs = two_sided(np.ones(1), ends, growth, self.cells)[0]
        arcs[-1] = 1.0
        even = np.linspace(0.0, 1.0, self.cells + 1)
        return lambda q: np.asarray(np.interp(q, even, arcs))


@dataclass(frozen=True, eq=False)
class WingLines:
    """Lines of a wing along its span."""

    loft: Loft  # the lines, which begin inside the body
    name: str  # name of the wing
    roots: Floats  # (n,) heights z at which the lines leave the body
    notes: tuple[str, ...]  # sentences on changes of the wing
    fin: bool = False  # whether this is a fin, with its span along y and only the lines of its half z >= 0

    @classmethod
    def of(
        cls, wing: Stack | SurfaceWing, name: str, body: Body, nodes: int, base: float | None = None
    ) -> Self:
        """Return lines along the span of a wing through `nodes` points around each of its sections.

        Sharp trailing edges become `base` chords thick. Raises InputError for too few nodes, or if the wing
        begins outside the body or does not leave it.
        """
        if isinstance(wing, SurfaceWing):
            least = _SHARP if base is None else base
            opened = wing.opened(least)
            loft = surface_loft(opened, body, _around(nodes, least))
            notes = opened.notes
        else:
            loft, notes = _through_sections(wing, nodes, GAP if base is None else base)
        roots, fin = _root_heights(loft, name, body), isinstance(wing, Fin)
        if not fin:
            roots[-1] = roots[0]
        return cls(loft, name, roots, notes, fin)

    def points(self, parts: Floats) -> Floats:
        """Return points (k, n, 3), k on each of n lines, at fractions `parts` of the span from the root."""
        z = self.roots + parts * (self.loft.tip - self.roots)
        return np.stack([self.loft.line(k, z[:, k]) for k in range(z.shape[1])], axis=1)

    def with_first(self, parts: Floats, first: float) -> Floats:
        """Return `parts` (k, n), fractions of the span on n lines, changed: first cells are `first` long."""
        parts = parts.copy()
        for _ in range(_ROUNDS):
            root, second = self.points(parts[:2])
            parts[1] *= first / norms(second - root)
        return parts

    @property
    def axis(self) -> Floats:
        """(3,) direction of the span, at right angles to the tip."""
        if self.fin:
            return np.array([0.0, 1.0, 0.0])
        return turned(np.array([0.0, 0.0, 1.0]), np.zeros(2), np.array(self.loft.cant))

    @property
    def length(self) -> float:
        """Mean length of the lines from root to tip."""
        ends = self.points(np.array([[0.0], [1.0]]) + np.zeros(len(self.roots)))
        return float(norms(ends[1] - ends[0]).mean())


def _around(nodes: int, base: float, edge: float | None = None, nose: float | None = None) -> EvenAround:
    return EvenAround(**vars(around(nodes, gap=base, base=_BASE, edge=edge, nose=nose)))


def _through_sections(wing: Stack, nodes: int, base: float) -> tuple[Loft, tuple[str, ...]]:
    plan = _around(nodes, base, wing.te_spacing, wing.le_spacing)
    units, notes = zip(*(unit_nodes(section, plan) for section in wing.sections), strict=True)
    unit = np.stack(units)
    refuse_crossing(wing, unit)
    loft = fin_loft(wing, unit) if isinstance(wing, Fin) else section_loft(wing, unit)
    return loft, (*wing.notes, *dict.fromkeys(filter(None, notes)))


def _root_heights(loft: Loft, name: str, body: Body) -> Floats:
    """Return the heights z (n,) at which the lines of a wing's `loft` leave a body.

    Raises InputError: a line that begins outside of the body, or never leaves it.
    """
    begin = loft.begin
    out = body.outside(np.stack([loft.line(k, begin[k : k + 1])[0] for k in range(len(begin))]))
    if out.max() >= 0.0:
        worst = int(out.argmax())
        raise _error(loft, name, worst, float(begin[worst]), body, "begins outside of")
    heights = np.empty(len(begin))
    for k in range(len(heights)):
        low, high = float(begin[k]), loft.tip
        for _ in range(_PASSES):
            z = np.linspace(low, high, _PLACES)
            out = body.outside(loft.line(k, z))
            first = np.flatnonzero(out >= 0.0)
            if not len(first):
                raise _error(loft, name, k, high, body, "does not leave")
            at = int(first[0])
            low, high = float(z[at - 1]), float(z[at])
        heights[k] = low + (high - low) * out[at - 1] / (out[at - 1] - out[at])
    return heights


def _error(loft: Loft, name: str, line: int, z: float, body: Body, what: str) -> InputError:
    """Return the error for a line at the height z, with its place beside the body."""
    x, y, z = point = loft.line(line, np.array([z]))[0]
    nose, tail = body.meridian[0, 0], body.meridian[-1, 0]
    if nose < x < tail:
        where = body.beside(point)
    else:
        where = (
            f"{'ahead of its nose' if x <= nose else 'behind its tail'}: it is from x={nose:g} to {tail:g}"
        )
    problem = f"a line of the {name} {what} the {body.name} at x={x:.6g}, y={y:.6g}, z={z:.6g}, {where}"
    return InputError(problem, loft.remedy, place="wings")
