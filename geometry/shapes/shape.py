"""Shapes as geometry files contain them, before nodes are sampled, in the plane or in three dimensions."""

from dataclasses import dataclass, replace
from typing import Protocol

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.validate import check_edges
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.sampling import Sampling


class Shape(Protocol):
    """Anything from which a boundary can be sampled: an airfoil, an outline, or a boundary itself."""

    @property
    def name(self) -> str:
        """Name of the shape in the input."""
        ...

    def boundary(self, sampling: Sampling) -> Boundary:
        """Return the four edges, with the node counts and the spacing of `sampling`."""
        ...


@dataclass(frozen=True, eq=False)
class SpatialShape:
    """A grid with three coordinates: volumes (ni, nj, nk, 3) or surface patches (ni, nj, 3)."""

    grid: Grid

    @property
    def name(self) -> str:
        """Name of the shape in the input."""
        return self.grid.name

    @property
    def is_surface(self) -> bool:
        """Whether all blocks are surface patches."""
        return all(len(block.counts) == 2 for block in self.grid.blocks)

    def boundary(self, sampling: Sampling) -> Boundary:  # noqa: ARG002 - as all shapes have it
        """Raise InputError: this shape does not have the four edges of a plane domain."""
        problem = "its nodes have three coordinates and the boundary of a plane grid is asked for"
        raise InputError(problem, "use a command that makes volumes: tfi, solve-pde or infer")


def edges_of(shape: Shape, sampling: Sampling) -> Boundary:
    """Return the boundary of `shape`, with the notes of the shape, after a check for crossing edges.

    Raises InputError: the errors of `shape`; edges that cross or touch; a body outside its far field.
    """
    if isinstance(shape, Boundary):
        check_edges(shape)  # first as given, so that messages have the user's own node numbers
    boundary = shape.boundary(sampling)
    if boundary is not shape:
        check_edges(boundary)
    notes = tuple(dict.fromkeys((*getattr(shape, "notes", ()), *boundary.notes)))
    return boundary if notes == boundary.notes else replace(boundary, notes=notes)
