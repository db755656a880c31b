"""Nodes around the sections of a stack, with the same distribution on all sections.

Node 0 is in the middle of the base; nodes run along the upper side first. Bases lower than `gap` are opened.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import product
from meshonet.geometry.errors import InputError
from meshonet.geometry.notes import Change
from meshonet.geometry.polygon.self_intersection import find_crossing
from meshonet.geometry.sections.section import Section
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.airfoil.section_curve import farthest_arc
from meshonet.geometry.shapes.far_field import straight
from meshonet.geometry.shapes.outline import Outline
from meshonet.geometry.spacing.tanh_law import TanhLaw
from meshonet.solvers.stacking.nose_cells import MOST, nose_cell, nose_note

BASE_CELLS = 8  # across a base
GAP = 0.005  # smallest height of a base in chords
_EDGE_CELL = 1.2  # of the mean cell of a base
LEAST_AROUND, MOST_AROUND = 33, 10_001  # nodes


@dataclass(frozen=True)
class Around:
    """Distribution of nodes around sections, the same for every section."""

    follows_nose: ClassVar[bool] = True
    cells: int  # number of cells on each side
    base: int  # even number of cells on the base, the blunt trailing edge
    gap: float  # smallest height of the base in chords
    edge: float | None = None  # length of the cells next to the base in chords; None: 1.2 cells of the base
    nose: float | None = None  # length of the cells at the nose in chords; None: by curvature (`nose_cell`)

    @property
    def nodes(self) -> int:
        """Number of nodes around a section, including the repeated first one."""
        return 2 * self.cells + self.base + 1

    def law(self, height: float, length: float, nose: float | None = None) -> Callable[[Floats], Floats]:
        """Return the distribution of nodes along a side of a section, from the trailing edge to the nose.

        For parameters, see `ends`. Raises InputError if no distribution has the end cells from `ends`.
        """
        return TanhLaw.fitted(self.cells, *self.ends(height, length, nose))

    def ends(self, height: float, length: float, nose: float | None = None) -> tuple[float, float]:
        """Return the lengths of the cells at both ends of a side of a section, as fractions of its `length`.

        One end is at the base (blunt trailing edge), whose `height` is given, the other at the nose. The cell
        at the nose is as long as the attribute `nose`, or the parameter `nose` if the attribute is None. If
        both are None, it has 0.35 times the mean length on the side. Parameters are in chords.
        """
        edge = min(_EDGE_CELL * max(height, self.gap) / self.base, 1.0 / self.cells)
        first = edge if self.edge is None else self.edge / length
        nose = self.nose or nose
        return first, MOST / self.cells if nose is None else nose / length


def around(
    nodes: int, *, gap: float = GAP, base: int = BASE_CELLS,
    edge: float | None = None, nose: float | None = None,
) -> Around:  # fmt: skip
    """Return the distribution of `nodes` nodes around sections, including the repeated first node.

    Other parameters are the fields of `Around`. Raises InputError if nodes are too few or
    even in number, or if `gap` is out of its range.
    """
    if not LEAST_AROUND <= nodes <= MOST_AROUND or nodes % 2 == 0:
        problem = f"{nodes} nodes around a section"
        remedy = f"use an odd number from {LEAST_AROUND} to {MOST_AROUND}"
        raise InputError(problem, remedy, parameter="around")
    if not 0 < gap < 0.2:
        raise InputError(f"a base of {gap:g} chords", "use more than 0 and less than 0.2", parameter="base")
    return Around((nodes - 1 - base) // 2, base, gap, edge, nose)


def unit_nodes(section: Section, plan: Around) -> tuple[Floats, str]:
    """Return nodes (n, 2) around a section of unit chord, upper side first, and a note.

    The note says if the trailing edge was thickened. Raises InputError if the outline intersects itself.
    """
    shape, note = section.shape, ""
    name = shape.name or "a section"
    origin, length = section.frame
    if isinstance(shape, Airfoil):
        upper, lower = ((side - origin) / length for side in _airfoil_sides(shape, plan))
        height = float(np.hypot(*(upper[0] - lower[0])))
        if height < plan.gap * (1 - 1e-9):
            upper, lower = _opened(upper, lower, plan.gap)
            note = Change(
                f"{name} is changed: its trailing edge, {height:.2g} chords high, is opened to a base of "
                f"{plan.gap:g} chords"
            )
        middle = 0.5 * (upper[0] + lower[0])
        to_upper, to_lower = (straight(middle, side[0], plan.base // 2 + 1) for side in (upper, lower))
    else:
        lines = (((line - origin) / length) for line in _outline_sides(shape, plan))
        to_upper, upper, to_lower, lower = lines
    nodes = np.concatenate([to_upper, upper[1:], lower[-2::-1], to_lower[-2::-1]])
    crossing = find_crossing(nodes[:-1])
    if crossing is not None:
        where = f"({crossing.x:.4g}, {crossing.y:.4g}) chords"
        problem = f"{len(nodes)} nodes around {name} cross themselves at {where}"
        raise InputError(problem, "use more nodes around, or a higher base")
    return nodes, note


def nose_notes(sections: Sequence[Section], plan: Around) -> tuple[str, ...]:
    """Return notes on sections whose nose cells are too long."""
    shapes = (section.shape for section in sections)
    notes = (nose_note(shape, plan.cells, plan.nose) for shape in shapes if isinstance(shape, Airfoil))
    return tuple(dict.fromkeys(filter(None, notes)))


def _airfoil_sides(shape: Airfoil, plan: Around) -> tuple[Floats, Floats]:
    """Return nodes (cells + 1, 2) of the upper and the lower side, from base to nose."""
    q = np.linspace(0.0, 1.0, plan.cells + 1)
    height = shape.gap / shape.unit if shape.blunt else 0.0
    below, above = shape.nose_arc - shape.half_base, shape.upper_end - shape.nose_arc
    nose = nose_cell(shape, plan.cells) if plan.follows_nose else None
    lower = shape.half_base + below * plan.law(height, below / shape.unit, nose)(q)
    upper = shape.upper_end - above * plan.law(height, above / shape.unit, nose)(q)
    nodes = shape.curve.at(np.concatenate([upper, lower]))
    sides = nodes[: len(q)], nodes[len(q) :]
    sides[0][-1] = sides[1][-1]
    return sides


def _outline_sides(shape: Outline, plan: Around) -> tuple[Floats, Floats, Floats, Floats]:
    """Return nodes of half a base and of a side, for the upper and then the lower half of a closed curve.

    Steps are equal from the rightmost point to the farthest one.
    """
    if plan.edge is not None or plan.nose is not None:
        problem = f"{shape.name or 'a closed curve'} has neither leading nor trailing edge"
        raise InputError(problem, "leave le_spacing and te_spacing out")
    curve, half = shape.clockwise(), plan.base // 2
    nose = farthest_arc(curve, curve.points[0])
    q = np.linspace(0.0, 1.0, plan.cells + half + 1)
    lower, upper = curve.at(nose * q), curve.at(curve.length - (curve.length - nose) * q[1:])
    upper = np.concatenate([lower[:1], upper])
    upper[-1] = lower[-1]
    return upper[: half + 1], upper[half:], lower[: half + 1], lower[half:]


def _opened(upper: Floats, lower: Floats, gap: float) -> tuple[Floats, Floats]:
    """Return sides (n, 2) from base to nose, moved apart to a base of height `gap`."""
    across = upper[0] - lower[0]
    chord = 0.5 * (upper[0] + lower[0]) - upper[-1]
    normal = np.array([-chord[1], chord[0]]) / np.hypot(*chord)
    missing = 0.5 * (gap - float(product(across, normal)))
    sides = []
    for side, sign in ((upper, 1.0), (lower, -1.0)):
        along = np.clip(product(side - upper[-1], chord) / product(chord, chord), 0.0, None)
        sides.append(side + sign * missing * along[:, None] * normal)
    return sides[0], sides[1]
