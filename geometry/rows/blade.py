"""The surface of a blade: splines along the span through its profiles."""

from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import Floats, middle
from meshonet.geometry.curves.cubic import CubicTable
from meshonet.geometry.elementary import cos
from meshonet.geometry.errors import InputError, in_place
from meshonet.geometry.notes import Change
from meshonet.geometry.polygon.corners import SHARP
from meshonet.geometry.rows.channel import Channel
from meshonet.geometry.rows.profile import BladeProfile
from meshonet.geometry.rows.thick_edge import LEAST_EDGE, pointed, thick_edged
from meshonet.kernels._native import spline_crossings

MOST_EXTENDED = 0.2  # largest part of the span by which a blade is continued to hub or casing
_NOTED = 0.01  # part of the span from which on a note mentions the continuation
_CHECKED = 400  # places around the blade at which profiles are compared
_FARTHEST = 90.0  # degrees around the axis from one profile to the next: no blade leans as much
_ORDER = "give profiles from hub to casing, all of one blade: splitters are not made"
_SAME_HEIGHT = 1e-9  # difference of heights, in spans, that counts as rounding
_HALF_TURN = np.pi
_BASE_TURN = 0.7  # smallest part of the turns at an edge that its two largest have at a base
_WHOLE = 0.2  # largest deviation of a displacement from whole pitches; beyond it the blade leans


