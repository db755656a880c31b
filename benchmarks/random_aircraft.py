"""Random bodies with a wing of real sections, and those with a fin and a tail plane too, by seed."""

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from random_rows import readable_airfoils

from meshonet.geometry.aircraft.aircraft import Aircraft
from meshonet.geometry.aircraft.body import Body
from meshonet.geometry.aircraft.fin import Fin
from meshonet.geometry.sections.section import Section
from meshonet.geometry.sections.stack import Stack
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.airfoil.naca import naca

Floats = NDArray[np.float64]
RADIUS, LENGTH, SPAN = 0.06, 1.1, 0.5
THIN, THICK = 0.1, 0.2
"""Thinnest and thickest of sections that are drawn."""


@dataclass(frozen=True, eq=False)
class DrawnAircraft:
    """A random aircraft, its first cells in chords of the wing's root, and what it was drawn with."""

    aircraft: Aircraft
    first: float
    words: str


def sections(folder: Path) -> list[Airfoil]:
    """Return the airfoils of a folder that are 10 to 20 % thick."""
    return [each for each in readable_airfoils(folder) if THIN <= _thickness(each) <= THICK]


def _thickness(airfoil: Airfoil) -> float:
    wide, thick = np.ptp(airfoil.curve.points, axis=0)
    return float(thick / wide)


def drawn_aircraft(airfoils: list[Airfoil], seed: int, count: int) -> list[DrawnAircraft]:
    """Return random aircraft.

    The wing is half a body radius below to half above the axis; its taper is 0.3 to 0.7, its sweep 0 to 30
    degrees, its dihedral 0 to 5, its twist -3 to 0; its span is 8 body radii, its chord 2.5 to 4; first cells
    are 1e-5 to 1e-3 chords.
    """
    generator = np.random.default_rng(seed)
    return [_drawn(airfoils, generator, number) for number in range(count)]


def drawn_with_fins(airfoils: list[Airfoil], seed: int, count: int) -> list[DrawnAircraft]:
    """Return the aircraft of `drawn_aircraft` with a fin, every other one with a tail plane too.

    The fin begins at 0.7 to 0.8 of the body's length; its chord is 1.5 to 2.5 body radii, its height above
    the axis 2.5 to 4.5, its sweep 0 to 50 degrees. The tail plane begins 1 radius ahead of it to 1 behind,
    0.3 radii below to 0.3 above the axis; its chord is 1.2 to 2 radii, its span 2.5 to 4.5, its sweep 0 to 40
    degrees. Both are 8 to 12 % thick, with a taper of 0.4 to 0.8.
    """
    generator = np.random.default_rng([seed, 1])
    drawn = drawn_aircraft(airfoils, seed, count)
    return [_with_fin(each, generator, tail=bool(number % 2)) for number, each in enumerate(drawn)]


def _with_fin(drawn: DrawnAircraft, generator: np.random.Generator, *, tail: bool) -> DrawnAircraft:
    x = generator.uniform(0.7, 0.8) * LENGTH
    sections, words = _trapezium(generator, x, 0.0, (1.5, 2.5), 50.0)
    others: list[Stack] = [Fin(sections, tip="flat", name="fin")]
    words = f"{drawn.words}; fin at {x:.3f}, {words}"
    if tail:
        x += generator.uniform(-1.0, 1.0) * RADIUS
        y = generator.uniform(-0.3, 0.3) * RADIUS
        sections, more = _trapezium(generator, x, y, (1.2, 2.0), 40.0)
        others.append(Stack(sections, tip="flat", name="tail"))
        words += f"; tail plane at {x:.3f}, y {y / RADIUS:+.2f} radii, {more}"
    return replace(drawn, aircraft=replace(drawn.aircraft, others=tuple(others)), words=words)


def _trapezium(
    generator: np.random.Generator, x: float, y: float, chords: tuple[float, float], most: float
) -> tuple[tuple[Section, Section], str]:
    """Return the sections of a fin or a tail plane that begins at x, y, and what it was drawn with."""
    chord, taper = generator.uniform(*chords) * RADIUS, generator.uniform(0.4, 0.8)
    span, sweep = generator.uniform(2.5, 4.5) * RADIUS, generator.uniform(0.0, most)
    shape = naca(f"00{generator.integers(8, 13):02d}")
    behind = span * math.tan(math.radians(sweep))
    sections = Section(shape, chord, 0.0, x, y), Section(shape, chord * taper, span, x + behind, y)
    words = (
        f"chord {chord / RADIUS:.2f}, span {span / RADIUS:.2f} radii, taper {taper:.2f}, sweep {sweep:.0f}"
    )
    return sections, words


def _drawn(airfoils: list[Airfoil], generator: np.random.Generator, number: int) -> DrawnAircraft:
    airfoil = airfoils[int(generator.integers(len(airfoils)))]
    chord, taper = generator.uniform(2.5, 4.0) * RADIUS, generator.uniform(0.3, 0.7)
    sweep, dihedral = generator.uniform(0.0, 30.0), generator.uniform(0.0, 5.0)
    y, x = generator.uniform(-0.5, 0.5) * RADIUS, generator.uniform(0.3, 0.45)
    twist, first = generator.uniform(-3.0, 0.0), 10.0 ** generator.uniform(-5.0, -3.0)
    behind, above = (SPAN * math.tan(math.radians(angle)) for angle in (sweep, dihedral))
    root = Section(airfoil, chord, 0.0, x, y)
    tip = Section(airfoil, chord * taper, SPAN, x + behind, y + above, twist)
    nose, tail = generator.uniform(0.15, 0.3), generator.uniform(0.25, 0.4)
    words = (
        f"{number}: {airfoil.name or '?'}, chord {chord / RADIUS:.2f} radii, taper {taper:.2f}, "
        f"sweep {sweep:.0f}, dihedral {dihedral:.1f}, y {y / RADIUS:+.2f} radii, first cell {first:.1e}"
    )
    return DrawnAircraft(Aircraft(Body(_meridian(nose, tail)), Stack((root, tip), tip="flat")), first, words)


def _meridian(nose: float, tail: float) -> Floats:
    """Return x and radius (n, 2) of a fuselage: half an ellipse, a cylinder, a slender blunt tail."""
    x = 0.5 * LENGTH * (1.0 - np.cos(np.linspace(0.0, np.pi, 400)))
    ahead = np.clip(1.0 - x / nose, 0.0, 1.0)
    behind = np.clip((x - (LENGTH - tail)) / tail, 0.0, 1.0)
    blunt = 0.35 * np.sqrt(1.0 - behind)
    closing = (1.0 - behind**4) * (1.0 - behind**1.8) + behind**4 * blunt
    radius = RADIUS * np.minimum(np.sqrt(1.0 - ahead**2), np.where(behind > 0.0, closing, 1.0))
    radius[[0, -1]] = 0.0
    return np.stack([x, radius], axis=1)
