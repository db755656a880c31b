"""The space around a body of revolution: the planes through its axis, mapped conformally from a strip.

::

       .-- zeta = 1 --.        s      0 at the nose, the body's length at the tail: the angle of a line in the
      (    zeta = 0    )              far field, in this unit; lines leave the body at right angles
     ( nose (____) tail )      theta  angle about the axis, from the keel
    s = 0            s = L     zeta   0 on the body, 1 in the far field
"""

import math
from dataclasses import replace

import numpy as np

from meshonet.geometry.aircraft.body import Body
from meshonet.geometry.arrays import Floats, cross2
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.curves.cubic import CubicTable
from meshonet.geometry.curves.monotone import monotone_cubic
from meshonet.geometry.elementary import arctan2, cos, sin
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.outline import Outline
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.kernels._native import lattice_values, nearest_points
from meshonet.solvers.conformal.solve import solve

_LINES, _LEVELS = 513, 97  # numbers of nodes of the table along s and zeta
_AROUND = 385  # number of nodes around the closed meridian of the conformal grid
_NEWTON = 12
_STEP = 1e-5  # step of finite differences in s / length and in zeta
_COARSE = 8  # stride of the lines and levels of the table that are searched for the first guess of a place


class BodyMap:
    """The map from (s, theta, zeta) to the space around a `body`, up to the distance `far`.

    s is 0 at the nose and the body's length at the tail. theta is 0 at the keel (bottom) and pi at the crown
    (top). zeta is 0 on the body and 1 in the far field.
    """

    def __init__(self, body: Body, far: float) -> None:
        self.body = body
        upper = body.meridian
        lower = upper[-2:0:-1] * [1.0, -1.0]
        outline = Outline(np.concatenate([upper, lower]))
        length = float(np.ptp(upper[:, 0]))
        table = _upper_half(solve([_boundary(outline, far / length)])[0].grid.nodes, body)
        outer = table[:, -1] - [0.5 * float(table[0, -1, 0] + table[-1, -1, 0]), 0.0]
        turns = body.length * (1.0 - arctan2(outer[:, 1], outer[:, 0]) / math.pi)
        turns[0], turns[-1] = 0.0, body.length
        even = np.linspace(0.0, body.length, _LINES)
        self.table = CubicTable(table, turns)(even)
        self._arcs = monotone_cubic(turns, body.arcs_near(table[:, 0]), even)[:, None, None]

    def points(self, places: Floats) -> Floats:
        """Return points x, y, z (..., 3) at `places` (..., 3), coordinates s, theta, zeta (see `BodyMap`)."""
        s, theta, zeta = np.moveaxis(places, -1, 0)
        x, r = np.moveaxis(self.meridional(s.ravel(), zeta.ravel()).reshape(*s.shape, 2), -1, 0)
        r = np.maximum(r, 0.0)
        return np.stack([x, self.body.y - r * cos(theta), r * sin(theta)], axis=-1)

    def meridional(self, s: Floats, zeta: Floats) -> Floats:
        """Return x and the distance from the axis (n, 2) at s (n,) along the body and zeta (n,) off it."""
        along, across = s * ((_LINES - 1) / self.body.length), zeta * (_LEVELS - 1)
        at_body = self.body.meridional(self.arcs(s)) - _between(self.table[:, :4], along, np.zeros_like(s))
        away = 1.0 - zeta
        return _between(self.table, along, across) + at_body * (away * away)[:, None]

    def arcs(self, s: Floats) -> Floats:
        """Return arc lengths (n,) along the body from the nose to places with the mapped coordinate `s`."""
        along = s * ((_LINES - 1) / self.body.length)
        return np.clip(_between(self._arcs, along, np.zeros_like(s))[:, 0], 0.0, self.body.length)

    def around(self, places: Floats) -> Floats:
        """Return distances (...) from the body's axis; `places` (..., 3) are s, theta, zeta of `BodyMap`."""
        points = self.points(places)
        return np.hypot(points[..., 1] - self.body.y, points[..., 2])

    def steepness(self, places: Floats) -> Floats:
        """Return angles (...), in radians, between the z axis and the direction around the body at `places`.

        `places` (..., 3) are s, theta, zeta: along, around and away from the body.
        """
        return np.minimum(places[..., 1], np.pi - places[..., 1])

    def places(self, points: Floats, near: Floats | None = None) -> Floats:
        """Return the coordinates s, theta, zeta of `BodyMap` (..., 3) for `points` x, y, z (..., 3).

        Newton's method starts from coordinates `near` (..., 3), by default from those of tabulated nodes.
        """
        y, z = points[..., 1] - self.body.y, points[..., 2]
        theta = arctan2(z, -y)
        wanted = np.stack([points[..., 0], np.hypot(y, z)], axis=-1).reshape(-1, 2)
        s, zeta = self._nearest(wanted) if near is None else near.reshape(-1, 3)[:, [0, 2]].T
        for _ in range(_NEWTON):
            here = self.meridional(s, zeta)
            ds, dz = _STEP * self.body.length, _STEP
            by_s = (self.meridional(s + ds, zeta) - self.meridional(s - ds, zeta)) / (2.0 * ds)
            by_zeta = (self.meridional(s, zeta + dz) - self.meridional(s, zeta - dz)) / (2.0 * dz)
            off = wanted - here
            det = cross2(by_s, by_zeta)
            s = np.clip(s + cross2(off, by_zeta) / det, 0.0, self.body.length)
            zeta = np.clip(zeta + cross2(by_s, off) / det, 0.0, 1.0)
        return np.stack([s, theta.ravel(), zeta], axis=-1).reshape(points.shape)

    def _nearest(self, points: Floats) -> tuple[Floats, Floats]:
        """Return s and zeta (n,) of the nearest nodes of the coarse table to points (n, 2)."""
        coarse = self.table[::_COARSE, ::_COARSE]
        nearest = nearest_points(points, np.ascontiguousarray(coarse.reshape(-1, 2)))[0]
        s, zeta = np.divmod(nearest, coarse.shape[1])
        return s * _COARSE / (_LINES - 1) * self.body.length, zeta * _COARSE / (_LEVELS - 1)


