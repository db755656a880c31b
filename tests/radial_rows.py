"""Rows with radial parts, made by seed: impellers, radial turbines, mixed-flow pumps, vaned diffusers.

Meridional curves are arcs of ellipses with straight parts before and behind; blades follow an angle to the
meridional direction that changes from edge to edge, with a thickness normal to them in (m', theta), an
elliptic leading edge, and a trailing edge that is round or cut off at a constant place.
"""

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.rows.row import Row

KINDS = ("impeller", "turbine", "pump", "diffuser")
_FINE = 1201


@dataclass(frozen=True)
class Blade:
    """Angles in degrees from the meridional direction at hub and shroud, lengths in those of the channel.

    Parameters
    ----------
    angles : ((hub, shroud) at the leading edge, (hub, shroud) at the trailing edge).
    thickness : (hub, shroud).
    lean : how far the shroud is ahead of the hub at the trailing edge, and at the leading edge, in degrees.
    nose : length of the elliptic leading edge in thicknesses.
    blunt : whether the trailing edge is cut off.
    """

    angles: tuple[tuple[float, float], tuple[float, float]]
    thickness: tuple[float, float]
    lean: tuple[float, float] = (0.0, 0.0)
    nose: float = 1.5
    blunt: bool = False


def ellipse(start: tuple[float, float], end: tuple[float, float], *, bend: float = 90.0) -> np.ndarray:
    """Points (n, 2) x, r from an axial direction at `start` to one turned outwards by `bend` at `end`."""
    phi = np.radians(np.linspace(0.0, bend, 61))
    x, r = np.sin(phi), 1.0 - np.cos(phi)
    scale = (end[0] - start[0]) / x[-1], (end[1] - start[1]) / r[-1]
    return np.stack([start[0] + scale[0] * x, start[1] + scale[1] * r], axis=1)


def extended(line: np.ndarray, before: float, behind: float) -> np.ndarray:
    """Points (n, 2) of a line with straight parts of some lengths before and behind."""
    t = np.linspace(0.0, 1.0, 16)[1:, None]
    first, last = line[0] - line[1], line[-1] - line[-2]
    first, last = first / np.hypot(*first), last / np.hypot(*last)
    return np.concatenate([(line[0] + before * t * first)[::-1], line, line[-1] + behind * t * last])


def _arcs(line: np.ndarray) -> np.ndarray:
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])


def _even(line: np.ndarray, count: int) -> np.ndarray:
    arcs = _arcs(line)
    at = np.linspace(0.0, arcs[-1], count)
    return np.stack([np.interp(at, arcs, line[:, k]) for k in (0, 1)], axis=1)


def profiles(
    hub: np.ndarray, shroud: np.ndarray, blade: Blade, spans: tuple[float, ...], points: int = 60
) -> tuple[np.ndarray, ...]:
    """Closed profiles (n, 3) of x, y, z between two curves, from their first to their last points."""
    low, high = _even(hub, _FINE), _even(shroud, _FINE)
    cambers = []
    for span in (0.0, 1.0, *spans):
        line = (1.0 - span) * low + span * high
        t = np.linspace(0.0, 1.0, _FINE)
        first, last = (
            (1.0 - span) * np.tan(np.radians(a[0])) + span * np.tan(np.radians(a[1])) for a in blade.angles
        )
        slope = first + (last - first) * t * t * (3.0 - 2.0 * t)
        meridional = np.concatenate(
            [[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T) / (0.5 * (line[1:, 1] + line[:-1, 1])))]
        )
        theta = _sums(slope, meridional)
        bump = _sums(t * (1.0 - t), meridional)
        cambers.append((span, line, meridional, theta, bump))
    wrap = np.mean([camber[3][-1] for camber in cambers[:2]])
    made = []
    for span, line, meridional, theta, bump in cambers[2:]:
        lean = np.radians(span * (np.array(blade.lean[0]) - blade.lean[1]))
        theta = theta + (wrap + lean - theta[-1]) / bump[-1] * bump + np.radians(span * blade.lean[1])
        thickness = (1.0 - span) * blade.thickness[0] + span * blade.thickness[1]
        made.append(_profile(line, meridional, theta, thickness, blade, points))
    return tuple(made)


def _sums(values: np.ndarray, knots: np.ndarray) -> np.ndarray:
    return np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(knots))])


