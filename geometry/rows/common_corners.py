"""Corners of profiles, made the same along the span."""

from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import Floats, middle
from meshonet.geometry.polygon.corners import SHARP
from meshonet.geometry.rows.profile import BladeProfile

BASE_TURN = 0.7
"""Smallest part of the turns at an edge that its two largest have at a base."""


def alike(profiles: Sequence[BladeProfile]) -> list[BladeProfile]:
    """Return the profiles with equal numbers of corners at equal places u.

    Whether a turn is a corner depends on points near it, and so differs from profile to profile. Lines of
    equal u would then jump along the span.
    """
    counts = np.array([profile.corner_counts for profile in profiles])
    if not (counts == counts[0]).all():
        same = [_count(profiles, counts[:, k], bool(k)) for k in (0, 1)]
        profiles = [profile.cornered(same) for profile in profiles]
    places = common_corners(profiles)
    return [profile.aligned(places) for profile in profiles] if len(places) else list(profiles)


def _count(profiles: Sequence[BladeProfile], counts: Floats, trailing: bool) -> int:
    """Return how many corners an edge has, from those of each profile (p,)."""
    if (counts == counts[0]).all():
        return int(counts[0])
    turn, part = np.array([profile.sharpness(trailing) for profile in profiles]).T
    return 2 if middle(part) > BASE_TURN else int(middle(turn) > SHARP)


def common_corners(profiles: Sequence[BladeProfile]) -> Floats:
    """Return the median places u (c,), -0.25 to 0.75, of the corners; empty if their numbers differ."""
    places = [profile.corner_places() for profile in profiles]
    if len({len(each) for each in places}) != 1 or not len(places[0]):
        return np.empty(0)
    return np.array([middle(column) for column in np.array(places).T])
