"""Surfaces of patches to march from, made here, and what is measured of volumes."""

from collections.abc import Callable, Sequence

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.grid import Grid

Map = Callable[[Floats], Floats]


def grid_of(patches: Sequence[Floats]) -> Grid:
    return Grid(tuple(Block(patch) for patch in patches))


def cube(cells: int = 16, shape: Map = lambda points: points) -> list[Floats]:
    """Six patches of the cube from -1 to 1, i x j outwards, their points mapped by `shape`."""
    s = np.linspace(-1.0, 1.0, cells + 1)
    a, b = np.meshgrid(s, s, indexing="ij")
    patches = []
    for axis in range(3):
        for end in (-1.0, 1.0):
            points = np.empty((*a.shape, 3))
            points[..., axis] = end
            points[..., axis - 2], points[..., axis - 1] = (a, b) if end > 0 else (b, a)
            patches.append(np.ascontiguousarray(shape(points)))
    return patches


def on_sphere(points: Floats) -> Floats:
    """Points of the cube on the unit sphere, at equal angles."""
    q = np.tan(points * np.pi / 4)
    return q / np.linalg.norm(q, axis=-1, keepdims=True)


def sphere(cells: int = 16, radius: float = 1.0) -> list[Floats]:
    return cube(cells, lambda points: radius * on_sphere(points))


def half_sphere(cells: int = 16) -> list[Floats]:
    """The sphere above z = 0: five patches, the upper halves of four of them."""
    half = []
    for axis, patch in enumerate(sphere(2 * cells)):
        z = patch[..., 2]
        if axis == 4:
            continue
        if axis == 5:
            half.append(patch)
        elif abs(z[0, 0] - z[0, -1]) > 0.5:  # z runs along j
            half.append(patch[:, cells:] if z[0, -1] > 0 else patch[:, : cells + 1])
        else:
            half.append(patch[cells:] if z[-1, 0] > 0 else patch[: cells + 1])
    for patch in half:
        patch[np.abs(patch[..., 2]) < 1e-12, 2] = 0.0
    return half


def ellipsoid(cells: int = 20, ratio: float = 5.0) -> list[Floats]:
    return cube(cells, lambda points: on_sphere(points) * np.array([ratio, 1.0, 1.0]))


def star(cells: int = 20, depth: float = 0.5) -> list[Floats]:
    def shape(points: Floats) -> Floats:
        q = on_sphere(points)
        return q * (1.0 + depth * ((q**4).sum(axis=-1, keepdims=True) - 0.6) / 0.4)

    return cube(cells, shape)


def dented(cells: int = 20, depth: float = 0.25, waves: float = 4.0) -> list[Floats]:
    def shape(points: Floats) -> Floats:
        q = on_sphere(points)
        return q * (1.0 + depth * np.cos(waves * np.arccos(np.clip(q[..., 2:], -1.0, 1.0))))

    return cube(cells, shape)