def _profile(
    line: np.ndarray, m: np.ndarray, theta: np.ndarray, thickness: float, blade: Blade, points: int
) -> np.ndarray:
    """One profile: both sides of the camber line (m, theta) at half the thickness."""
    camber = np.stack([m, theta], axis=1)
    along = _arcs(camber)
    space = np.concatenate([[0.0], np.cumsum(0.5 * (line[1:, 1] + line[:-1, 1]) * np.diff(along))])
    q = 0.5 * (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, points)))
    half = 0.5 * thickness
    nose = 2.0 * blade.nose * half
    a = np.linspace(0.0, 0.5 * np.pi, 12)
    end = space[-1] + (4.0 * thickness if blade.blunt else 0.0)
    tail = end if blade.blunt else end - half
    body = nose + (tail - nose) * q
    at = np.concatenate([nose * (1.0 - np.cos(a)), body[1:-1] if not blade.blunt else body[1:]])
    wide = np.concatenate([half * np.sin(a), np.full(len(at) - len(a), half)])
    if not blade.blunt:
        at = np.concatenate([at, tail + half * np.sin(a)])
        wide = np.concatenate([wide, half * np.cos(a)])
    tangent = np.gradient(camber, along, axis=0)
    sides = []
    for sign in (1.0, -1.0):
        place = np.interp(np.minimum(at, space[-1]), space, along)
        centre = np.stack([np.interp(place, along, column) for column in camber.T], axis=1)
        way = np.stack([np.interp(place, along, column) for column in tangent.T], axis=1)
        way /= np.hypot(*way.T)[:, None]
        radius = np.interp(place, along, line[:, 1])
        beyond = np.maximum(at - space[-1], 0.0) / line[-1, 1]
        normal = np.stack([-way[:, 1], way[:, 0]], axis=1)
        side = centre + beyond[:, None] * way + sign * (wide / radius)[:, None] * normal
        if blade.blunt:
            side = _cut(side, m[-1])
        sides.append(side)
    upper, lower = sides
    plane = np.concatenate([upper, lower[::-1] if blade.blunt else lower[-2::-1]])
    plane = plane[:-1]
    place = np.clip(plane[:, 0], m[0], m[-1])
    x, r = (np.interp(place, m, column) for column in line.T)
    return np.stack([x, r * np.sin(plane[:, 1]), r * np.cos(plane[:, 1])], axis=1)


def _cut(side: np.ndarray, end: float) -> np.ndarray:
    """The part of a side before m' = end, with a point there."""
    behind = int(np.flatnonzero(side[:, 0] > end)[0])
    a, b = side[behind - 1], side[behind]
    last = a + (end - a[0]) / (b[0] - a[0]) * (b - a)
    kept = side[:behind]
    if np.hypot(*(last - kept[-1])) < 0.3 * np.hypot(*(kept[-1] - kept[-2])):
        kept = kept[:-1]
    return np.concatenate([kept, last[None]])


def _spans(rng: np.random.Generator) -> tuple[float, ...]:
    return tuple(np.linspace(0.0, 1.0, int(rng.integers(3, 10))))


def _channel(
    rng: np.random.Generator, root: tuple[float, float], tip: tuple[float, float],
    width: tuple[float, float], length: tuple[float, float],
) -> tuple[np.ndarray, np.ndarray, float]:  # fmt: skip
    """Hub and shroud from an axial to a radial end of radius 1, and the width there, within ranges.

    Ranges are those of the radius of the hub at the axial end in that of the shroud, of this one, of the
    width and of the length of the hub.
    """
    shroud_radius = rng.uniform(*tip)
    hub_radius = rng.uniform(*root) * shroud_radius
    across, along = rng.uniform(*width), rng.uniform(*length)
    hub = ellipse((0.0, hub_radius), (along, 1.0))
    return hub, ellipse((0.0, shroud_radius), (along - across, 1.0)), across


def impeller(seed: int, *, gap: bool | None = None) -> Row:
    """A centrifugal compressor: axial inlet, radial outlet with a backsweep, 11 to 20 blades."""
    rng = np.random.default_rng(seed)
    hub, shroud, width = _channel(rng, (0.25, 0.45), (0.6, 0.72), (0.06, 0.14), (0.6, 0.8))
    back = -rng.uniform(0.0, 50.0)
    blade = Blade(
        ((-rng.uniform(25.0, 40.0), -rng.uniform(52.0, 62.0)), (back, back)),
        tuple(rng.uniform(0.012, 0.03) * np.array([1.0, rng.uniform(0.5, 1.0)])),
        (rng.uniform(-10.0, 10.0), rng.uniform(-5.0, 5.0)), rng.uniform(1.0, 3.0), bool(rng.integers(2)),
    )  # fmt: skip
    ends = rng.uniform(0.25, 0.6), rng.uniform(0.15, 0.4)
    return _row(rng, "impeller", hub, shroud, blade, ends, int(rng.integers(11, 21)), gap, 0.05 * width)


