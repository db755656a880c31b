"""A planar domain as a shape of several blocks, or of one (docs/guide/kinds-of-domains.md)."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from meshonet.geometry.arrays import extent_of
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop, turns_sharply
from meshonet.geometry.errors import InputError
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.shapes.shape import Shape
from meshonet.geometry.spacing.sampling import Sampling

FAR = 2.0  # smallest distance of a smooth loop around a hole from it, in extents of the hole, for a far field
_SAMPLES = 512  # points of each loop for which distances are computed


@dataclass(frozen=True, eq=False)
class DomainShape:
    """A domain as a shape that becomes several blocks, or a single block if that is possible.

    Parameters
    ----------
    domain : loops and their names.
    many : whether the domain becomes several blocks unless a single block is requested.
    one : picklable function that returns the shape as a single block; None if there is none.
    unit : reference length of Reynolds numbers: the extent of bodies, or the chord of an airfoil.
    far_field : whether a far field was added around bodies.
    layout : blocks of the domain, if the input contains them.
    assembled : whether the domain was assembled from several shapes.
    grid : the multi-block grid of the input, if the input is a grid.
    """

    domain: Domain
    many: bool = True
    one: Callable[[], Shape] | None = field(default=None, repr=False)
    unit: float = 0.0
    far_field: bool = False
    layout: Layout | None = None
    assembled: bool = False
    grid: Grid | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        if not self.unit:
            object.__setattr__(self, "unit", loops_extent(self.domain.loops[1:] or self.domain.loops))

    @property
    def name(self) -> str:
        """Name of the shape in the input."""
        return self.domain.name

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes on parts of the file that were left out."""
        return self.domain.notes

    def noted(self, *notes: str) -> Self:
        """Return the shape with additional `notes`."""
        return replace(self, domain=replace(self.domain, notes=(*self.notes, *notes)))

    def boundary(self, sampling: Sampling) -> Boundary:
        """Return the four edges of the domain's single block. Raises InputError if it needs several."""
        if self.domain.periodic:
            remedy = "make many blocks of it with infer or solve-pde"
            raise InputError("a domain with periodic sides is not one block", remedy)
        if self.one is None:
            remedy = "let infer or solve-pde find its blocks"
            raise InputError(f"{described(self.domain)} is not one block", remedy)
        boundary = self.one().boundary(sampling)
        if not (self.many and boundary.around_body and len(self.domain.loops) == 1):
            return boundary
        note = "the grid surrounds the closed curve; {topology} quad, or several blocks, fill it"
        return replace(boundary, notes=(*boundary.notes, note))


def itself(shape: Shape) -> Shape:
    """Return `shape`; a `partial` of this function can be pickled, a lambda cannot."""
    return shape


def described(domain: Domain) -> str:
    """Return a short description of a domain.

    >>> described(Domain.of_polygons([np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])]))
    'a domain of 3 corners'
    """
    holes, corners = len(domain.loops) - 1, len(domain.loops[0].corners)
    if holes:
        return f"a domain with {holes} hole{'' if holes == 1 else 's'}"
    return f"a domain of {corners} corner{'' if corners == 1 else 's'}"


def loops_extent(loops: tuple[Loop, ...]) -> float:
    """Return the larger side of the bounding box of loops."""
    points = np.concatenate([loop.curve.points for loop in loops])
    return extent_of(points)


def four_sided(domain: Domain) -> bool:
    """Return whether a domain has no holes, exactly four convex corners and no re-entrant corner."""
    outer = domain.loops[0]
    return len(domain.loops) == 1 and len(convex_corners(outer)) == 4 and not (outer.corner_cells > 2).any()


def convex_corners(loop: Loop) -> list[int]:
    """Return the indices of those points of a loop that are convex corners."""
    turn = np.radians(180.0 - loop.corner_angles)
    convex = turns_sharply(turn) & (turn > 0.0)
    return [point for point, is_convex in zip(loop.corners, convex, strict=True) if is_convex]


def in_far_field(domain: Domain) -> bool:
    """Return whether a domain has a single hole, and a smooth outer loop that is far away from it."""
    if len(domain.loops) != 2 or (domain.loops[0].corner_cells != 2).any():
        return False
    every = (loop.curve.points for loop in domain.loops)
    outer, hole = (points[:: max(1, len(points) // _SAMPLES)] for points in every)
    gap = np.hypot(*np.moveaxis(outer[:, None] - hole, -1, 0)).min()
    return bool(gap >= FAR * loops_extent(domain.loops[1:]))
