"""The space around a lofted body: that around a similar body of revolution, displaced.

Away from the body the displacement decreases as the inverse distance from the axis.
"""

import numpy as np

from meshonet.geometry.aircraft.body import Body
from meshonet.geometry.aircraft.lofted_body import LoftedBody
from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.elementary import arctan2, cos, sin
from meshonet.solvers.aircraft.body_map import BodyMap
from meshonet.solvers.aircraft.exact_cells import at_height

_NEWTON = 16
_STEP = 1e-5  # step of finite differences in s / length, theta and zeta
_FADING = 0.6  # largest decrease of the distance from the axis, by its fading, over that distance's increase
_ABOVE = np.array([0.0, 0.0, 1e-3])  # step to the place by which the normal of a body of revolution is known
_AROUND = 33  # number of angles around a pole at which normals are computed
_POLE = 1e-4  # distance from nose or tail, in body lengths, within which normals are averaged


class LoftedMap(BodyMap):
    """The map from coordinates along, around and away from a lofted body to the space; see `BodyMap`."""

    body: LoftedBody

    def __init__(self, body: LoftedBody, far: float) -> None:
        super().__init__(body, far)
        across, up, _ = body.sizes(body.arc[1:-1])
        theta = np.linspace(0.0, np.pi, 65)
        s = np.repeat(body.arc[1:-1], len(theta))
        shape = body.shape(s, np.tile(theta, len(across))).reshape(len(across), -1)
        widest = (np.maximum(across, up)[:, None] * shape).max(axis=1)
        more = float((widest / body.meridian[1:-1, 1] - 1.0).max())
        self._fading = min(1.0, _FADING / more) if more > 0.0 else 1.0

    def points(self, places: Floats) -> Floats:
        """Return points x, y, z (..., 3) at `places` (..., 3): coordinates s, theta, zeta of `BodyMap`."""
        s, theta, zeta = np.moveaxis(places, -1, 0).reshape(3, -1)
        x, r = self.meridional(s, zeta).T
        r = np.maximum(r, 0.0)
        arcs = self.arcs(s)
        radius = np.maximum(self.body.meridional(arcs)[:, 1], 0.0)
        across, up, middle = self.body.sizes(arcs)
        shape = self.body.shape(arcs, theta)
        away, beyond = 1.0 - zeta, radius + self._fading * (r - radius)
        near = radius / np.where(beyond > 0.0, beyond, 1.0)
        y = (
            self.body.y
            + (middle - self.body.y) * (away * away)
            - (r + (up * shape - radius) * near) * cos(theta)
        )
        z = (r + (across * shape - radius) * near) * sin(theta)
        return np.stack([x, y, z], axis=-1).reshape(places.shape)

    def places(self, points: Floats, near: Floats | None = None) -> Floats:
        """Return s, theta, zeta of `BodyMap` (..., 3) at points x, y, z; `near` are first guesses."""
        wanted = points.reshape(-1, 3)
        at = (self._first_places(wanted) if near is None else near.reshape(-1, 3)).copy()
        steps = np.diag([_STEP * self.body.length, _STEP, _STEP])
        for _ in range(_NEWTON):
            by = [(self.points(at + step) - self.points(at - step)) / (2.0 * step.sum()) for step in steps]
            at = at + _solved(by, wanted - self.points(at))
            at[:, 0] = np.clip(at[:, 0], 0.0, self.body.length)
            at[:, 1:] = np.clip(at[:, 1:], 0.0, [np.pi, 1.0])
        return at.reshape(points.shape)

    def _first_places(self, points: Floats) -> Floats:
        """Return places (n, 3) near points (n, 3), from the body of revolution."""
        _, _, middle = self.body.sizes(self.body.arc_at(points[:, 0]))
        lowered = points.copy()
        lowered[:, 1] -= middle - self.body.y
        return super().places(lowered)

    def around(self, places: Floats) -> Floats:
        """Return |d(x, y, z) / d theta| (...) at `places` (..., 3), coordinates s, theta, zeta."""
        return np.asarray(norms(self._around(places)))

    def steepness(self, places: Floats) -> Floats:
        """Return angles (...), in radians, between the z axis and the direction around the body at `places`.

        `places` (..., 3) are s, theta, zeta: along, around and away from the body.
        """
        around = np.abs(self._around(places))
        return np.asarray(arctan2(around[..., 1], around[..., 2]))

    def _around(self, places: Floats) -> Floats:
        step = np.array([0.0, _STEP, 0.0])
        return (self.points(places + step) - self.points(places - step)) / (2.0 * _STEP)

    def normals(self, foot: Floats) -> Floats:
        """Return the body's unit normals (n, 3) in x, y, z, at points `foot` (n, 3): s, theta and zeta."""
        length, normals = self.body.length, self._normals(_off_poles(foot, self.body.length))
        theta = np.linspace(0.0, np.pi, _AROUND)
        for end in (0.0, length):
            ring = np.stack([np.full(_AROUND, end), theta, np.zeros(_AROUND)], axis=1)
            mean = self._normals(_off_poles(ring, length)).mean(axis=0, keepdims=True) * [1.0, 1.0, 0.0]
            normals[foot[:, 0] == end] = mean / norms(mean)
        return normals

    def _normals(self, places: Floats) -> Floats:
        ds, dt = np.diag([_STEP * self.body.length, _STEP, 0.0])[:2]
        along, around = (self.points(places + step) - self.points(places - step) for step in (ds, dt))
        normal = np.cross(along, around)
        return np.asarray(normal / norms(normal)[:, None])


def _off_poles(places: Floats, length: float) -> Floats:
    out = places.copy()
    out[:, 0] = np.clip(out[:, 0], _POLE * length, (1.0 - _POLE) * length)
    return out


def _solved(columns: list[Floats], right: Floats) -> Floats:
    """Return the solutions (n, 3) of systems with three columns (n, 3), by Cramer's rule."""
    a, b, c = columns
    det = (a * np.cross(b, c)).sum(axis=1)
    parts = [(right * np.cross(b, c)), (right * np.cross(c, a)), (right * np.cross(a, b))]
    return np.stack([part.sum(axis=1) / det for part in parts], axis=1)


def map_around(body: Body, far: float) -> BodyMap:
    """Return the map from coordinates along, around and off `body` to space, up to the distance `far`."""
    return LoftedMap(body, far) if isinstance(body, LoftedBody) else BodyMap(body, far)


def points_above(space: BodyMap, foot: Floats, first: float) -> Floats:
    """Return points x, y, z (n, 3) at the distance `first` from the body, on its normals at points `foot`.

    `foot` (n, 3) are coordinates s, theta, zeta (see `BodyMap`) of points on the body.
    """
    if isinstance(space, LoftedMap):
        return np.asarray(space.points(foot) + first * space.normals(foot))
    return space.points(at_height(space, foot, foot + _ABOVE, first))
