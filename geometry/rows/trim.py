"""Parts of hub and casing between inlet and outlet planes, extended straight if short."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.errors import InputError
from meshonet.geometry.notes import Change

Plane: TypeAlias = float | tuple[tuple[float, float], tuple[float, float]]
"""A position along the axis, or two points (x, r) on hub and casing through which the plane goes."""
_PLACES = "inlet", "outlet"
_SAMPLES = 4001
_HALVINGS = 60
_NEAR = 0.02  # of a curve's length, from it, at which a point is on it
_MOST_CONTINUED = 1.0  # largest continuation of a curve, in its lengths: more is a mistake in the unit
_LEAST_AXIAL = 0.5  # smallest cosine between the end of a curve and the axis for an axial continuation
_BEYOND = 1.001  # of the way to a plane, to which a curve is continued before it is cut there
_MOST_STEPS = 100
_SAME = 1e-9  # of a curve's length


@dataclass(frozen=True)
class WallPlanes:
    """The planes at the inlet and at the outlet at which hub and casing are cut."""

    # inlet, outlet: positions of the planes; None: at the ends of the curves
    inlet: Plane | None = None
    outlet: Plane | None = None
    # axis, unit: names of the axis and of the unit, for messages
    axis: str = "x"
    unit: str = "m"

    def trimmed(self, points: Floats, wall: int) -> tuple[Floats, tuple[str, ...]]:
        """Return the curve of hub (`wall` 0) or casing (1) between both planes, and notes.

        `points` (n, 2) are x and r of the curve. Raises InputError: a plane that the curve does not reach; an
        outlet before the inlet.
        """
        if self.inlet is None and self.outlet is None:
            return points, ()
        name, notes = ("hub", "shroud")[wall], []
        line = np.ascontiguousarray(points, dtype=np.float64)
        planes = [
            each if each is None or isinstance(each, float) else each[wall]
            for each in (self.inlet, self.outlet)
        ]
        for place, plane in zip(_PLACES, planes, strict=True):
            more = None if plane is None else _continuation(Curve(line), plane, place)
            if more is not None:
                length = float(norms(more[-1] - line[-1 if place == "outlet" else 0])) / _BEYOND
                notes.append(
                    Change(f"{name} is continued straight by {length:.4g} {self.unit} to the {place}")
                )
                line = np.concatenate([line, more] if place == "outlet" else [more[::-1], line])
        curve = Curve(line)
        first, last = 0.0, curve.length
        if planes[0] is not None:
            first = self._arc(curve, planes[0], "inlet", name)
        if planes[1] is not None:
            last = self._arc(curve, planes[1], "outlet", name)
        if not first < last:
            raise InputError(f"the outlet is before the inlet at the {name}", "exchange them", place="outlet")
        inside = (curve.knots > first + 1e-9 * curve.length) & (curve.knots < last - 1e-9 * curve.length)
        arcs = np.concatenate([[first], curve.knots[inside], [last]])
        return np.asarray(curve.at(arcs)), tuple(notes)

    def _arc(self, curve: Curve, plane: float | tuple[float, float], place: str, name: str) -> float:
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
            along = f"from {self.axis} = {low:.6g} to {high:.6g} {self.unit}"
            remedy = "add points to hub and shroud, or give [[x, r], [x, r]] on both, as radial planes need"
            raise InputError(f"the {name} reaches {along}, not {plane:g}", remedy, place=place)
        k = int(across[0] if place == "inlet" else across[-1])
        low_arc, high_arc = float(arcs[k]), float(arcs[k + 1])
        for _ in range(_HALVINGS):
            middle = 0.5 * (low_arc + high_arc)
            value = float(curve.at(np.array([middle]))[0, 0]) - plane
            same = value * off[k] > 0.0
            low_arc, high_arc = (middle, high_arc) if same else (low_arc, middle)
        return 0.5 * (low_arc + high_arc)


def _continuation(curve: Curve, plane: float | tuple[float, float], place: str) -> Floats | None:
    """Return points (n, 2) straight from the end of a curve to a plane, None if needless or too long."""
    last = place == "outlet"
    end = curve.points[-1 if last else 0]
    way = curve.tangent(np.array([curve.length if last else 0.0]))[0] * (1.0 if last else -1.0)
    way = way / norms(way)
    if isinstance(plane, float):
        x = curve.points[:, 0]
        if x.min() <= plane <= x.max() or abs(way[0]) < _LEAST_AXIAL:
            return None
        reach = float((plane - end[0]) / way[0])
    else:
        off = np.array(plane) - end
        reach = float((off * way).sum())
        if (
            norms(off - reach * way) > _NEAR * curve.length
            or norms(curve.points - plane).min() < reach * _NEAR
        ):
            return None
    if not _SAME * curve.length < reach <= _MOST_CONTINUED * curve.length:
        return None
    step = float(norms(end - curve.points[-2 if last else 1]))
    parts = np.linspace(0.0, _BEYOND, 1 + min(max(round(reach / step), 1), _MOST_STEPS))[1:]
    return np.asarray(end + (reach * parts)[:, None] * way)
