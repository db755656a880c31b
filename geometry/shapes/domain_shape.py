"""A domain of the plane as a shape: many blocks, or one where its sides allow that.

=============================================  =====================================================
domain                                         made by itself as
=============================================  =====================================================
four convex corners, all others kinks          one four-sided block
a hole in a smooth loop, far away              one O block
any other                                      blocks that are found
=============================================  =====================================================
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from meshonet.geometry.arrays import extent_of
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import CORNER_DEG, Loop
from meshonet.geometry.errors import InputError
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.shapes.shape import Shape
from meshonet.geometry.spacing.sampling import Sampling

FAR = 2.0
"""Distance of a hole from a smooth loop around it, in extents of the hole, from which it is a far field."""
_SAMPLES = 512  # points of each loop whose distances are looked at


@dataclass(frozen=True, eq=False)
class DomainShape:
    """A domain, and the shape that it is as a single block, if it can be one.

    Parameters
    ----------
    domain : loops and names.
    many : whether blocks are made of it unless one is asked for.
    one : makes the shape that it is as one block, in any process; None where it cannot be one.
    unit : length that Reynolds numbers are based on: the extent of its bodies, or an airfoil's chord.
    far_field : whether a far field was put around bodies.
    layout : its blocks, where the input has them.
    given : the grid of many blocks that it is the domain of, where the input is one.
    """

    domain: Domain
    many: bool = True
    one: Callable[[], Shape] | None = field(default=None, repr=False)
    unit: float = 0.0
    far_field: bool = False
    layout: Layout | None = None
    given: Grid | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        if not self.unit:
            object.__setattr__(self, "unit", loops_extent(self.domain.loops[1:] or self.domain.loops))

    @property
    def name(self) -> str:
        """What the input called it."""
        return self.domain.name

    @property
    def notes(self) -> tuple[str, ...]:
        """What a reader passed over in its file."""
        return self.domain.notes

    def noted(self, *notes: str) -> DomainShape:
        """Return it with `notes` behind its own."""
        return replace(self, domain=replace(self.domain, notes=(*self.notes, *notes)))

    def boundary(self, sampling: Sampling) -> Boundary:
        """Return the four edges of the single block that the domain is.

        Raises InputError: it is none, or what the shape of the one block raises.
        """
        if self.one is None:
            remedy = "let infer or solve-pde find its blocks"
            raise InputError(f"{described(self.domain)} is not one block", remedy)
        return self.one().boundary(sampling)


def itself(shape: Shape) -> Shape:
    """Return a shape; as a partial function, unlike a lambda, another process can have it."""
    return shape


def described(domain: Domain) -> str:
    """Return what a domain is in a few words.

    >>> described(Domain.of_polygons([np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])]))
    'a domain of 3 corners'
    """
    holes, corners = len(domain.loops) - 1, len(domain.loops[0].corners)
    if holes:
        return f"a domain with {holes} hole{'' if holes == 1 else 's'}"
    return f"a domain of {corners} corner{'' if corners == 1 else 's'}"


def loops_extent(loops: tuple[Loop, ...]) -> float:
    """Return the larger side of the box around loops."""
    points = np.concatenate([loop.curve.points for loop in loops])
    return extent_of(points)


def four_sided(domain: Domain) -> bool:
    """Say whether a domain without holes has four convex corners, and no corner that points inwards."""
    outer = domain.loops[0]
    convex = int((outer.corner_angles < 180.0 - CORNER_DEG).sum())
    return len(domain.loops) == 1 and convex == 4 and not (outer.corner_cells > 2).any()


def in_far_field(domain: Domain) -> bool:
    """Say whether a domain is a hole in a smooth loop that is `FAR` away from it."""
    if len(domain.loops) != 2 or (domain.loops[0].corner_cells != 2).any():
        return False
    every = (loop.curve.points for loop in domain.loops)
    outer, hole = (points[:: max(1, len(points) // _SAMPLES)] for points in every)
    gap = np.hypot(*np.moveaxis(outer[:, None] - hole, -1, 0)).min()
    return bool(gap >= FAR * loops_extent(domain.loops[1:]))
