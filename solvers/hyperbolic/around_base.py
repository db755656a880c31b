"""C grids around a blunt base: a C block marched from section and wake, and an H block behind the base.

The south of the H block is the lower wake line, its north the upper one, its west the base.
"""

import math

import numpy as np

from meshonet.geometry.arrays import Floats, norms, planar_nodes
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.elementary import exp
from meshonet.geometry.notes import Advice
from meshonet.geometry.quality.bad_cell import centre_of
from meshonet.geometry.quality.checkmesh import faces
from meshonet.geometry.quality.growth import ratios
from meshonet.geometry.shapes.airfoil.base_wake import GROWTH, BaseWake, end_fractions
from meshonet.geometry.shapes.far_field import straight
from meshonet.geometry.shapes.wake import BEHIND_BASE, rise
from meshonet.geometry.threads import threads_for
from meshonet.kernels._native import redistribute
from meshonet.solvers.hyperbolic.front import Front, opening
from meshonet.solvers.hyperbolic.march import MarchLayers, check_layers, marched
from meshonet.solvers.layers.limited import limit_growth
from meshonet.solvers.solution import Solution, timed

_FULL = 0.95  # largest height of the H block's first cells far behind the base, in its mean cells
_SAME = 0.99  # least height of cells behind a base, in first cells, without advice
_THIN = 0.04  # first cell over the width of a base with which lines from its corners are straight
_SEVERE, _OBLIQUE = 70.0, 80.0  # non-orthogonality in degrees: limit of checkMesh, and largest without advice
_FADE = 1.0  # widths of the base over which the correction of first cells off it fades out


@timed
def around_base(
    lines: BaseWake, *, first: float, growth: float | None, free_rows: bool, constant: int, multiple: int = 1
) -> Solution:
    """Return the grid around a body with a blunt base: a C block, and an H block behind the base.

    `lines` run along the body and its wake. `first` is the first-cell height in their unit. Other parameters
    and InputError are as in `hyperbolic`. Raises SolverError if the march diverges.
    """
    check_layers(first / lines.chord, growth)
    ends, between = _h_block(lines, first, growth)
    wake = len(lines.lower) - 1
    south = np.concatenate([lines.lower[:0:-1], lines.wall[:-1], lines.upper])
    west, east = (straight(south[k], lines.north[k], lines.nj) for k in (0, -1))
    boundary = Boundary(south, lines.north, west, east, "quad", name=lines.name, chord=lines.chord)
    front = Front(boundary, first, wake, ends / first, concave=lines.turned)
    nodes = marched(front, lines.nj - 1, MarchLayers(first, growth, free_rows, constant, multiple))
    grid = _joined(nodes, between, wake, lines.name, first)
    around = nodes[wake : len(nodes) - wake]
    heights = norms(np.concatenate([around[:, 1] - lines.wall, between[1] - between[0]]))
    off = float(np.abs(heights / first - 1.0).max())
    note = f"first cells at wall and base are {first:.6g} high, with relative errors of at most {off:.1g}"
    base = f"the base has {len(lines.base)} nodes, the H block behind it {wake + 1} x {len(lines.base)}"
    advice = *_thick(lines, first, ends), *_oblique(grid, wake)
    if growth is None:
        advice = *advice, *_growing(around, between)
    return Solution(grid, "hyperbolic", notes=(*lines.notes, note, base, *advice))


def _thick(lines: BaseWake, first: float, ends: Floats) -> tuple[str, ...]:
    """Return advice if cells behind the base are thinner than `first` on the wall."""
    if ends[1] >= _SAME * first:
        return ()
    width = float(norms(lines.base[-1] - lines.base[0]))
    problem = f"first cells of {first:.3g} are too thick for a base {width:.3g} wide"
    remedy = f"use {{first_cell}} {_THIN * width / lines.chord:.1g} or less, or {{te}} wedge"
    return (Advice(f"{problem}: lines bend at its corners; {remedy}"),)


