"""Parts of hub and casing between an inlet and an outlet plane."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.errors import InputError

Plane: TypeAlias = float | tuple[tuple[float, float], tuple[float, float]]
"""A place along the axis, or the points x, r on hub and casing between which the plane is."""
_SAMPLES = 4001
_HALVINGS = 60
_NEAR = 0.02  # of a curve's length, from it, at which a point is on it


def trimmed(points: Floats, inlet: Plane | None, outlet: Plane | None, wall: int) -> Floats:
    """Return the part of a curve x, r (n, 2) of hub (`wall` 0) or casing (1) from inlet to outlet.

    Raises InputError: a plane that the curve does not reach; an outlet before the inlet.
    """
    if inlet is None and outlet is None:
        return points
    curve = Curve(np.ascontiguousarray(points, dtype=np.float64))
    name = ("hub", "casing")[wall]
    ends = [0.0, curve.length]
    for k, (plane, place) in enumerate(((inlet, "inlet"), (outlet, "outlet"))):
        if plane is not None:
            ends[k] = _arc(curve, plane if isinstance(plane, float) else plane[wall], place, name)
    first, last = ends
    if not first < last:
        raise InputError(f"the outlet is before the inlet at the {name}", "exchange them", place="outlet")
    inside = (curve.knots > first + 1e-9 * curve.length) & (curve.knots < last - 1e-9 * curve.length)
    arcs = np.concatenate([[first], curve.knots[inside], [last]])
    return np.asarray(curve.at(arcs))


def _arc(curve: Curve, plane: float | tuple[float, float], place: str, name: str) -> float:
    """Return the arc length at which a curve meets a place along the axis, or is nearest to a point."""
    arcs = np.linspace(0.0, curve.length, _SAMPLES)
    at = curve.at(arcs)
    if not isinstance(plane, float):
        away = norms(at - np.array(plane))
        k = int(away.argmin())
        if away[k] > _NEAR * curve.length:
            problem = f"({plane[0]:g}, {plane[1]:g}) is {away[k]:.3g} from the {name}"
            raise InputError(problem, f"give a point of the {name}", place=place)
        return float(arcs[k])
    off = at[:, 0] - plane
    across = np.flatnonzero(off[:-1] * off[1:] <= 0.0)
    if not len(across):
        low, high = at[:, 0].min(), at[:, 0].max()
        problem = f"the {name} reaches from x = {low:.6g} to {high:.6g}, not {plane:g}"
        raise InputError(problem, "use a value between, or add points to the curve", place=place)
    k = int(across[0] if place == "inlet" else across[-1])
    low_arc, high_arc = float(arcs[k]), float(arcs[k + 1])
    for _ in range(_HALVINGS):
        middle = 0.5 * (low_arc + high_arc)
        value = float(curve.at(np.array([middle]))[0, 0]) - plane
        same = value * off[k] > 0.0
        low_arc, high_arc = (middle, high_arc) if same else (low_arc, middle)
    return 0.5 * (low_arc + high_arc)
