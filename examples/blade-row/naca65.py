"""Sections of the NACA 65 series for compressor blades: ``python naca65.py LIFT > section.dat``.

LIFT is the design lift coefficient of an isolated airfoil, 10 times which is in the name: 65-(12)10 has 1.2.
Half thicknesses of the NACA 65-010 and the mean line of uniform load, a = 1, are those of Abbott and von
Doenhoff, Theory of Wing Sections (1959).
"""

import math
import sys

THICKNESS = (
    (0.0, 0.0), (0.5, 0.772), (0.75, 0.932), (1.25, 1.169), (2.5, 1.574), (5.0, 2.177), (7.5, 2.647),
    (10.0, 3.040), (15.0, 3.666), (20.0, 4.143), (25.0, 4.503), (30.0, 4.760), (35.0, 4.924), (40.0, 4.996),
    (45.0, 4.963), (50.0, 4.812), (55.0, 4.530), (60.0, 4.146), (65.0, 3.682), (70.0, 3.156), (75.0, 2.584),
    (80.0, 1.987), (85.0, 1.385), (90.0, 0.810), (95.0, 0.306), (100.0, 0.0),
)  # fmt: skip
"""Distance from the leading edge and half thickness, in percent of the chord."""


def camber(x: float, lift: float) -> tuple[float, float]:
    """Return height and slope of the mean line; at the edges the slope is that at 0.5 % of the chord."""
    inside = min(max(x, 0.005), 0.995)
    slope = lift / (4.0 * math.pi) * (math.log(1.0 - inside) - math.log(inside))
    if not 0.0 < x < 1.0:
        return 0.0, slope
    return -lift / (4.0 * math.pi) * ((1.0 - x) * math.log(1.0 - x) + x * math.log(x)), slope


def points(lift: float) -> list[tuple[float, float]]:
    """Return points from the trailing edge over the upper side to the leading edge and back."""
    sides: list[list[tuple[float, float]]] = []
    for sign in (1.0, -1.0):
        side = []
        for x, half in ((0.01 * a, sign * 0.01 * b) for a, b in THICKNESS):
            height, slope = camber(x, lift)
            long = math.hypot(1.0, slope)
            side.append((x - half * slope / long, height + half / long))
        sides.append(side)
    return [*sides[0][::-1], *sides[1][1:]]


if __name__ == "__main__":
    lift = float(sys.argv[1])
    print(f"NACA 65-({10 * lift:g})10, a = 1.0")
    print("\n".join(f"{x:.6f} {y:.6f}" for x, y in points(lift)))
