"""Sections of wings on key levels, and the limits of their collars."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice, pairwise, product
from typing import TypeVar

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.errors import InputError
from meshonet.solvers.aircraft.body_map import BodyMap
from meshonet.solvers.aircraft.collar import Within
from meshonet.solvers.aircraft.collar_level import Hole
from meshonet.solvers.aircraft.wing_lines import WingLines
from meshonet.solvers.rows.span_spacing import SAMPLES

_CLEAR = 0.35  # smallest distance between neighbouring wings, divided by the shorter of the two chords there
_CLEAR_FIN = 0.9  # the same for a fin with its own column: levels between it and a long wing are steep
_PART = 2.0 / 3.0  # a collar takes at most half of this fraction of the distance


def columns_of(
    space: BodyMap, wings: Sequence[WingLines], sections: Sequence[Floats]
) -> tuple[tuple[int, ...], ...]:
    """Return groups of wings, as indices, from nose to tail; a fin above a wing is in the wing's group.

    `sections` has, for each wing, n nodes around it on each of k nested surfaces that enclose the body:
    (k, n, 3) in the coordinates of `space`. Raises InputError if a fin is above two wings.
    """
    columns = [[k] for k in range(len(wings))]
    along = [_along(space, *pair) for pair in zip(wings, sections, strict=True)]
    for fin, each in enumerate(wings):
        if not each.fin:
            continue
        near = [k for k, wing in enumerate(wings) if not wing.fin and _near(along[k], along[fin])]
        if len(near) > 1:
            names = " and ".join(wings[k].name for k in near)
            problem = f"the {each.name} is above {names}, or close to them"
            raise InputError(problem, "make it shorter, or move it along the body", place="wings")
        for k in near:
            columns[k].append(fin)
            columns[fin] = []
    return tuple(tuple(column) for column in columns if column)


def _near(one: "_Along", other: "_Along") -> bool:
    """Return whether two wings overlap along the body, or nearly so, on some level."""
    rooms = _room(one, other, _CLEAR_FIN), _room(other, one, _CLEAR_FIN)
    return not any(bool((gaps >= needed).all()) for gaps, needed in rooms)


Each = TypeVar("Each")


def ordered(columns: Sequence[Sequence[int]], values: Sequence[Each]) -> list[Each]:
    """Return `values[k]` for each index k in the lists `columns`, one list after another."""
    return [values[k] for column in columns for k in column]


def grouped(columns: Sequence[Sequence[int]], values: Sequence[Each]) -> list[list[Each]]:
    """Split `values` into consecutive lists; the k-th list is as long as `columns[k]`."""
    rest = iter(values)
    return [list(islice(rest, len(column))) for column in columns]


@dataclass(frozen=True, eq=False)
class _Along:
    """Extent of sections along the body: least and largest s (k,), lengths of a unit of s (k,)."""

    front: Floats
    back: Floats
    scale: Floats

    @property
    def chord(self) -> Floats:
        return (self.back - self.front) * self.scale


def _along(space: BodyMap, wing: WingLines, sections: Floats) -> _Along:
    s = sections[..., 0]
    return _Along(s.min(axis=1), s.max(axis=1), _scales(space, wing, sections)[:, 0])


def _room(before: _Along, after: _Along, clear: float = _CLEAR) -> tuple[Floats, Floats]:
    """Return the gaps between two wings on levels (k,), and the gaps needed."""
    gaps = (after.front - before.back) * np.minimum(before.scale, after.scale)
    return gaps, clear * np.minimum(before.chord, after.chord)


def holes_of(
    space: BodyMap, columns: Sequence[Sequence[WingLines]], sections: Sequence[Sequence[Floats]]
) -> tuple[tuple[tuple[Hole, ...], ...], ...]:
    """Return the sections of wings on k surfaces around the body, nested as [group][wing][surface].

    `columns` are groups of wings, from nose to tail: a wing, a fin, or a wing and the fin above it. For each
    wing, `sections` has its nodes (k, n, 3), n on each surface. Raises InputError if a section meets the
    plane of symmetry, or if wings are too close to each other.
    """
    for column, members in zip(columns, sections, strict=True):
        for wing, each in zip(column, members, strict=True):
            _refuse_symmetric(wing, each, space.body.length)
    along = [
        [_along(space, *pair) for pair in zip(*each, strict=True)]
        for each in zip(columns, sections, strict=True)
    ]
    for k, pair in enumerate(pairwise(along)):
        for (before, one), (after, other) in product(
            *(zip(columns[k + n], pair[n], strict=True) for n in (0, 1))
        ):
            _refuse_close(before.name, after.name, *_room(one, other))
    fronts = [np.min([each.front for each in members], axis=0) for members in along]
    backs = [np.max([each.back for each in members], axis=0) for members in along]
    ways = [_PART * (after - before) for before, after in zip(backs[:-1], fronts[1:], strict=True)]
    begins = [np.zeros(SAMPLES), *(front - way for front, way in zip(fronts[1:], ways, strict=True))]
    ends = [
        *(back + way for back, way in zip(backs[:-1], ways, strict=True)),
        np.full(SAMPLES, space.body.length),
    ]
    holes = []
    for column, members, begin, end in zip(columns, sections, begins, ends, strict=True):
        bounds = _bounds(column, members)
        within = [
            [((b, e), (low, high)) for b, e, low, high in np.stack([begin, end, *each], axis=1).tolist()]
            for each in bounds
        ]
        made = enumerate(zip(column, members, within, strict=True))
        holes.append(tuple(_holes(space, *each, above=k > 0) for k, each in made))
    return tuple(holes)


def _bounds(wings: Sequence[WingLines], sections: Sequence[Floats]) -> list[tuple[Floats, Floats]]:
    """Return limits of theta (k,) of a column's collars. Raises InputError: a wing meets the fin above."""
    keel, crown = np.zeros(SAMPLES), np.full(SAMPLES, np.pi)
    if len(wings) == 1:
        return [(0.5 * crown, 1.5 * crown) if wings[0].fin else (keel, crown)]
    high, low = sections[0][..., 1].max(axis=1), sections[1][..., 1].min(axis=1)
    if (low <= high).any():
        problem = f"the {wings[0].name} meets the {wings[1].name}"
        raise InputError(problem, "move it down, to the side of the body", place="wings")
    way = _PART * (low - high)
    return [(keel, high + way), (low - way, 2.0 * crown - (low - way))]


