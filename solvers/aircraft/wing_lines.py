"""The lines along the span of a wing on a body, from its root on the body to its tip."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.aircraft.body import Body
from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.sections.stack import Stack
from meshonet.solvers.aircraft.root import root_heights
from meshonet.solvers.rows.span_spacing import spaced_cells, two_sided
from meshonet.solvers.stacking.section_nodes import GAP, Around, around, unit_nodes

_TRIED = (1.2, 1.0), (1.25, 1.0), (1.25, 1.4), (1.3, 1.7), (1.4, 1.7), (1.5, 1.7), (2.0, 1.7)
"""Growth of cells around sections that is tried, and times that cells at the nose are longer than usual."""
_BASE = 2
"""Cells across a base."""
_ROUNDS = 6
"""Times a part is scaled; lines are nearly straight over a first cell."""


@dataclass(frozen=True)
class EvenAround(Around):
    """Distribution of nodes around sections, whose cells grow by as little as their number allows."""

    def law(self, height: float, length: float) -> Callable[[Floats], Floats]:
        """Return the law from base to nose for a side of the given length and base height, both in chords.

        The less the number of cells, the longer are those at the nose, unless their length is given.
        """
        edge, nose = self.ends(height, length)
        for growth, longer in _TRIED:
            ends = edge, nose * (longer if self.nose is None else 1.0)
            if spaced_cells(1.0, ends, growth, 1.0, 4) <= self.cells:
                break
        arcs = two_sided(np.ones(1), ends, growth, self.cells)[0]
        arcs[-1] = 1.0
        even = np.linspace(0.0, 1.0, self.cells + 1)
        return lambda q: np.asarray(np.interp(q, even, arcs))


@dataclass(frozen=True, eq=False)
class WingLines:
    """Lines of a wing along its span.

    Parameters
    ----------
    wing : the sections.
    name : of the wing.
    unit : (sections, n, 2) nodes around the sections, from the middle of the base over the upper side.
    roots : (n,) heights z where lines leave the body.
    notes : what was changed of the sections.
    """

    wing: Stack
    name: str
    unit: Floats
    roots: Floats
    notes: tuple[str, ...]

    @classmethod
    def of(cls, wing: Stack, name: str, body: Body, nodes: int, base: float = GAP) -> WingLines:
        """Return `nodes` lines, of a wing with trailing edges of at least `base` chords.

        Raises InputError: too few nodes, a wing that does not begin in the body or does not leave it.
        """
        plan = EvenAround(
            **vars(around(nodes, gap=base, base=_BASE, edge=wing.te_spacing, nose=wing.le_spacing))
        )
        units, notes = zip(*(unit_nodes(section, plan) for section in wing.sections), strict=True)
        unit = np.stack(units)
        roots = root_heights(wing, name, unit[:, :-1], body)
        changes = (*wing.notes, *dict.fromkeys(filter(None, notes)))
        return cls(wing, name, unit, np.append(roots, roots[0]), changes)

    def points(self, parts: Floats) -> Floats:
        """Return points (k, n, 3) at parts (k, n) of the way along the lines, in z."""
        wing = self.wing
        z = self.roots + parts * (wing.z[-1] - self.roots)
        columns = [wing.lofted(self.unit[:, k : k + 1], z[:, k])[:, 0] for k in range(z.shape[1])]
        return np.stack(columns, axis=1)

    def with_first(self, parts: Floats, first: float) -> Floats:
        """Return parts (k, n) of the way of which the second are at the distance `first` from the root."""
        parts = parts.copy()
        for _ in range(_ROUNDS):
            root, second = self.points(parts[:2])
            parts[1] *= first / norms(second - root)
        return parts

    @property
    def length(self) -> float:
        """Mean length of the lines."""
        ends = self.points(np.array([[0.0], [1.0]]) + np.zeros(len(self.roots)))
        return float(norms(ends[1] - ends[0]).mean())
