"""Smooth cross fields aligned with the walls of a domain; grid lines of blocks follow their directions.

A cross with the angle theta is the complex number u = exp(4 i theta), equal for all four directions.
"""

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats, Indices
from meshonet.geometry.elementary import angle, exp, modulus
from meshonet.geometry.errors import SolverError
from meshonet.solvers.blocking.decomposition.field.singular_pairs import without_pairs
from meshonet.solvers.blocking.decomposition.field.wall_directions import (
    QUARTER,
    WallDirections,
    wall_directions,
)
from meshonet.solvers.blocking.decomposition.surface.laplacian import Laplacian, solve_complex
from meshonet.solvers.blocking.decomposition.surface.surface import NEXT, PREVIOUS, Triangulation

_STEPS, _AFTER = 6, 3
"""Diffusion steps, and steps after pairs are removed; mean scores with 1, 6, 12 steps: 7.60, 7.17, 7.02."""
_DIFFUSION = 0.003
"""Time of a diffusion step over the domain's area; a tenth gives 22 domains 467 blocks, not 431."""


@dataclass(frozen=True, eq=False)
class CrossField:
    """Four directions at right angles (a cross) at vertices of a surface, and how many cells meet there."""

    surface: Triangulation
    walls: WallDirections
    crosses: Complexes  # (n,) exp(4 i theta) at vertices
    shears: Complexes  # (n,) linear maps z - nu conj(z), |nu| < 1, that turn acute corners into right angles
    angles: Floats  # (t,) theta in each triangle for one of the four directions, which defines the frame
    quarters: Indices
    """(t, 3) number of quarter turns from the frame of a triangle to the frame across each edge."""
    wall_axis: Indices
    """(w,) quarter turns from the frame to each wall edge, in the order of `Triangulation.walls`."""
    valence: Indices  # (n,) number of cells that meet at interior vertices, 0 at wall vertices
    boundary_cells: Indices  # (n,) number of cells that meet at wall vertices, 0 at interior ones

    @property
    def singular(self) -> Indices:
        """Indices of the interior vertices at which more or fewer than four cells meet, ascending."""
        return np.flatnonzero((self.valence != 4) & (self.valence > 0))


def cross_field(surface: Triangulation, fewer: bool = True) -> CrossField:
    """Return a smooth cross field that is aligned with the walls of a surface.

    A harmonic field is smoothed by steps of normalisation and diffusion, which separate its singularities
    (Viertel, Osting, SIAM J. Sci. Comput. 41 (2019) A452-A479). If `fewer` is true, pairs of singularities
    that cancel each other are then removed where this costs little energy.

    Raises SolverError if the singularities do not fit the topology of the surface.
    """
    walls = wall_directions(surface)
    crosses, shears = _smooth(surface, walls, fewer)
    angles = angle(crosses[surface.triangles].sum(axis=1)) / 4.0
    inner = surface.neighbours >= 0
    lag = (angles[:, None] - angles[surface.neighbours]) / QUARTER
    quarters = np.where(inner, np.round(lag), 0.0).astype(np.intp)
    triangle, _ = surface.walls
    wall_axis = np.round((walls.edges - angles[triangle]) / QUARTER).astype(np.intp)
    valence, boundary_cells = _around_vertices(surface, walls, quarters, wall_axis)
    field = CrossField(surface, walls, crosses, shears, angles, quarters, wall_axis, valence, boundary_cells)
    _check_sum(field)
    return field


def _smooth(surface: Triangulation, walls: WallDirections, fewer: bool) -> tuple[Complexes, Complexes]:
    """Return the crosses (n,), unit numbers, and the harmonic shears."""
    crosses = np.where(surface.on_wall, exp(4j * walls.vertices), 0.0)
    free = ~surface.on_wall
    if not free.any():
        return crosses, walls.shears
    laplacian = Laplacian(surface, free)
    flow, factor = laplacian.flow(crosses), laplacian.factor()
    shears = walls.shears.copy()
    shears[free] = solve_complex(factor, laplacian.flow(shears))
    inside = solve_complex(factor, flow)
    lag = surface.masses[free] / (_DIFFUSION * float(surface.areas.sum()))
    step = laplacian.factor(lag)
    for _ in range(_STEPS):
        inside = solve_complex(step, lag * _unit(inside) + flow)
    crosses[free] = _unit(inside)
    changed = without_pairs(surface, laplacian, factor, crosses) if fewer else crosses
    if changed is not crosses:
        inside = changed[free]
        for _ in range(_AFTER):
            inside = solve_complex(step, lag * _unit(inside) + flow)
        crosses[free] = _unit(inside)
    return crosses, shears


def _unit(z: Complexes) -> Complexes:
    return np.asarray(z / np.maximum(modulus(z), 1e-12))


def _around_vertices(
    surface: Triangulation, walls: WallDirections, quarters: Indices, wall_axis: Indices
) -> tuple[Indices, Indices]:
    """Return the cells (n,) that meet at inner and at wall vertices."""
    # counter-clockwise around a vertex, one leaves a triangle across the edge that arrives at the vertex
    turned = np.round(surface.gather(quarters[:, PREVIOUS].astype(np.float64))).astype(np.intp)
    valence = np.where(surface.on_wall, 0, 4 - turned)
    triangle, edge = surface.walls
    leaving, arriving = surface.triangles[triangle, edge], surface.triangles[triangle, NEXT[edge]]
    own, between = walls.edges - walls.offsets, walls.inside.copy()
    between[leaving] += own
    between[arriving] -= own
    boundary = np.round(between / QUARTER).astype(np.intp) - turned  # up to multiples of four quarters
    boundary[leaving] -= wall_axis
    boundary[arriving] += wall_axis
    return valence, np.where(surface.on_wall, boundary, 0)


def _check_sum(field: CrossField) -> None:
    """Raise SolverError unless the theorem of Poincare and Hopf holds."""
    inner = int((4 - field.valence[field.valence > 0]).sum())
    wall = int((2 - field.boundary_cells[field.surface.on_wall]).sum())
    if inner + wall != 4 * field.surface.euler:
        problem = f"singularities of the cross field sum up to {inner + wall} quarters"
        raise SolverError(f"{problem}, not {4 * field.surface.euler}")
