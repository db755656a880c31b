"""The sections of wings on key levels, and the parts of the body that their collars have there."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.errors import InputError
from meshonet.solvers.aircraft.body_map import BodyMap
from meshonet.solvers.aircraft.collar_level import Hole
from meshonet.solvers.aircraft.wing_lines import WingLines
from meshonet.solvers.rows.span_spacing import SAMPLES

_CLEAR = 0.35
"""Least way between neighbouring wings, over the shorter of their chords there."""
_PART = 2.0 / 3.0
"""Part of this way within which a collar takes half."""


def holes_of(
    space: BodyMap, wings: Sequence[WingLines], sections: Sequence[Floats]
) -> tuple[tuple[Hole, ...], ...]:
    """Return the holes of each wing on the key levels, given sections (k, n, 3) on them, from nose to tail.

    Raises InputError: a section that meets the plane of symmetry; wings that are too close to each other.
    """
    for wing, section in zip(wings, sections, strict=True):
        _refuse_symmetric(wing.name, section, space.body.length)
    scales = [_scales(space, each) for each in sections]
    fronts = [each[..., 0].min(axis=1) for each in sections]
    backs = [each[..., 0].max(axis=1) for each in sections]
    for k, (before, after) in enumerate(pairwise(wings)):
        gaps = (fronts[k + 1] - backs[k]) * np.minimum(scales[k][:, 0], scales[k + 1][:, 0])
        chords = [(backs[i] - fronts[i]) * scales[i][:, 0] for i in (k, k + 1)]
        _refuse_close(before.name, after.name, gaps, _CLEAR * np.minimum(*chords))
    ways = [_PART * (fronts[k + 1] - backs[k]) for k in range(len(wings) - 1)]
    begins = [np.zeros(SAMPLES), *(front - way for front, way in zip(fronts[1:], ways, strict=True))]
    ends = [*(back + way for back, way in zip(backs, ways, strict=False)), begins[0] + space.body.length]
    return tuple(
        tuple(
            Hole(section[:, :2], scale, float(section[:, 2].mean()), (float(begin), float(end)))
            for section, scale, begin, end in zip(*each, strict=True)
        )
        for each in zip(sections, scales, begins, ends, strict=True)
    )


def _refuse_symmetric(name: str, sections: Floats, length: float) -> None:
    """Raise InputError for sections (k, n, 3) of a wing that meet the plane of symmetry."""
    (s, theta, _), (far, high, _) = sections.min(axis=(0, 1)), sections.max(axis=(0, 1))
    if theta <= 0.0 or high >= np.pi or s <= 0.0 or far >= length:
        problem = f"the {name} meets the plane of symmetry above or below the body, or its nose or tail"
        raise InputError(problem, "move it, or make it smaller", place="wings")


def _refuse_close(before: str, after: str, gaps: Floats, needed: Floats) -> None:
    """Raise InputError where the gap between two wings (k,) is smaller than needed (k,) on a level."""
    worst = int((gaps - needed).argmin())
    if gaps[worst] < needed[worst]:
        problem = f"{after} begins {gaps[worst]:.3g} behind the end of {before}"
        if gaps[worst] <= 0.0:
            problem = f"{after} begins {-gaps[worst]:.3g} before the end of {before}"
        remedy = f"move one of them by {needed[worst] - gaps[worst]:.3g} or more along the body"
        raise InputError(problem, remedy, place="wings")


def _scales(space: BodyMap, sections: Floats) -> Floats:
    """Return the lengths in space (k, 2) of units of s and theta, the means over sections (k, n, 3)."""
    points, radius = space.points(sections), space.around(sections).mean(axis=1)
    half = (sections.shape[1] - 1) // 2
    chord = norms(points[:, 0] - points[:, half])
    return np.stack([chord / np.abs(sections[:, 0, 0] - sections[:, half, 0]), radius], axis=1)
