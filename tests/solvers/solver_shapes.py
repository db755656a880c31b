"""Boundaries that the solver tests share: plain, kinked, re-entrant, periodic."""

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary


def segment(a: tuple[float, float], b: tuple[float, float], n: int) -> Floats:
    """Straight edge of n nodes."""
    t = np.linspace(0, 1, n)[:, None]
    return (1 - t) * np.array(a, float) + t * np.array(b, float)


def polyline(points: list[tuple[float, float]], n: int) -> Floats:
    """n nodes along a polyline by length, every vertex a node."""
    corners = np.array(points, float)
    s = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(corners, axis=0).T))])
    at = np.rint(s / s[-1] * (n - 1))
    k = np.arange(n)
    return np.stack([np.interp(k, at, corners[:, 0]), np.interp(k, at, corners[:, 1])], axis=1)


def quad(south: Floats, north: Floats, west: Floats, east: Floats, name: str = "") -> Boundary:
    """Four edges whose corners are those of south and north."""
    west, east = west.copy(), east.copy()
    west[0], west[-1], east[0], east[-1] = south[0], north[0], south[-1], north[-1]
    return Boundary(south, north, west, east, "quad", name=name)


def ring(south: Floats, north: Floats, nj: int, name: str = "") -> Boundary:
    """Two closed clockwise edges and a straight cut."""
    south, north = south.copy(), north.copy()
    south[-1], north[-1] = south[0], north[0]
    cut = segment(tuple(south[0]), tuple(north[0]), nj)
    cut[0], cut[-1] = south[0], north[0]
    return Boundary(south, north, cut, cut.copy(), "o", name=name)


def circle(radius: float, n: int, centre: tuple[float, float] = (0.0, 0.0)) -> Floats:
    """n nodes clockwise from the positive x axis."""
    angle = -np.linspace(0, 2 * np.pi, n)
    return np.stack([centre[0] + radius * np.cos(angle), centre[1] + radius * np.sin(angle)], axis=1)


def arch(ni: int, nj: int) -> Boundary:
    """Unit square with a sine roof."""
    t = np.linspace(0, 1, ni)
    north = np.stack([t, 1 + 0.5 * np.sin(np.pi * t)], axis=1)
    return quad(
        segment((0, 0), (1, 0), ni), north, segment((0, 0), (0, 1), nj), segment((1, 0), (1, 1), nj), "arch"
    )


def hexagon(ni: int, nj: int) -> Boundary:
    """Unit square whose floor and roof kink outwards."""
    south, north = polyline([(0, 0), (0.5, -0.5), (1, 0)], ni), polyline([(0, 1), (0.5, 1.5), (1, 1)], ni)
    return quad(south, north, segment((0, 0), (0, 1), nj), segment((1, 0), (1, 1), nj), "hexagon")


def bump(ni: int, nj: int) -> Boundary:
    """Unit square with a half circle of radius 0.2 on the floor; its two kinks are nodes."""
    flat = round((ni - 1) * 0.3 / (0.6 + 0.2 * np.pi))
    angle = np.linspace(np.pi, 0, ni - 2 * flat)
    half_circle = np.stack([0.5 + 0.2 * np.cos(angle), 0.2 * np.sin(angle)], axis=1)
    floor = [segment((0, 0), (0.3, 0), flat + 1)[:-1], half_circle, segment((0.7, 0), (1, 0), flat + 1)[1:]]
    sides = segment((0, 0), (0, 1), nj), segment((1, 0), (1, 1), nj)
    return quad(np.concatenate(floor), segment((0, 1), (1, 1), ni), *sides, "bump")


def wrench(ni: int, nj: int) -> Boundary:
    """Unit square with a notch in the roof: two re-entrant corners of 270 degrees."""
    roof = [(0, 1), (0.3, 1.15), (0.35, 1.0), (0.35, 0.6), (0.65, 0.6), (0.65, 1.0), (0.7, 1.15), (1, 1)]
    sides = segment((0, 0), (0, 1), nj), segment((1, 0), (1, 1), nj)
    return quad(segment((0, 0), (1, 0), ni), polyline(roof, ni), *sides, "wrench")


