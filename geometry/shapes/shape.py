"""What a geometry file contains before nodes are sampled on it."""

from dataclasses import replace
from typing import Protocol

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.validate import check_edges
from meshonet.geometry.spacing.sampling import Sampling


class Shape(Protocol):
    """Anything that can be sampled into a boundary: an airfoil, an outline, a boundary itself."""

    @property
    def name(self) -> str:
        """Name of the shape in the input."""
        ...

    def boundary(self, sampling: Sampling) -> Boundary:
        """Return the four edges with the node counts and spacing of `sampling`."""
        ...


def edges_of(shape: Shape, sampling: Sampling) -> Boundary:
    """Return the boundary of `shape`, checked before any grid is made, with the notes of both.

    Raises InputError: the errors of `shape`; edges that cross or touch; a body outside its far field.
    """
    if isinstance(shape, Boundary):
        check_edges(shape)  # first as given, so that messages have the user's own node numbers
    boundary = shape.boundary(sampling)
    if boundary is not shape:
        check_edges(boundary)
    notes = tuple(dict.fromkeys((*getattr(shape, "notes", ()), *boundary.notes)))
    return boundary if notes == boundary.notes else replace(boundary, notes=notes)