class BladeSurface:
    """Surface of a blade: the map from a place u around the blade and a height h to (s, theta).

    u is 0 at the leading edge, 0.5 at the trailing edge, and 1 at the leading edge again (see
    `BladeProfile`). h goes from 0 at the hub to 1 at the casing, s from 0 at the inlet to 1 at the outlet
    (see `Channel`). theta is the angle about the axis. Lines of equal u are splines through the profiles,
    continued straight beyond them.

    Parameters
    ----------
    profiles : two or more arrays (n, 3) of x, y, z, in order from hub to casing or from casing to hub.
    channel : the channel in which the blade stands.
    blades : number of blades; profiles on different blades are rotated to lie on one blade.

    Raises InputError: profiles that are not in order along the span, cross each other, lie too far apart
    around the axis, or leave a large gap at hub or casing; a faulty profile (see `BladeProfile`).
    """

    def __init__(self, profiles: Sequence[Floats], channel: Channel, blades: int) -> None:
        self.channel = channel
        self.pitch = 2.0 * np.pi / blades
        self.profiles: list[BladeProfile] = []
        for number, points in enumerate(profiles, start=1):
            with in_place(f"profile {number}"):
                self.profiles.append(BladeProfile(points, channel))
        self.notes: tuple[str, ...] = ()
        for name, trailing in (("leading", False), ("trailing", True)):
            self._open(name, trailing)
        self._reversed = False
        self._check_distinct()
        if (np.diff([profile.height for profile in self.profiles]) < 0.0).all():
            self.profiles.reverse()
            self._reversed = True
            note = Change("profiles are given from casing to hub and are taken the other way round")
            self.notes = (*self.notes, note)
        self.knots = np.array([profile.height for profile in self.profiles])
        self._check()
        self.profiles = _alike(self.profiles)
        self._turns = self._unwrapped()
        self._check_neighbours()

    def _open(self, name: str, trailing: bool) -> None:
        """Open and round leading or trailing edges that are points, with a note."""
        points = [pointed(profile, trailing) for profile in self.profiles]
        if any(points):
            pairs = list(zip(self.profiles, points, strict=True))
            self.profiles = [thick_edged(each, trailing) if sharp else each for each, sharp in pairs]
            what = f"{name} edges of {sum(points)} of {len(points)} profiles, which are points, are"
            self.notes = (*self.notes, Change(f"{what} opened to {LEAST_EDGE:g} chords and rounded"))

    def _check_distinct(self) -> None:
        heights = np.array([profile.height for profile in self.profiles])
        for k in np.flatnonzero(np.abs(np.diff(heights)) <= _SAME_HEIGHT)[:1]:
            problem = f"is at {100 * heights[k]:.3g} % of the span, as the one before"
            raise InputError(problem, "give one at each height, all of one blade", place=f"profile {k + 2}")

    def _check(self) -> None:
        heights = self.knots
        wrong = np.flatnonzero(np.diff(heights) <= 0.0)
        if len(wrong):
            k = int(wrong[0])
            problem = (
                f"is at {100 * heights[k + 1]:.3g} % of the span, behind one at {100 * heights[k]:.3g} %"
            )
            raise InputError(problem, _ORDER, place=self._place(k + 1))
        foot, tip = self.channel.foot, self.channel.tip
        low, high = self.profiles[0].range[1], self.profiles[-1].range[0]
        if low - foot > MOST_EXTENDED:
            problem = f"begins at {100 * low:.3g} % of the span"
            raise InputError(problem, "give a profile nearer to the hub", place=self._place(0))
        if tip - high > MOST_EXTENDED:
            problem = f"ends at {100 * high:.3g} % of the span"
            place = self._place(len(self.profiles) - 1)
            raise InputError(problem, "give a profile nearer to the casing", place=place)
        for wall, missing in (("hub", low - foot), ("casing", tip - high)):
            if missing > _NOTED:
                what = f"the blade ends {100 * missing:.2g} % of the span before the {wall} or its gap"
                self.notes = (*self.notes, Change(f"{what}, and is continued straight to it"))

    def _place(self, k: int) -> str:
        return f"profile {len(self.profiles) - k if self._reversed else k + 1}"

    def _check_neighbours(self) -> None:
        u = clustered(_CHECKED)
        values = np.stack([profile.at(u) for profile in self.profiles])
        for k in range(1, len(values)):
            if not (values[k, :, 2] > values[k - 1, :, 2]).all():
                problem = "crosses the one before"
                raise InputError(problem, "give profiles beside each other", place=self._place(k))

    def check_pitch(self) -> None:
        """Raise InputError if a blade touches the next one."""
        angles = [profile.thickness for profile in self.profiles]
        k = int(np.argmax(angles))
        if angles[k] >= self.pitch:
            problem = (
                f"is {np.degrees(angles[k]):.4g} degrees thick, and blades are "
                f"{np.degrees(self.pitch):.4g} apart"
            )
            raise InputError(problem, "use fewer blades", place=self._place(k))

    def _unwrapped(self) -> Floats:
        """Return angles (p,) added to theta of profiles: whole turns, and whole pitches, with notes."""
        mean = np.array([profile.curve.points[:, 1].mean() for profile in self.profiles])
        turned = np.unwrap(mean)
        for k, step in enumerate(np.degrees(np.abs(np.diff(turned))).tolist(), start=1):
            if step > _FARTHEST:
                problem = f"lies {step:.4g} degrees around the axis from the one before"
                raise InputError(problem, "give profiles of one blade", place=self._place(k))
        away = _whole_pitches(turned, self.knots, self.pitch)
        for k in np.flatnonzero(away).tolist():
            angle = -float(np.degrees(away[k] * self.pitch))
            what = (
                f"{self._place(k)} is turned by {angle:.6g} degrees, whole pitches, to lie beside the others"
            )
            self.notes = (*self.notes, Change(f"{what}; if the blade leans so, give profiles in between"))
        return np.asarray(turned - mean - away * self.pitch)

    def lines(self, u: Floats) -> CubicTable:
        """Return m splines of s, theta and h along the span, at places `u` (m,) around the blade.

        u: 0 leading, 0.5 trailing edge. s: 0 inlet, 1 outlet. h: 0 hub, 1 casing. theta: about the axis.
        """
        values = np.stack([profile.at(u) for profile in self.profiles])
        values[..., 1] += self._turns[:, None]
        return CubicTable(values, self.knots)

    def at(self, u: Floats, h: Floats) -> Floats:
        """Return points s, theta (p, m, 2) of the blade, at heights `h` (p, m) from 0 (hub) to 1 (casing).

        They are at places `u`, (m,) or (p, m), around the blade: 0 leading edge, 0.5 trailing edge.
        """
        return self.crossings(self.lines(u.ravel()), h, len(h) if u.ndim == 1 else 1)

    def crossings(self, lines: CubicTable, h: Floats, levels: int = 1) -> Floats:
        """Return points s, theta (..., 2) at which m splines along the span reach the heights `h` (...).

        `lines` are the splines, from the method `lines`. `h` is (`levels`, m) or, if `levels` is 1, of any
        shape with m elements. It is 0 at the hub, 1 at the casing. s is 0 at the inlet, 1 at the outlet.
        """
        out = np.empty((*h.shape, 2))
        spline_crossings(
            lines.values,
            lines.bends,
            self.knots,
            np.ascontiguousarray(h).reshape(levels, -1),
            out.reshape(levels, -1, 2),
        )
        return out

    def section(self, h: float, u: Floats) -> Floats:
        """Return (m, 2): s (0 inlet, 1 outlet), theta at height `h` (0 hub, 1 casing); see `at` for `u`."""
        return self.crossings(self.lines(u), np.full(len(u), h))

    @property
    def edges(self) -> str:
        """Forms of the leading and of the trailing edge, as text."""
        words = [dict.fromkeys(each.edge(trailing) for each in self.profiles) for trailing in (False, True)]
        leading, trailing = (" or ".join(each) for each in words)
        return f"leading edge {leading}; trailing edge {trailing}"

    @property
    def corners(self) -> Floats:
        """Places u (c,), from 0 to 1 around the blade, of the corners that all profiles share; ascending."""
        return np.sort(np.mod(_common_corners(self.profiles), 1.0))