def cylinder(cells: int = 16, length: float = 2.0, core: float = 0.5) -> list[Floats]:
    """A cylinder along z with sharp rims: an O patch around, and a ring of four and a core on each end."""
    angle = np.linspace(-np.pi / 4, np.pi / 4, cells + 1)
    s = np.linspace(-1.0, 1.0, cells + 1)
    around = np.concatenate([angle[:-1] + k * np.pi / 2 for k in range(4)] + [[7 * np.pi / 4]])
    z = np.linspace(-length / 2, length / 2, cells + 1)
    side = np.empty((len(around), len(z), 3))
    side[..., 0], side[..., 1], side[..., 2] = np.cos(around)[:, None], np.sin(around)[:, None], z
    side[-1] = side[0]
    patches = [side]
    rim = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    square = core * np.stack([np.ones_like(s), s], axis=-1) * (1.0 - 0.15 * s[:, None] ** 2)
    r = np.linspace(0.0, 1.0, cells // 2 + 1)[:, None, None]
    for end in (-length / 2, length / 2):
        for k in range(4):
            c, d = (1, 0, -1, 0)[k], (0, 1, 0, -1)[k]
            turn = np.array([[c, -d], [d, c]], dtype=float)
            flat = ((1.0 - r) * square + r * rim) @ turn.T
            patches.append(_at(flat, end))
        edges = [
            square @ np.array([[c, -d], [d, c]], dtype=float).T for c, d in ((1, 0), (0, 1), (-1, 0), (0, -1))
        ]
        patches.append(_at(_filled(edges[2][::-1], edges[0], edges[3], edges[1][::-1]), end))
    return patches


def _at(flat: Floats, z: float) -> Floats:
    patch = np.concatenate([flat, np.full((*flat.shape[:2], 1), z)], axis=-1)
    return np.ascontiguousarray(patch if z > 0 else patch[::-1])


def _filled(west: Floats, east: Floats, south: Floats, north: Floats) -> Floats:
    """Linear TFI of four edges (n, d)."""
    u = np.linspace(0.0, 1.0, len(south))[:, None, None]
    v = np.linspace(0.0, 1.0, len(west))[None, :, None]
    corners = (1 - u) * (1 - v) * west[0] + (1 - u) * v * west[-1] + u * (1 - v) * east[0] + u * v * east[-1]
    inner = (1 - u) * west[None] + u * east[None] + (1 - v) * south[:, None] + v * north[:, None] - corners
    inner[0], inner[-1], inner[:, 0], inner[:, -1] = west, east, south, north
    return inner


def room_corner(cells: int = 16, planes: int = 2) -> list[Floats]:
    """Two or three square walls of a room that meet in a concave corner, facing into the room."""
    s = np.linspace(0.0, 1.0, cells + 1)
    a, b = np.meshgrid(s, s, indexing="ij")
    patches = []
    for axis in range(planes):
        points = np.zeros((*a.shape, 3))
        points[..., axis - 2], points[..., axis - 1] = a, b
        patches.append(points)
    return patches


def wedge(degrees: float, cells: int = 24, rows: int = 6, ratio: float = 1.15) -> list[Floats]:
    """Two walls of length 1 that enclose an angle, cells growing by `ratio` from their common edge."""
    steps = ratio ** np.arange(cells)
    along = np.append(0.0, np.cumsum(steps / steps.sum()))
    z = np.linspace(0.0, 1.0, rows + 1)
    angle = np.deg2rad(degrees)
    walls = []
    for x, y in ((1.0, 0.0), (np.cos(angle), np.sin(angle))):
        walls.append(np.stack(np.broadcast_arrays(along[:, None] * x, along[:, None] * y, z), axis=-1))
    return [walls[0][:, ::-1].copy(), walls[1].copy()]


def boxes(cubes: set[tuple[int, int, int]], cells: int = 8) -> list[Floats]:
    """The surface of unit cubes at whole places, a patch for each free face."""
    s = np.linspace(0.0, 1.0, cells + 1)
    a, b = np.meshgrid(s, s, indexing="ij")
    patches = []
    for cube in sorted(cubes):
        for axis in range(3):
            for end in (0, 1):
                beside = list(cube)
                beside[axis] += 2 * end - 1
                if tuple(beside) in cubes:
                    continue
                points = np.empty((*a.shape, 3))
                points[..., axis] = end
                points[..., axis - 2], points[..., axis - 1] = (a, b) if end else (b, a)
                patches.append(points + np.array(cube, dtype=float))
    return patches


def plate(cells: int = 16, width: float = 1.0) -> list[Floats]:
    """A square in the plane z = 0, facing up."""
    s = np.linspace(0.0, 1.0, cells + 1)
    a, b = np.meshgrid(s, width * s, indexing="ij")
    return [np.stack([a, b, np.zeros_like(a)], axis=-1)]


def naca(
    n: int = 65, thickness: float = 0.12, camber: float = 0.02, base: float = 0.004, m: int = 4
) -> Floats:
    """A closed loop (ni, 2) of a section with a blunt edge of 2 m cells, from its middle below around."""
    x = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, n + 1 - m)))
    half = (
        5 * thickness * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
        + base * x
    )
    p = 0.4
    mean = np.where(
        x < p, camber / p**2 * (2 * p * x - x**2), camber / (1 - p) ** 2 * (1 - 2 * p + 2 * p * x - x**2)
    )
    upper, lower = np.stack([x, mean + half], axis=-1), np.stack([x, mean - half], axis=-1)
    loop = np.concatenate([lower[::-1], upper[1:]])
    edge = np.linspace(loop[-1], loop[0], 2 * m + 1)
    return np.concatenate([edge[m:-1], loop, edge[1 : m + 1]])


def wing(
    n: int = 64,
    span_nodes: int = 33,
    m: int = 4,
    rows: int = 6,
    *,
    sweep: float = 0.5,
    taper: float = 0.4,
    span: float = 2.5,
    twist: float = -4.0,
    dihedral: float = 0.1,
    section: Floats | None = None,
) -> list[Floats]:
    """A wing from z = 0 on with a ring and a core at its tip, bulged."""
    loop = naca(n, m=m) if section is None else section
    s = np.linspace(0.0, 1.0, span_nodes)
    f = (1.0 - (1.0 - s) * (1.0 - 0.75 * s))[None, :, None]
    p = (loop - [0.25, 0.0])[:, None] * (1.0 - (1.0 - taper) * f)
    angle = np.deg2rad(twist) * f[..., 0]
    z = span * f[..., 0]
    x = np.cos(angle) * p[..., 0] - np.sin(angle) * p[..., 1] + 0.25 + sweep * z
    y = np.sin(angle) * p[..., 0] + np.cos(angle) * p[..., 1] + dihedral * z
    main = np.stack([x, y, np.broadcast_to(z, x.shape)], axis=-1)
    main[-1] = main[0]
    ring, core = wing_tip(main[:, -1], m, rows)
    return [main, ring, core]


