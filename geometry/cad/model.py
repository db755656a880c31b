"""Faces of a CAD file and the edges around them, independent of the library that reads it.

A loop is counter-clockwise as seen from outside. An edge belongs to two faces, to one at an open end, twice
to one that closes on itself; without length it is a pole.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from meshonet.geometry.arrays import Floats, extent_of
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.sampling import Sampling

Curve: TypeAlias = Callable[[Floats], Floats]  # points (n, 2 or 3) at parameters (n,) from 0 to 1


@dataclass(frozen=True, eq=False)
class CadEdge:
    """A curve between two vertices."""

    ends: tuple[int, int]  # indices of the first and the last vertex, equal for a closed curve or a pole
    points: Curve | None  # function from parameters (n,), 0 to 1, to points (n, 3); None for a pole


@dataclass(frozen=True, eq=False)
class EdgeUse:
    """An edge as a part of the loop (closed chain of edges) around a face."""

    edge: int  # index of the edge
    forward: bool  # whether the loop follows the edge's direction
    trace: Curve  # function from parameters (n,) of the edge to coordinates (n, 2) on the face


@dataclass(frozen=True, eq=False)
class CadFace:
    """A face with the loop of edges around it."""

    uses: tuple[EdgeUse, ...]  # edges of the outer loop, counter-clockwise in the coordinates on the face
    points: Callable[[Floats], Floats]  # function from these coordinates (n, 2) to points (n, 3)
    inside_out: bool  # whether the cross product of its derivatives points into the body
    holes: int  # number of other loops


@dataclass(frozen=True, eq=False)
class CadModel:
    """The vertices, edges and faces of a CAD file. `boundary` only raises an error: faces are in space."""

    vertices: Floats  # (n, 3) positions in the unit of the file
    # edges, faces: in the order of the file
    edges: tuple[CadEdge, ...]
    faces: tuple[CadFace, ...]
    name: str = ""  # name of the file
    notes: tuple[str, ...] = ()  # sentences on changes

    @property
    def size(self) -> float:
        """Greatest extent of the edges along any axis."""
        part = np.linspace(0.0, 1.0, 33)
        curves = [edge.points(part) for edge in self.edges if edge.points is not None]
        return extent_of(np.concatenate([self.vertices, *curves]))

    def boundary(self, sampling: Sampling) -> Boundary:  # noqa: ARG002 - as all shapes have it
        """Raise InputError: faces of a CAD file have no plane boundary of four sides."""
        problem = "is a CAD file, and its faces are not a boundary in the plane"
        raise InputError(problem, "make patches first: meshonet sample-boundary FILE -o surface.xyz")