def _holes(
    space: BodyMap, wing: WingLines, sections: Floats, within: Sequence[Within], *, above: bool
) -> tuple[Hole, ...]:
    """Return the holes of a wing, or of a fin `above` one, from sections (k, n, 3) on key levels."""
    loops = sections[..., :2]
    if wing.fin:
        image = loops[:, :0:-1] * [1.0, -1.0] + [0.0, 2.0 * np.pi]
        loops = np.concatenate([image, loops], axis=1)
    levels = zip(
        loops, _scales(space, wing, sections), sections[..., 2].mean(axis=1).tolist(), within, strict=True
    )
    return tuple(Hole(*level, wing.fin, level[-1][1][0] if above else 0.0) for level in levels)


def _refuse_symmetric(wing: WingLines, sections: Floats, length: float) -> None:
    """Raise InputError for a wing whose sections (k, n, 3) meet the plane of symmetry."""
    (s, theta, _), (far, high, _) = sections.min(axis=(0, 1)), sections.max(axis=(0, 1))
    if s <= 0.0 or far >= length or (not wing.fin and (theta <= 0.0 or high >= np.pi)):
        where = (
            "its nose or tail"
            if wing.fin
            else "the plane of symmetry above or below the body, or its nose or tail"
        )
        problem = f"the {wing.name} meets {where}"
        raise InputError(problem, "move it, or make it smaller", place="wings")


def _refuse_close(before: str, after: str, gaps: Floats, needed: Floats) -> None:
    """Raise InputError if a gap between two wings (k,) is smaller than needed (k,)."""
    worst = int((gaps - needed).argmin())
    if gaps[worst] < needed[worst]:
        problem = f"{after} begins {gaps[worst]:.3g} behind the end of {before}"
        if gaps[worst] <= 0.0:
            problem = f"{after} begins {-gaps[worst]:.3g} before the end of {before}"
        remedy = f"move one of them by {needed[worst] - gaps[worst]:.3g} or more along the body"
        raise InputError(problem, remedy, place="wings")


def _scales(space: BodyMap, wing: WingLines, sections: Floats) -> Floats:
    """Return the mean lengths in space (k, 2) of a unit of s and theta on sections (k, n, 3)."""
    points, radius = space.points(sections), space.around(sections).mean(axis=1)
    other = -1 if wing.fin else (sections.shape[1] - 1) // 2
    chord = norms(points[:, 0] - points[:, other])
    return np.stack([chord / np.abs(sections[:, 0, 0] - sections[:, other, 0]), radius], axis=1)
