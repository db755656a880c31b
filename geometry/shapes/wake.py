"""C boundaries: the cut behind a sharp trailing edge, and the far field around both.

South runs along the wake, clockwise around the wall, and back along the wake bitwise; west and east are the
outlet; north is a half circle around the body with straight lines beside the wake.
"""

import math

import numpy as np

from meshonet.geometry.arrays import Floats, along_and_across
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.elementary import cos, exp, expm1, product, sin
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.far_field import straight
from meshonet.geometry.spacing.growth import LARGEST, cells_for_growth, growth_rate, growth_ratio
from meshonet.geometry.spacing.sampling import first_within
from meshonet.geometry.spacing.tanh_law import TanhLaw

C_EDGE = 1.6
"""Cell at the trailing edge of a C grid: this over the nodes along xi, in chords. With smaller ones the rest
grows by more than 15 % each at 250 nodes."""
_GROWTH = 1.135  # sufficient growth ratio of wake cells, below which the wall has better use for the nodes
_SHARES = 0.2, 0.23  # smallest and largest fraction of all cells on one side of the wake, by default
_RAMP = 3.0  # cells of a wake over which growth sets in: the lines that leave its first ones converge
_LATE = 0.05  # fraction by which growth is faster at the outlet than on average, and slower at the edge
_STEEPEST = math.radians(34.0)  # largest angle at which the wake leaves the trailing edge
_RISE, _FROM, _UP_TO = 3e-4, 1.0, 200.0
BEHIND_BASE = 0.15
"""First cells at a wake are higher by a x²/((x + b)(1 + x/c)) chords at x chords behind the edge, with these
a, b and c. At its end cells are chords long: much lower ones would be skewed. Behind a base b is smaller,
since its rows of cells get higher by different factors.
"""
_LEAST_WALL = 5  # fewest nodes of a wall, with its trailing edge counted twice


