"""The content of a file in three dimensions, before a method makes a volume grid of it."""

from __future__ import annotations

from dataclasses import dataclass

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.sampling import Sampling


@dataclass(frozen=True, eq=False)
class SpatialShape:
    """A grid whose nodes have three coordinates: blocks (ni, nj, nk, 3), or surface patches (ni, nj, 3).

    Marching takes patches as its wall. Other methods fill the volume that six patches, or the outer faces of
    a block, enclose; several blocks are smoothed across their connections.
    """

    grid: Grid

    @property
    def name(self) -> str:
        """Name of the shape in the input."""
        return self.grid.name

    @property
    def is_surface(self) -> bool:
        """Whether all its blocks are surface patches."""
        return all(len(block.counts) == 2 for block in self.grid.blocks)

    def boundary(self, sampling: Sampling) -> Boundary:  # noqa: ARG002 - as all shapes have it
        """Raise InputError: a three-dimensional shape has no four edges."""
        problem = "its nodes have three coordinates and the boundary of a plane grid is asked for"
        raise InputError(problem, "use a command that makes volumes: tfi, solve-pde or infer")


def in_space(grid: Grid) -> bool:
    """Return whether the nodes of a grid have three coordinates."""
    return grid.form != "plane"
