"""Walls with layers: whole loops, and stretches of loops between convex corners."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from meshonet.geometry.blocks.patches import kind_of, may_be_wall
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.errors import InputError

_SHOWN = 8  # names in a message
_LINES = ("symmetry", "other")
"""Kinds of parts that are no walls, along which layers go on; an axis is of another kind."""


@dataclass(frozen=True)
class Stretch:
    """A part of a boundary loop that has layers; it begins and ends at corners, or is the whole loop.

    Parameters
    ----------
    loop : index of the loop.
    first, last : indices of these two corners among the corners of the loop; equal for the whole loop.
    """

    loop: int
    first: int
    last: int

    def span(self, loop: Loop) -> tuple[float, float]:
        """Return the arc lengths of start and end; the end is increased by the loop's length if necessary."""
        begin, end = (float(loop.corner_arcs[k]) for k in (self.first, self.last))
        return begin, end if end > begin else end + loop.length

    def names(self, loop: Loop) -> tuple[str, ...]:
        """Return the names of the pieces, each from corner to corner, that make up this part of a loop."""
        count = len(loop.corners)
        parts = range(self.first, self.first + ((self.last - self.first - 1) % count) + 1)
        return tuple(loop.names[k % len(loop.names)] for k in parts)


def layered_walls(domain: Domain, names: Collection[str] = ()) -> tuple[list[int], tuple[Stretch, ...]]:
    """Return the indices of the loops with layers all around, and the parts of other loops with layers.

    `names` are the walls with layers. By default, these are the parts of `Domain.layered_loops` that
    `may_be_wall` accepts. Layers continue along an axis or symmetry line that continues a wall. Raises
    InputError if no wall has layers, or if layers would end elsewhere than at corners of about 90 degrees.
    """
    whole: list[int] = []
    stretches: list[Stretch] = []
    for number, loop in enumerate(domain.loops):
        on = _with_layers(domain, number, names)
        for corner in _onward(loop, on):
            on[corner] = True
        if all(on) and not (loop.corner_cells == 1).any():
            whole.append(number)
        elif any(on):
            stretches += _stretches(loop, number, on)
    if not whole and not stretches:
        sides = [*dict.fromkeys(name for loop in domain.loops for name in loop.names if may_be_wall(name))]
        known = f" (of {', '.join(sides[:_SHOWN])}{', ...' * (len(sides) > _SHOWN)})" if sides else ""
        remedy = f"name the walls with {{walls}}{known}, or another side inlet, outlet, symmetry or axis"
        inside = [name for loop in domain.loops[1:] for name in loop.names]
        none = f"whose only holes are {', '.join(dict.fromkeys(inside))}" if inside else "without holes"
        raise InputError(f"a first cell in a domain {none}", remedy)
    return whole, tuple(stretches)


def continued_notes(domain: Domain, names: Collection[str]) -> list[str]:
    """Return a note for each wall whose layers continue beyond its end, along an axis or symmetry line."""
    notes = []
    for number, loop in enumerate(domain.loops):
        walls = _with_layers(domain, number, names)
        for part, (other, corner) in _onward(loop, walls).items():
            if walls[other]:
                x, y = loop.at(loop.corner_arcs[corner : corner + 1])[0]
                line = loop.names[part]
                notes.append(f"layers at {loop.names[other]} go on along {line} beyond ({x:.6g}, {y:.6g})")
    return notes


def _with_layers(domain: Domain, number: int, names: Collection[str]) -> list[bool]:
    """Return whether each part of a loop between corners is a wall with layers."""
    loop, unnamed = domain.loops[number], number in domain.layered_loops
    on = [name in names if names else unnamed and may_be_wall(name) for name in loop.names]
    return on * len(loop.corners) if len(on) == 1 and loop.corners else on


def _onward(loop: Loop, walls: Sequence[bool]) -> dict[int, tuple[int, int]]:
    """Return the axes and symmetry lines that continue layers of `walls`: the part before, and the corner."""
    count, onward = len(loop.corners), dict[int, tuple[int, int]]()
    lines = [k for k, name in enumerate(loop.names) if not may_be_wall(name) and kind_of(name) in _LINES]
    for _ in lines:  # a line may continue another one
        for part in lines:
            after = (part + 1) % count
            for other, corner in (((part - 1) % count, part), (after, after)):
                goes_on = (walls[other] or other in onward) and loop.corner_cells[corner] == 2
                if goes_on and not walls[part]:
                    onward.setdefault(part, (other, corner))
    return onward


def _stretches(loop: Loop, number: int, on: list[bool]) -> list[Stretch]:
    """Return the stretches of a loop; `on` (corners,) says which parts between corners have layers."""
    count, convex = len(on), loop.corner_cells == 1
    for k in range(count):
        if on[k] != on[k - 1] and not convex[k]:
            raise _no_end(loop, k, on[k])
    begins = [k for k in range(count) if on[k] and (convex[k] or not on[k - 1])]
    stretches = []
    for begin in begins:
        end = (begin + 1) % count
        while on[end] and not convex[end]:
            end = (end + 1) % count
        stretches.append(Stretch(number, begin, end))
    return stretches


def _no_end(loop: Loop, corner: int, begins: bool) -> InputError:
    with_layers, without = (corner, corner - 1) if begins else (corner - 1, corner)
    names = loop.names if len(loop.names) > 1 else loop.names * len(loop.corners)
    cells = int(loop.corner_cells[corner])
    way = "goes straight on" if cells == 2 else "turns away"
    x, y = loop.at(loop.corner_arcs[corner : corner + 1])[0]
    return InputError(
        f"layers at {names[with_layers]} would end where the boundary {way}, at ({x:.6g}, {y:.6g})",
        f"name {names[without]} as well: layers end at corners of about 90 degrees only",
        parameter="walls",
    )
