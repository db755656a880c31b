"""NACA four- and five-digit airfoils from their formulas (docs/reference/shapes.md).

Jacobs, Ward and Pinkerton, NACA Report 460 (1933); Jacobs and Pinkerton, NACA Report 537 (1935); reflexed
mean lines as in Ladson and Brooks, NASA TM X-3284 (1975).
"""

import re
from typing import Any

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import arctan, cos, sin
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil

POINTS = 161  # default points per surface: their spline is within 2e-6 chords of the formula
THICK = 40  # thickness in percent of the chord from which on a note mentions it; the reports have 6 to 25

_SIMPLE = {
    1: (0.0580, 361.400), 2: (0.1260, 51.640), 3: (0.2025, 15.957), 4: (0.2900, 6.643), 5: (0.3910, 3.230),
}  # fmt: skip
_REFLEX = {
    2: (0.1300, 51.990, 0.000764), 3: (0.2170, 15.793, 0.00677),
    4: (0.3180, 6.520, 0.0303), 5: (0.4410, 3.191, 0.1355),
}  # fmt: skip
_KNOWN = "use four digits such as 2412 or five such as 23012, with -sharp for a closed trailing edge"


def naca(designation: str) -> Airfoil:
    """Return the airfoil, with chord 1, of a designation such as ``2412``, ``23012`` or ``0012-sharp``.

    Raises InputError: an unknown designation.

    >>> naca("2412").name, naca("0012").blunt, naca("0012-sharp").blunt
    ('NACA 2412', True, False)
    """
    digits = _split(designation)[0]
    percent = int(digits[-2:])
    notes = (f"NACA {digits} is {percent} % thick, as its last two digits say",) if percent > THICK else ()
    return Airfoil(naca_points(designation), f"NACA {digits}", notes=notes)


def naca_points(designation: str, n: int = POINTS) -> Floats:
    """Return points (2 n - 1, 2), cosine-spaced in x, from the trailing edge over the top and back below."""
    digits, sharp = _split(designation)
    x = 0.5 - 0.5 * cos(np.linspace(0.0, np.pi, n))
    half = thickness(x, int(digits[-2:]) / 100, sharp=sharp)
    camber, slope = _mean_line(digits, x)
    angle = arctan(slope)
    upper = np.stack([x - half * sin(angle), camber + half * cos(angle)], axis=1)
    lower = np.stack([x + half * sin(angle), camber - half * cos(angle)], axis=1)
    return np.concatenate([upper[::-1], lower[1:]])


def thickness(x: Floats, ratio: float, *, sharp: bool = False) -> Floats:
    """Return the half thickness in chords, at `x` (any shape, 0 to 1), of a NACA section.

    With t = `ratio`, it is 5 t (0.2969 √x - 0.1260 x - 0.3516 x² + 0.2843 x³ - 0.1015 x⁴). If `sharp`, 0.1036
    replaces 0.1015.
    """
    last = -0.1036 if sharp else -0.1015
    inner = 0.2969 * np.sqrt(x) + x * (-0.1260 + x * (-0.3516 + x * (0.2843 + x * last)))
    inner = np.where((x == 1.0) & sharp, 0.0, inner)
    return np.asarray(5.0 * ratio * inner)


def _split(designation: str) -> tuple[str, bool]:
    match = re.fullmatch(r"(?:naca)?[\s_-]*(\d{4,5})(-sharp)?", designation.strip().lower())
    if match is None:
        raise InputError(f"{designation!r} is no NACA designation", _KNOWN)
    digits = match[1]
    if int(digits[-2:]) == 0:
        raise InputError(f"NACA {digits} has no thickness", _KNOWN)
    if len(digits) == 4 and digits[0] != "0" and digits[1] == "0":
        remedy = "use 1 to 9 as the second digit"
        raise InputError(f"NACA {digits} has its camber at the leading edge", remedy)
    if len(digits) == 5:
        if digits[0] == "0":
            raise InputError(f"NACA {digits} has no design lift", "use 1 to 9 as the first of five digits")
        known = {"0": set(_SIMPLE), "1": set(_REFLEX)}.get(digits[2], set())
        if int(digits[1]) not in known:
            remedy = "use 10 to 50 or 21 to 51 as its second and third digit"
            raise InputError(f"NACA {digits} has no tabulated mean line", remedy)
    return digits, match[2] is not None


def _mean_line(digits: str, x: Floats) -> tuple[Floats, Floats]:
    if len(digits) == 4:
        m, p = int(digits[0]) / 100, int(digits[1]) / 10
        if m == 0:
            return np.zeros_like(x), np.zeros_like(x)
        scale = np.where(x < p, m / p**2, m / (1 - p) ** 2)
        return scale * (np.where(x < p, 0.0, 1 - 2 * p) + 2 * p * x - x * x), scale * 2 * (p - x)
    design_lift, place = int(digits[0]) / 2, int(digits[1])
    if digits[2] == "0":
        r, k = _SIMPLE[place]
        k *= design_lift / 6
        front = x < r
        camber = k * np.where(front, _cube(x) - 3 * r * x**2 + r**2 * (3 - r) * x, _cube(r) * (1 - x))
        return camber, k * np.where(front, 3 * x**2 - 6 * r * x + r**2 * (3 - r), -_cube(r))
    r, k, ratio = _REFLEX[place]
    k *= design_lift / 6
    scale = np.where(x < r, 1.0, ratio)
    constant = -ratio * _cube(1 - r) - _cube(r)
    return k * (scale * _cube(x - r) + constant * x + _cube(r)), k * (3 * scale * (x - r) ** 2 + constant)


def _cube(x: Any) -> Any:
    return x * x * x