def clustered(count: int) -> Floats:
    """Return `count` places u around a blade, 0 to 1, clustered at both edges; `count` must be even."""
    half = count // 2
    side = 0.25 * (1.0 - cos(_HALF_TURN * np.arange(half) / half))
    return np.concatenate([side, 0.5 + side])


def _whole_pitches(angles: Floats, heights: Floats, pitch: float) -> Floats:
    """Return by how many pitches (p,) each profile is away from the blade to which most profiles belong.

    A step of theta between two profiles counts only if whole pitches remain after subtraction of the lean
    between other profiles. `angles` (p,) are the mean theta of profiles in radians; `heights` (p,) ascend.
    """
    steps, rises = np.diff(angles), np.diff(heights)
    away = np.zeros(len(angles))
    for k, step in enumerate(steps):
        lean = np.append(np.delete(steps / rises, k) * rises[k], 0.0)
        off = (step - lean)[np.abs(step - lean).argmin()] / pitch
        whole = np.rint(off)
        if abs(off - whole) < _WHOLE:
            away[k + 1 :] += whole
    return np.asarray(away - np.sort(away)[(len(away) - 1) // 2])


def _alike(profiles: Sequence[BladeProfile]) -> list[BladeProfile]:
    """Return the profiles with equal numbers of corners at equal places u.

    Whether a turn is a corner depends on points near it, and so differs from profile to profile. Lines of
    equal u would then jump along the span.
    """
    counts = np.array([profile.corner_counts for profile in profiles])
    if not (counts == counts[0]).all():
        same = [_corner_count(profiles, counts[:, k], bool(k)) for k in (0, 1)]
        profiles = [profile.cornered(same) for profile in profiles]
    places = _common_corners(profiles)
    return [profile.aligned(places) for profile in profiles] if len(places) else list(profiles)


def _corner_count(profiles: Sequence[BladeProfile], counts: Floats, trailing: bool) -> int:
    """Return how many corners an edge has, from those of each profile (p,)."""
    if (counts == counts[0]).all():
        return int(counts[0])
    turn, part = np.array([profile.sharpness(trailing) for profile in profiles]).T
    return 2 if middle(part) > _BASE_TURN else int(middle(turn) > SHARP)


def _common_corners(profiles: Sequence[BladeProfile]) -> Floats:
    """Return the median places u (c,), -0.25 to 0.75, of the corners; empty if their numbers differ."""
    places = [profile.corner_places() for profile in profiles]
    if len({len(each) for each in places}) != 1 or not len(places[0]):
        return np.empty(0)
    return np.array([middle(column) for column in np.array(places).T])