def open_wing(thick: float = 0.01, *, across: int = 4, tip: bool = True, sweep: float = 0.0) -> list[Floats]:
    """Half a wing of blunt nose from y = 0 to 2 without a base: upper and lower side, nose, tip."""
    x, y = np.linspace(0.0, 1.0, 33)[:, None], np.linspace(0.0, 2.0, 25)[None]
    half = 0.06 * np.sqrt(np.maximum(np.sin(np.pi * x), 0.0)) * (1.0 - x) + 0.5 * thick
    half[0] = max(0.02, 0.5 * thick)
    upper, lower = (np.stack(np.broadcast_arrays(x + sweep * y, y, s * half), axis=-1) for s in (1.0, -1.0))
    nose, end = between(lower[0], upper[0], across), between(lower[:, -1], upper[:, -1], across)
    return [upper, lower, nose, end] if tip else [upper, lower, nose]


def between(first: Floats, last: Floats, cells: int) -> Floats:
    """Nodes (n, cells + 1, 3) of straight lines between two lines of nodes (n, 3)."""
    f = np.linspace(0.0, 1.0, cells + 1)[None, :, None]
    return (1.0 - f) * first[:, None] + f * last[:, None]


def _at_places(places: Floats, known: Floats, values: Floats) -> Floats:
    return np.stack([np.interp(places, known, column) for column in values.T], axis=-1)


def wing_tip(tip: Floats, m: int, rows: int, inner: float = 0.5, bulge: float = 0.5) -> tuple[Floats, Floats]:
    """Ring and core on the loop `tip` (ni, 3): m nodes at each end of the core are its short sides."""
    ni = len(tip)
    n = (ni - 1) // 2
    mean, half = 0.5 * (tip + tip[::-1]), 0.5 * (tip[::-1] - tip)[: n + 1]
    chord = mean[0] - mean[n]
    u = (mean - mean[n]) @ chord / (chord @ chord)
    order = np.argsort(u[: n + 1])
    length = np.linalg.norm(chord)
    front = 1.3 * max(u[n - m], 0.35 * np.linalg.norm(tip[n - m] - tip[n + m]) / length)
    back = 1.3 * max(1 - u[m], 0.5 * np.linalg.norm(tip[m] - tip[-1 - m]) / length) + 0.01
    xi = np.clip(front + (1 - front - back) * (u - u[n - m]) / (u[m] - u[n - m]), front, 1 - back)[: n + 1]
    middle = _at_places(xi, u[: n + 1][order], mean[: n + 1][order])
    thick = inner * _at_places(xi, u[: n + 1][order], half[order])
    loop = np.concatenate([middle - thick, (middle + thick)[-2::-1]])
    a = (np.arange(2 * m + 1) / (2 * m))[:, None]
    loop[n - m : n + m + 1] = (1 - a) * loop[n - m] + a * loop[n + m]
    base = (1 - a) * loop[-1 - m] + a * loop[m]
    loop[: m + 1], loop[-m - 1 :] = base[m:], base[: m + 1]
    r = np.linspace(0.0, 1.0, rows + 1)[None, :, None]
    ring = (1 - r) * tip[:, None] + r * loop[:, None]
    core = _filled(base[::-1], loop[n - m : n + m + 1], loop[m : n - m + 1], loop[::-1][m : n - m + 1])
    height = bulge * 0.5 * np.linalg.norm(tip[::-1] - tip, axis=1).max()
    ring[..., 2] += height * (1.0 - (1.0 - r[..., 0] * (1.0 - inner)) ** 2)
    across = inner * np.abs(2 * np.linspace(0, 1, 2 * m + 1) - 1)[None]
    along = inner * np.abs(2 * np.linspace(0, 1, core.shape[0]) - 1)[:, None] ** 6
    core[..., 2] = tip[0, 2] + height * (1.0 - np.maximum(across, along) ** 2)
    for edge in (core[0], core[-1], core[:, 0], core[:, -1]):
        edge[:, 2] = tip[0, 2] + height * (1.0 - inner**2)
    ring[:, -1, 2] = tip[0, 2] + height * (1.0 - inner**2)
    ring[-1] = ring[0]
    return ring, core


def corner_quality(grid: Grid) -> float:
    """The least ratio of the smallest to the largest determinant at the eight corners of a cell."""
    least, ends = np.inf, (slice(None, -1), slice(1, None))
    for block in grid.blocks:
        u, v, w = (np.diff(block.nodes, axis=axis) for axis in range(3))
        corners = [np.cross(u[:, b, c], v[a, :, c]) * w[a, b] for a in ends for b in ends for c in ends]
        values = np.stack([corner.sum(axis=-1) for corner in corners])
        least = min(least, float((values.min(axis=0) / np.abs(values).max(axis=0)).min()))
    return least