def cells_of_wake(
    ni: int, nodes_wanted: int | None, first: float, length: float, steps: tuple[int, ...] = (1,)
) -> int:
    """Return the number of cells along the wake of a C grid with `ni` nodes along xi.

    If `nodes_wanted`, the number of nodes on the wake, is None, cells grow by 13.5 % from the length `first`
    and fill `length`. Their number is kept between 20 and 23 % of all cells along xi, and is a multiple of
    the first of `steps` that is at most a quarter of it, or of the last. Raises InputError: too few nodes.
    """
    if nodes_wanted is not None:
        cells = nodes_wanted - 1
    else:
        least, most = (max(2, round(share * (ni - 1))) for share in _SHARES)
        cells = min(max(cells_for_growth(first, length, _GROWTH), least), most)
        step = first_within(steps, 0.25 * cells)
        cells = max(1, (2 * cells + step - 1) // (2 * step)) * step
    if ni - 2 * cells < _LEAST_WALL:
        raise InputError(
            f"{ni} nodes along a C grid, twice {cells + 1} of them on the wake, leave too few for the wall",
            f"use at least {2 * cells + _LEAST_WALL} or fewer wake nodes",
        )
    return cells


def wake_axis(leading_edge: Floats, trailing_edge: Floats) -> Floats:
    """Return the unit vector (2,) of a far wake: along ±x, or along a chord that is steeper than 45°."""
    chord = np.asarray(trailing_edge - leading_edge)
    if abs(chord[1]) <= abs(chord[0]):
        return np.array([math.copysign(1.0, chord[0]), 0.0])
    return np.asarray(chord / np.hypot(*chord))


def wake_line(wall: Floats, axis: Floats, chord: float, length: float, first: float, cells: int) -> Floats:
    """Return the nodes (cells + 1, 2) of a wake from the sharp trailing edge of a closed `wall` (n, 2).

    With x along the `axis` and y to its left, the wake is y = tan(b) l (1 - exp(-x/l)). Here b (at most 34°)
    is the angle from the axis to the edge's bisector, and l is the chord. The first cell has the length
    `first`. The wake has the extent `length` along the axis.
    """
    upper, lower = wall[0] - wall[-2], wall[0] - wall[1]
    along = upper / np.hypot(*upper) + lower / np.hypot(*lower)
    angle = math.atan2(axis[0] * along[1] - axis[1] * along[0], product(axis, along))
    slope = math.tan(min(max(angle, -_STEEPEST), _STEEPEST))
    x = growing(first / math.hypot(1.0, slope), length, cells)
    x *= length / x[-1]
    y = -slope * chord * expm1(-x / chord)
    nodes = wall[0] + x[:, None] * axis + y[:, None] * np.array([-axis[1], axis[0]])
    nodes[0] = wall[0]
    return np.asarray(nodes)


def growing(first: float, length: float, cells: int) -> Floats:
    """Return distances (cells + 1,) of nodes along `length`, divided by the first cell's length `first`."""
    if first * cells >= length or cells < 2:
        return np.arange(cells + 1.0)
    try:
        growth_ratio(first, length, cells)
    except InputError:
        raise InputError(
            f"{cells} cells from {first:.3g} on along a wake of {length:.3g} would grow by more than "
            f"{LARGEST:g} each",
            "use more nodes, {wake_nodes} or a larger {te_spacing}",
        ) from None
    k = np.arange(1.0, cells)
    shape = np.append(0.0, np.cumsum(-expm1(-k / _RAMP) * (1.0 + _LATE * (2.0 * k / cells - 1.0))))
    g = growth_rate(shape, 1.0, length / first, math.log(length / first) / shape[-1])
    return np.concatenate([[0.0], np.cumsum(exp(g * shape))])


def rise(behind: Floats, begin: float = _FROM) -> Floats:
    """Return heights (n,) of first cells along a wake, minus the height at the trailing edge, in chords.

    `behind` (n,) are distances from the trailing edge in chords. Most of the increase is beyond `begin`.
    """
    return np.asarray(_RISE * behind**2 / ((behind + begin) * (1.0 + behind / _UP_TO)))


def c_boundary(
    wall: Floats,
    nj: int,
    wake: Floats,
    centre: Floats,
    radius: float,
    *,
    axis: Floats,
    curve: Curve | None = None,
    name: str = "",
    chord: float = 0.0,
    notes: tuple[str, ...] = (),
) -> Boundary:
    """Return the C boundary of a closed `wall` (n, 2) and a `wake` (m, 2) from trailing edge to outlet.

    The wall runs clockwise from its sharp trailing edge. The wake ends in the direction of the unit vector
    `axis` (2,). The far field in front is a half circle with `centre` and `radius`. `curve`, `name`, `chord`
    and `notes` are fields of `Boundary`. Raises InputError: the wake leaves the far field or hits the wall.
    """
    south = np.concatenate([wake[:0:-1], wall[:-1], wake])
    north = c_far_field(len(wall) - 1, len(wake) - 1, centre, radius, axis, wake[-1])
    west, east = straight(south[0], north[0], nj), straight(south[-1], north[-1], nj)
    return Boundary(south, north, west, east, "c", name=name, wall=curve, chord=chord, notes=notes)


def c_far_field(body: int, wake: int, centre: Floats, radius: float, axis: Floats, outlet: Floats) -> Floats:
    """Return far-field nodes (body + 2 wake + 1, 2) for a wake that ends at `outlet` (2,).

    `body` and `wake` are numbers of cells. Raises InputError: the outlet is outside the far field.
    """
    behind, beside = map(float, along_and_across(outlet - centre, axis))
    if behind <= 0 or abs(beside) >= radius:
        raise InputError("the wake does not reach the outlet inside the far field", "use a larger far field")
    normal = np.array([-axis[1], axis[0]])
    angle = np.linspace(-0.5 * np.pi, -1.5 * np.pi, body + 1)
    front = centre + radius * (cos(angle)[:, None] * axis + sin(angle)[:, None] * normal)
    front[[0, -1]] = centre - radius * normal, centre + radius * normal
    step = min(np.pi * radius / body, 0.9 * behind)
    mean = behind / wake
    s = np.linspace(0.0, 1.0, wake + 1)
    if wake > 1:
        s = TanhLaw(min(max(step / mean, 0.05), 20.0), max(2.0 - step / mean, 0.2))(s)
    side = behind * s[1:, None] * axis
    return np.concatenate([front[0] + side[::-1], front, front[-1] + side])
