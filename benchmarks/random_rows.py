"""Random blade rows of real sections, by seed."""

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.registry import read_shapes
from meshonet.geometry.errors import MeshonetError
from meshonet.geometry.rows.row import Row
from meshonet.geometry.rows.thick_edge import round_edged
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil

Floats = NDArray[np.float64]
LEAST_THROAT = 0.2
"""Of the pitch, at the hub: rows whose passages are narrower are drawn again."""
_PROFILES = 5


@dataclass(frozen=True, eq=False)
class Drawn:
    """A random row and what it was drawn with."""

    row: Row
    words: str


def airfoils(folder: Path) -> list[Airfoil]:
    """Return the sections of a folder, each with a round trailing edge at least 1 % of its chord thick."""
    rounded = []
    for airfoil in readable_airfoils(folder):
        with suppress(MeshonetError):
            rounded.append(round_edged(airfoil)[0])
    return rounded


def readable_airfoils(folder: Path) -> Iterator[Airfoil]:
    """Yield the airfoils among the .dat files of a folder, by name."""
    for path in sorted(folder.glob("*.dat")):
        with suppress(MeshonetError):
            (shape,) = read_shapes(str(path))
            if isinstance(shape, Airfoil):
                yield shape


def drawn_rows(sections: Sequence[Airfoil], seed: int, count: int) -> list[Drawn]:
    """Return random rows.

    Stagger 0 to 65 degrees at mid-span and 30 less to 30 more at both ends, within that range; solidity 0.7
    to 2 at mid-span; hub to tip ratio 0.4 to 0.9; a cylindrical, conical or curved channel; a gap of 0 to 3 %
    of the span, at the tip or at the hub, in two of three. Sections, two each, are blended along the span.
    """
    generator = np.random.default_rng(seed)
    out: list[Drawn] = []
    while len(out) < count:
        made = _drawn(sections, generator, len(out))
        if made is not None:
            out.append(made)
    return out


def _outline(airfoil: Airfoil, turned: bool) -> Floats:
    """Return 241 points (n, 2) around a section of unit chord, from edge to edge, at equal parts of sides."""
    curve = airfoil.curve
    points = curve.at(np.linspace(0.0, curve.length, 4001)[:-1])
    points = (points - airfoil.leading_edge) / airfoil.chord
    chord = (airfoil.trailing_edge - airfoil.leading_edge) / airfoil.chord
    c, s = chord / np.hypot(*chord)
    points = points @ np.array([[c, -s], [s, c]])
    lead = int(points[:, 0].argmin())
    points = np.roll(points, -lead, axis=0)
    trail = int(points[:, 0].argmax())
    side = 0.5 * (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 121)))
    parts = []
    for part in (points[: trail + 1], np.concatenate([points[trail:], points[:1]])):
        arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(part, axis=0).T))])
        parts.append(np.stack([np.interp(side * arc[-1], arc, part[:, k]) for k in (0, 1)], axis=1)[:-1])
    both = np.concatenate(parts)
    return both * [1.0, -1.0] if turned else both


