"""Faces of a CAD file and the curves that bound them, independent of the library that reads the file.

::

      vertex 3 <--- edge 2 ---- vertex 2      A face has one loop of edges, counter-clockwise as seen from
         |                         ^          outside. An edge belongs to two faces, to one at an open end,
      edge 3        face        edge 1        or twice to one that closes on itself (a cylinder). An edge
         v                         |          without length is a pole, as at the end of a sphere.
      vertex 0 ---- edge 0 ---> vertex 1
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from meshonet.geometry.arrays import Floats, extent_of
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.sampling import Sampling

Curve: TypeAlias = Callable[[Floats], Floats]
"""Points (n, 2 or 3) at parameters (n,) from 0 to 1."""


@dataclass(frozen=True, eq=False)
class CadEdge:
    """A curve between two vertices.

    Parameters
    ----------
    ends : indices of the first and the last vertex; they are equal for a closed curve or a pole.
    points : function from parameters (n,), 0 to 1, to points (n, 3) of the curve; None for a pole.
    """

    ends: tuple[int, int]
    points: Curve | None


@dataclass(frozen=True, eq=False)
class EdgeUse:
    """An edge in the loop of a face.

    Parameters
    ----------
    edge : index of the edge.
    forward : whether the loop goes along the edge from the edge's first vertex to its last.
    trace : function from parameters (n,) of the edge to coordinates (n, 2) on the face.
    """

    edge: int
    forward: bool
    trace: Curve


@dataclass(frozen=True, eq=False)
class CadFace:
    """A face with the loop around it.

    Parameters
    ----------
    uses : edges of the outer loop, in order, counter-clockwise in the coordinates on the face.
    points : function from coordinates (n, 2) on the face to points (n, 3) of the surface.
    inside_out : whether the normal (cross product of the derivatives with respect to the two coordinates)
        points into the body.
    holes : number of loops besides the outer one.
    """

    uses: tuple[EdgeUse, ...]
    points: Callable[[Floats], Floats]
    inside_out: bool
    holes: int


@dataclass(frozen=True, eq=False)
class CadModel:
    """All faces of a CAD file; a `meshonet.geometry.shapes.shape.Shape` that has no four edges.

    Parameters
    ----------
    vertices : (n, 3) positions of the vertices, in the unit of the file.
    edges, faces : edges and faces in the order of the file.
    name : name of the file.
    notes : sentences on what was changed when the file was read.
    """

    vertices: Floats
    edges: tuple[CadEdge, ...]
    faces: tuple[CadFace, ...]
    name: str = ""
    notes: tuple[str, ...] = ()

    @property
    def size(self) -> float:
        """Longest extent of the edges along an axis."""
        part = np.linspace(0.0, 1.0, 33)
        curves = [edge.points(part) for edge in self.edges if edge.points is not None]
        return extent_of(np.concatenate([self.vertices, *curves]))

    def boundary(self, sampling: Sampling) -> Boundary:  # noqa: ARG002 - as all shapes have it
        """Raise InputError: the faces of a CAD file do not have the four edges of a plane domain."""
        problem = "is a CAD file, and its faces are not a boundary in the plane"
        raise InputError(problem, "make patches first: meshonet sample-boundary FILE -o surface.xyz")