def _boundary(outline: Outline, far: float) -> Boundary:
    """Return the boundary around a meridian, with nodes where lines leave at right angles if possible."""
    sampling = Sampling(_AROUND, _LEVELS, topology="o", spacing="conformal", far_field=far)
    try:
        return outline.boundary(sampling)
    except InputError:
        return outline.boundary(replace(sampling, spacing="auto"))


def _upper_half(nodes: Floats, body: Body) -> Floats:
    """Return the lines (n, levels, 2) with r >= 0 of a grid around a closed meridian, from nose to tail."""
    half = (len(nodes) - 1) // 2
    mirrored = 0.5 * (nodes + nodes[::-1] * [1.0, -1.0])
    nose = int(mirrored[: half + 1, 0, 0].argmin())
    if nose == half:
        upper = mirrored[half:] if mirrored[half + half // 2, 0, 1] > 0.0 else mirrored[half::-1]
    else:
        upper = mirrored[: half + 1] if mirrored[half // 2, 0, 1] > 0.0 else mirrored[: half - 1 : -1]
    upper = upper.copy()
    upper[[0, -1], :, 1] = 0.0
    upper[0, 0, 0], upper[-1, 0, 0] = body.meridian[[0, -1], 0]
    return upper


def _between(table: Floats, u: Floats, v: Floats) -> Floats:
    """Return values (p, k) of a table (n, m, k) between its nodes, at u, v (p,) in its steps."""
    out = np.empty((len(u), table.shape[2]))
    table, u, v = (np.ascontiguousarray(each) for each in (table, u, v))
    lattice_values(table, u, v, out)
    return out