def _growing(around: Floats, between: Floats) -> tuple[str, ...]:
    """Return advice if cells along lines from wall or base grow by more than `GROWTH`."""
    most = max(float(ratios(around.swapaxes(0, 1)).max()), float(ratios(between).max()))
    if most <= GROWTH * (1.0 + 1e-6):
        return ()
    problem = f"cells along lines from the wall and its base grow by up to {most:.3f}"
    return (Advice(f"{problem}; {{growth}} {GROWTH:g} limits that by as many rows as it needs"),)


def _oblique(grid: Grid, wake: int) -> tuple[str, ...]:
    """Return advice if faces are very oblique to the lines between the centres of their cells."""
    worst = faces(grid).non_orthogonality
    if worst is None or worst.max <= _OBLIQUE:
        return ()
    x, y = centre_of(grid, worst.at)
    ni, nj = grid.blocks[0].counts
    # with half as long cells, centres are a quarter as far beside each other
    more = math.sqrt(math.tan(math.radians(min(worst.max, 89.9))) / math.tan(math.radians(_SEVERE)))
    remedy = f"{{wake_nodes}} {math.ceil(more * wake) + 1}"
    if worst.at[0] == 0 and wake <= worst.at[1] < ni - 1 - wake:
        remedy = f"{{res}} {2 * wake + math.ceil(more * (ni - 1 - 2 * wake)) + 1}x{nj}"
    problem = f"cells at ({x:.4g}, {y:.4g}) are too long: non-orthogonality as in checkMesh is"
    return (Advice(f"{problem} {worst.max:.1f} degrees; {remedy} makes it about {_SEVERE:g}"),)


def _h_block(lines: BaseWake, first: float, growth: float | None) -> tuple[Floats, Floats]:
    """Return the steps (k,) at both wake lines, and nodes (k, m, 2) between them with this growth."""
    ways = lines.upper - lines.lower
    width, cells = norms(ways), len(lines.base) - 1
    behind = norms(lines.lower - lines.lower[0])
    away = behind / lines.chord
    higher = rise(away, BEHIND_BASE) / (first / lines.chord)
    ends = np.minimum(first * opening(away, higher), _FULL * width / cells)
    ends[0] = float(norms(lines.base[1] - lines.base[0]))
    t = end_fractions(ends / width, cells)[..., None]
    nodes = planar_nodes(len(lines.lower), cells + 1)
    nodes[...] = lines.lower[:, None] + t * ways[:, None]
    nodes[:, 0], nodes[:, -1], nodes[0] = lines.lower, lines.upper, lines.base
    inner = nodes[:, 1:-1]
    x, y = (np.ascontiguousarray(inner[..., axis].T) for axis in (0, 1))
    fade = exp(-np.maximum(behind - behind[1], 0.0) / (_FADE * width[0]))
    redistribute(x, y, np.full(len(x), first), fade, threads_for(x.size))
    inner[..., 0], inner[..., 1] = x.T, y.T
    nodes[-1, 1:-1] = (lines.lower[-1] + t[-1] * ways[-1])[1:-1]
    if growth:
        limit_growth(inner.swapaxes(0, 1), growth, 1)
    return ends, nodes


def _joined(nodes: Floats, between: Floats, wake: int, name: str, first: float) -> Grid:
    ni, nj = nodes.shape[:2]
    cells, across = len(between) - 1, between.shape[1] - 1
    whole = ((0, cells),)
    connections = (
        Connection(0, "south", ((0, wake),), 1, "south", whole, (-1,)),
        Connection(0, "south", ((ni - 1 - wake, ni - 1),), 1, "north", whole, (1,)),
    )
    patches = (
        Patch("wall", "south", wake, ni - 1 - wake),
        Patch("farfield", "north", 0, ni - 1),
        Patch("farfield", "east", 0, nj - 1),
        Patch("farfield", "west", 0, nj - 1),
        Patch("wall", "west", 0, across, block=1),
        Patch("farfield", "east", 0, across, block=1),
    )
    facts = {"method": "hyperbolic", "wall_spacing": first}
    return Grid((Block(nodes), Block(between)), patches, connections, name, facts)