def _drawn(sections: Sequence[Airfoil], generator: np.random.Generator, number: int) -> Drawn | None:
    two = generator.integers(len(sections), size=2)
    turned = bool(generator.integers(2))
    one, other = (_outline(sections[k], turned) for k in two)
    stagger = generator.uniform(0.0, 65.0)
    ends = np.clip(stagger + generator.uniform(-30.0, 30.0, 2), 0.0, 65.0)
    staggers = np.interp(np.linspace(0.0, 1.0, _PROFILES), [0.0, 0.5, 1.0], [ends[0], stagger, ends[1]])
    staggers = np.radians(_smooth(staggers)) * (1.0 if generator.integers(2) else -1.0)
    solidity, ratio = generator.uniform(0.7, 2.0), generator.uniform(0.4, 0.9)
    taper = generator.uniform(0.85, 1.15)
    kind = ("cylindrical", "conical", "curved")[int(generator.integers(3))]
    where = int(generator.integers(3))
    gap = generator.uniform(0.0, 0.03) * (where > 0)
    slopes, bends = generator.uniform(-15.0, 15.0, 2), generator.uniform(-0.06, 0.06, 2)
    lengths = generator.uniform(0.5, 1.5, 2)
    tip, hub = 1.0, ratio
    span, middle = tip - hub, 0.5 * (tip + hub)
    chord = span / generator.uniform(0.6, 2.5)
    blades = max(3, round(2.0 * math.pi * middle * solidity / chord))
    chord = solidity * 2.0 * math.pi * middle / blades
    axial = chord * math.cos(float(np.abs(staggers).min()))
    before, behind = (-0.5 * axial - float(length) * chord for length in lengths)
    x = np.linspace(before, -behind, 61)

    def wall(radius: float, slope: float, bend: float) -> Floats:
        grown = {"cylindrical": 0.0 * x, "conical": math.tan(math.radians(slope)) * x}.get(kind)
        if grown is None:
            grown = bend * span * np.tanh(2.0 * x / chord) * 2.0
        return np.stack([x, radius + np.clip(grown, -0.25 * span, 0.25 * span)], axis=1)

    walls = [
        wall(hub, float(slopes[0]), float(bends[0])),
        wall(tip, float(slopes[1]), float(bends[1])),
    ]
    fractions = np.linspace(0.0, 1.0, _PROFILES)
    profiles = []
    for part, angle in zip(fractions, staggers, strict=True):
        size = chord * (1.0 + (taper - 1.0) * part)
        a, b = ((one + part * (other - one) - [0.5, 0.0]) * size).T
        cosine, sine = math.cos(angle), math.sin(angle)
        axial_place, across = a * cosine - b * sine, a * sine + b * cosine
        low, high = (np.interp(axial_place, x, each[:, 1]) for each in walls)
        radius = low + part * (high - low)
        theta = across / radius.mean()
        profiles.append(np.stack([axial_place, radius * np.sin(theta), radius * np.cos(theta)], axis=1))
    lowest = min(_throat(points, 2.0 * math.pi / blades) for points in profiles)
    names = "/".join(sections[k].name or "?" for k in two)
    words = (
        f"{number}: {names}{' turned' if turned else ''}, {blades} blades, stagger "
        f"{math.degrees(staggers[0]):.0f}/{math.degrees(staggers[2]):.0f}/{math.degrees(staggers[-1]):.0f}, "
        f"solidity {solidity:.2f}, ratio {ratio:.2f}, {kind}, gap {100 * gap:.1f} % "
        f"{('', 'tip', 'hub')[where]}, throat {lowest:.2f}"
    )
    if lowest < LEAST_THROAT:
        return None
    gaps = {"tip_gap": gap * span} if where == 1 else {"hub_gap": gap * span} if where == 2 else {}
    try:
        row = Row(tuple(profiles), walls[0], walls[1], blades, name=f"row{number}", **gaps)
    except MeshonetError as error:
        raise AssertionError(words) from error
    return Drawn(row, words)


def _smooth(values: Floats) -> Floats:
    """Return values along the span on the parabola through both ends and the middle."""
    t = np.linspace(0.0, 1.0, len(values))
    middle = len(values) // 2
    return np.polyval(np.polyfit(t[[0, middle, -1]], values[[0, middle, -1]], 2), t)


def _throat(points: Floats, pitch: float) -> float:
    """Return the narrowest distance of a profile from the next one over their pitch, on its mean radius."""
    radius = np.hypot(points[:, 1], points[:, 2]).mean()
    own = np.stack([points[:, 0], radius * np.arctan2(points[:, 1], points[:, 2])], axis=1)
    if _crosses(own, radius * pitch):
        return 0.0
    away = own[:, None] - (own + np.array([0.0, radius * pitch]))[None]
    return float(np.hypot(away[..., 0], away[..., 1]).min() / (radius * pitch))


def _crosses(own: Floats, pitch: float) -> bool:
    """Return whether a profile overlaps the next one: its upper side is above the next one's lower side."""
    x = np.linspace(own[:, 0].min(), own[:, 0].max(), 203)[1:-1]
    lead, trail = int(own[:, 0].argmin()), int(own[:, 0].argmax())
    order = np.roll(np.arange(len(own)), -lead)
    cut = int(np.flatnonzero(order == trail)[0])
    one, two = own[order[: cut + 1]], own[np.append(order[cut:], lead)][::-1]
    y = [np.interp(x, side[:, 0], side[:, 1]) for side in (one, two)]
    return bool((np.abs(y[0] - y[1]) >= pitch).any())