def eckardt() -> Row:
    """Like Eckardt's impeller O: 20 blades that end radially in a flat edge, and a gap at the shroud."""
    hub, shroud = ellipse((0.0, 0.225), (0.65, 1.0)), ellipse((0.0, 0.7), (0.52, 1.0))
    blade = Blade(((-32.0, -63.0), (0.0, 0.0)), (0.02, 0.01), blunt=True)
    made = profiles(hub, shroud, blade, (0.0, 0.25, 0.5, 0.75, 1.0))
    low, high = (0.2 * extended(line, 0.4, 0.25) for line in (hub, shroud))
    return Row(tuple(0.2 * each for each in made), low, high, 20, 0.00038, 0.0, "eckardt")


def turbine(seed: int, *, gap: bool | None = None) -> Row:
    """A radial turbine: radial inlet, axial outlet, radial blades at the inlet."""
    rng = np.random.default_rng(seed)
    *walls, width = _channel(rng, (0.3, 0.45), (0.55, 0.7), (0.1, 0.18), (0.5, 0.75))
    hub, shroud = (wall[::-1] * [-1.0, 1.0] for wall in walls)
    first = rng.uniform(-5.0, 5.0)
    blade = Blade(
        ((first, first), (-rng.uniform(30.0, 42.0), -rng.uniform(50.0, 62.0))),
        tuple(rng.uniform(0.02, 0.035) * np.array([1.0, rng.uniform(0.5, 1.0)])),
        (rng.uniform(-5.0, 5.0), rng.uniform(-5.0, 5.0)), rng.uniform(0.5, 1.5), bool(rng.integers(2)),
    )  # fmt: skip
    ends = rng.uniform(0.1, 0.3), rng.uniform(0.3, 0.6)
    return _row(rng, "turbine", hub, shroud, blade, ends, int(rng.integers(10, 15)), gap, 0.03 * width)


def pump(seed: int, *, gap: bool | None = None) -> Row:
    """A mixed-flow pump: a conical outlet, 5 to 7 long blades that wrap far around the axis."""
    rng = np.random.default_rng(seed)
    bend = rng.uniform(40.0, 65.0)
    root, tip = rng.uniform(0.22, 0.32), rng.uniform(0.55, 0.65)
    hub = ellipse((0.0, root), (rng.uniform(0.6, 0.75), 0.92), bend=bend)
    across = np.array([-np.sin(np.radians(bend)), np.cos(np.radians(bend))])
    end = hub[-1] + rng.uniform(0.2, 0.3) * across
    shroud = ellipse((0.0, tip), (float(end[0]), float(end[1])), bend=bend)
    last = rng.uniform(58.0, 68.0)
    blade = Blade(
        ((rng.uniform(45.0, 58.0), rng.uniform(66.0, 73.0)), (last, last)),
        tuple(rng.uniform(0.02, 0.035) * np.array([1.0, rng.uniform(0.6, 1.0)])),
        (rng.uniform(-10.0, 10.0), rng.uniform(-10.0, 10.0)), rng.uniform(1.0, 2.0), bool(rng.integers(2)),
    )  # fmt: skip
    ends = rng.uniform(0.3, 0.6), rng.uniform(0.3, 0.6)
    return _row(rng, "pump", hub, shroud, blade, ends, int(rng.integers(5, 8)), gap, 0.004)


def diffuser(seed: int, *, gap: bool | None = None) -> Row:
    """A vaned diffuser between plane discs."""
    rng = np.random.default_rng(seed)
    width, end = rng.uniform(0.06, 0.12), rng.uniform(1.35, 1.6)
    r = np.linspace(1.0, end, 31)
    hub = np.stack([np.full(31, 0.5), r], axis=1)
    shroud = hub - [width, 0.0]
    blade = Blade(
        ((rng.uniform(62.0, 72.0),) * 2, (rng.uniform(45.0, 60.0),) * 2),
        (rng.uniform(0.012, 0.03),) * 2, nose=rng.uniform(0.5, 2.0), blunt=bool(rng.integers(2)),
    )  # fmt: skip
    ends = rng.uniform(0.06, 0.15), rng.uniform(0.15, 0.5)
    return _row(rng, "diffuser", hub, shroud, blade, ends, int(rng.integers(13, 27)), gap, 0.0)


def _row(
    rng: np.random.Generator, name: str, hub: np.ndarray, shroud: np.ndarray, blade: Blade,
    ends: tuple[float, float], blades: int, gap: bool | None, width: float,
) -> Row:  # fmt: skip
    made = profiles(hub, shroud, blade, _spans(rng))
    if gap is None:
        gap = bool(rng.integers(2))
    scale = rng.uniform(0.05, 0.3)  # radius of the impeller in metres
    low, high = (scale * extended(line, *ends) for line in (hub, shroud))
    profile = tuple(scale * each for each in made)
    return Row(profile, low, high, blades, scale * width if gap else 0.0, 0.0, name)


def radial_row(seed: int) -> Row:
    """The row of a seed: of the kinds in turn."""
    return globals()[KINDS[seed % len(KINDS)]](seed)