def l_shape(ni: int, nj: int) -> Boundary:
    """L-shaped duct around one re-entrant corner."""
    south, north = polyline([(0, 2), (0, 0), (2, 0)], ni), polyline([(1, 2), (1, 1), (2, 1)], ni)
    return quad(south, north, segment((0, 2), (1, 2), nj), segment((2, 0), (2, 1), nj), "L")


def horseshoe(ni: int, nj: int, ratio: float = 4.0) -> Boundary:
    """Half an elliptic ring, opened downwards."""
    t = np.pi * (1 - np.linspace(0, 1, ni))
    inner = np.stack([np.cos(t), ratio * np.sin(t)], axis=1)
    outer = np.stack([2.2 * np.cos(t), (ratio + 1.5) * np.sin(t)], axis=1)
    return quad(
        inner,
        outer,
        segment(tuple(inner[0]), tuple(outer[0]), nj),
        segment(tuple(inner[-1]), tuple(outer[-1]), nj),
    )


def spike(ni: int, nj: int, width: float = 0.04) -> Boundary:
    """Unit square with a thin spike rising from the floor."""
    floor = [(0, 0), (0.5 - width / 2, 0), (0.5, 0.6), (0.5 + width / 2, 0), (1, 0)]
    sides = segment((0, 0), (0, 1), nj), segment((1, 0), (1, 1), nj)
    return quad(polyline(floor, ni), segment((0, 1), (1, 1), ni), *sides, "spike")


def seamount(ni: int = 99, nj: int = 38) -> Boundary:
    """Ocean section over a Gaussian seamount: x in -1..1, depth 1 - a exp(-b x²) with a = .5, b = 8."""
    x = np.linspace(-1, 1, ni)
    south = np.stack([x, 0.5 * np.exp(-8 * x**2)], axis=1)
    north = np.stack([x, np.ones(ni)], axis=1)
    return quad(
        south, north, segment(tuple(south[0]), (-1, 1), nj), segment(tuple(south[-1]), (1, 1), nj), "seamount"
    )


def naca(ni: int, nj: int, thickness: float = 0.12, far: float = 15.0) -> Boundary:
    """Symmetric NACA section with a sharp trailing edge in a round far field."""
    angle = np.linspace(0, 2 * np.pi, ni)
    x = 0.5 * (1 + np.cos(angle))
    half = 5 * thickness * np.polyval(
        [-0.1036, 0.2843, -0.3516, -0.1260, 0], x
    ) + 5 * thickness * 0.2969 * np.sqrt(x)
    south = np.stack([x, np.where(angle <= np.pi, -half, half)], axis=1)
    return ring(south, circle(far, ni, (0.5, 0.0)), nj, "naca")


def hole(ni: int, nj: int) -> Boundary:
    """Round hole in a square plate."""
    plate = polyline([(1, 0), (1, -1), (-1, -1), (-1, 1), (1, 1), (1, 0)], ni)
    return ring(circle(0.35, ni), plate, nj, "hole")


def folded(nodes: Floats) -> int:
    """Count cells with a corner Jacobian that is not positive, by plain numpy."""
    return int((corner_jacobians(nodes).min(axis=0) <= 0).sum())


def meets(nodes: Floats, boundary: Boundary) -> bool:
    """Whether the rim is that of the boundary, bit for bit; the cut of an O grid need only close."""
    given = [(nodes[:, 0], boundary.south), (nodes[:, -1], boundary.north)]
    if boundary.topology == "o":
        given += [(nodes[0], nodes[-1])]
    else:
        given += [(nodes[0], boundary.west), (nodes[-1], boundary.east)]
    return all(np.array_equal(side, wanted) for side, wanted in given)


def corner_jacobians(nodes: Floats) -> Floats:
    """(4, ni-1, nj-1) Jacobians at the cells' corners."""
    a, b, c, d = nodes[:-1, :-1], nodes[1:, :-1], nodes[1:, 1:], nodes[:-1, 1:]
    return np.stack([_cross(b - a, d - a), _cross(b - a, c - b), _cross(c - d, c - b), _cross(c - d, d - a)])


def _cross(u: Floats, v: Floats) -> Floats:
    return u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
