"""Settings of a march from a surface, and the smoothing parameters that are tried in turn."""

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.growth import cells_for_growth, growing_steps

GROWTH = 1.2  # default growth ratio of cells along a line, if the number of layers is not given either
FAR_FIELD = 15.0  # default distance of the far field, in lengths of the surface
_LONGER = 1.1  # lines than the far field is away, as a rule
FEWEST = 3  # layers of nodes: two cells


@dataclass(frozen=True)
class VolumeMarch:
    """Settings of a march from a surface; lengths are in the unit of the surface."""

    first_cell: float  # height of the cells at the wall
    layers: int | None = None  # nodes along each line, with the wall node; None: as `growth` requires
    far_field: float | None = None  # distance of the far field; None: 15 extents of the surface
    # axis normal to planes of symmetry; ``none``: all open edges are free. None: planes with open edges that
    # have the surface on one side
    symmetry: Literal["x", "y", "z", "none"] | None = None
    growth: float | None = None  # largest growth ratio along a line; None: 1.2, or as `layers` require

    def __post_init__(self) -> None:
        for name in ("first_cell", "far_field"):
            value = getattr(self, name)
            if value is not None and not 0.0 < value < math.inf:
                raise InputError(f"{value:g} is no length", "give a positive one", parameter=name)
        if self.layers is not None and self.layers < FEWEST:
            raise InputError(f"{self.layers} is too few", f"give {FEWEST} or more", parameter="layers")
        if self.growth is not None and not 1.0 <= self.growth < math.inf:
            raise InputError(f"{self.growth:g} is no growth", "give e.g. 1.2", parameter="growth")
        if self.symmetry not in (None, "x", "y", "z", "none"):
            raise InputError(f"{self.symmetry!r} is no axis", "use x, y, z or none", parameter="symmetry")

    @property
    def limit(self) -> float:
        """Largest growth ratio; infinite if growth follows from `layers`."""
        return math.inf if self.layers is not None and self.growth is None else self.growth or GROWTH

    def distance(self, size: float) -> float:
        """Return the distance of the far field for a surface of extent `size`."""
        return FAR_FIELD * size if self.far_field is None else self.far_field

    def steps(self, size: float) -> Floats:
        """Return the distances between successive layers of nodes, for a surface of extent `size`.

        Raises InputError if layers are too few for the growth ratio, or reach beyond the far field.
        """
        far = self.distance(size)
        if far < 2.0 * self.first_cell:
            problem = f"the far field at {far:.4g} is nearer than two first cells of {self.first_cell:.4g}"
            raise InputError(problem, "give a larger {far_field} or a smaller {first_cell}")
        needed = 1 + max(cells_for_growth(self.first_cell, _LONGER * far, self.growth or GROWTH), FEWEST - 1)
        if self.layers is not None and self.growth is not None and self.layers < needed:
            away = f"{self.layers} layers from {self.first_cell:.4g} to {far:.4g}"
            problem = f"{away} grow by more than {self.growth:g}"
            raise InputError(problem, f"give {needed} {{layers}} or a larger {{growth}}")
        cells = (needed if self.layers is None else self.layers) - 1
        if cells * self.first_cell > far:
            problem = (
                f"{cells + 1} layers of {self.first_cell:.4g} or more reach beyond the far field at {far:.4g}"
            )
            raise InputError(problem, f"give at most {int(far / self.first_cell) + 1} {{layers}}")
        return np.asarray(growing_steps(self.first_cell, far, cells))


class Smoothing(NamedTuple):
    """Parameters of the smoothing while marching; ``kernels/surfaces/march.h`` describes most of them.

    `outer` is the explicit smoothing far from the wall, divided by the smoothing near it. If `outer` is at
    most 6, layers of nodes around a sphere stay spheres. The value 16 makes better cells behind swept wings.
    """

    explicit: float = 0.3
    implicit: float = 1.2
    theta: float = 0.5
    outer: float = 1.0
    sharp: float = -0.5
    longest: float = 3.0
    weight: float = 0.25
    blend: float = 5e-4
    sweeps: int = 10
    ramp: int = 10
    tolerance: float = 1e-3
    most: int = 150
    relaxing: float = 0.0
    settled: float = 0.25
    near: float = 2.0
    relaxations: int = 30
    splay: float = 0.0
    """Relative excess distance of ghost nodes at free edges (`meshonet.solvers.hyperbolic.volume.graph`)."""
    boost: float = 3.0  # additional smoothing at irregular nodes, as a fraction of the smoothing elsewhere

    def numbers(self, size: float) -> tuple[float, ...]:
        """Return the parameters as the kernels take them; `size` is half the extent of the surface."""
        return (*self[:5], size, *self[5:16])


ATTEMPTS = (
    Smoothing(),
    Smoothing(explicit=1.0, implicit=2.0, theta=1.0),
    Smoothing(explicit=1.0, implicit=2.0, theta=1.0, sweeps=60),
    Smoothing(explicit=1.0, implicit=2.0, theta=0.0, longest=0.5, sweeps=60),
    Smoothing(explicit=2.0, implicit=4.0, theta=0.0, longest=0.5, sweeps=60),
)
"""Smoothing parameters tried in turn while cells are folded, on surfaces without concave edges."""
WING_ATTEMPTS = tuple(
    one._replace(outer=outer) for one, outer in zip(ATTEMPTS, (6.0, 2.0, 2.0, 2.0, 1.0), strict=True)
)
"""Parameters for wings: levels are smoothed more far away, where lines behind a swept wing converge."""

_RELAXED = Smoothing(explicit=1.0, implicit=2.0, theta=0.0, longest=1.0, blend=0.1, relaxing=3.0)
CONCAVE_ATTEMPTS = (
    _RELAXED,
    _RELAXED._replace(near=4.0),
    _RELAXED._replace(near=4.0, explicit=0.3, implicit=1.2),
    _RELAXED._replace(near=4.0, longest=0.5),
    *ATTEMPTS[2:],
)
"""Parameters for surfaces with concave edges: levels are relaxed (``kernels/surfaces/relax.c``)."""


def attempts_for(*, concave: bool, wing: bool) -> tuple[Smoothing, ...]:
    """Return parameters to be tried in turn on a surface, which may have `concave` edges or be a `wing`."""
    return CONCAVE_ATTEMPTS if concave else WING_ATTEMPTS if wing else ATTEMPTS
