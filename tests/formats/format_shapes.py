"""Small grids with known answers, one of each topology, with names of their own."""

import io
import sys
from pathlib import Path

import numpy as np

from meshonet.formats.source import Source
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch


def channel(ni: int = 7, nj: int = 5, name: str = "channel Ω") -> Grid:
    """A right-handed quad whose numbers need all 17 digits."""
    s, t = np.meshgrid(np.linspace(0, 1, ni), np.linspace(0, 1, nj), indexing="ij")
    nodes = np.stack([2 * s + 0.1 * t, t * (1 + 0.3 * np.sin(3 * s)) + 1e-7 * np.cos(s)], axis=-1)
    parts = (
        Patch("inlet", "west", 0, nj - 1),
        Patch("no-slip wall", "south", 0, 3),
        Patch("out let", "east", 0, nj - 1),
    )
    return Grid.from_nodes(nodes, "quad", parts, name, {"method": "formula", "seed": 3, "seconds": 0.25})


def ring(ni: int = 13, nj: int = 5, name: str = "ring") -> Grid:
    """An O grid around the unit circle to radius 4, clockwise from the positive x axis."""
    angle = -np.linspace(0, 2 * np.pi, ni)
    radius = np.geomspace(1, 4, nj)
    nodes = np.stack([np.cos(angle)[:, None] * radius, np.sin(angle)[:, None] * radius], axis=-1)
    nodes[-1] = nodes[0]
    parts = (Patch("airfoil", "south", 0, ni - 1), Patch("far", "north", 0, ni - 1))
    return Grid.from_nodes(nodes, "o", parts, name)


def c_grid(wake: int = 4, body: int = 9, nj: int = 4, name: str = "c") -> Grid:
    """A C grid: `wake` nodes downstream of a plate of `body` nodes around its nose."""
    angle = -np.linspace(0, 2 * np.pi, body)
    plate = np.stack([0.5 + 0.5 * np.cos(angle), 0.1 * np.sin(angle)], axis=1)
    tail = np.stack([np.linspace(3, 1, wake), np.zeros(wake)], axis=1)
    plate[0] = plate[-1] = tail[-1]
    south = np.concatenate([tail, plate[1:-1], tail[::-1]])
    ni = len(south)
    swing = np.linspace(-np.pi / 2, -3 * np.pi / 2, ni - 2 * wake + 2)
    arc = 0.5 + 3 * np.stack([np.cos(swing), np.sin(swing)], axis=1) - (0, 0.5)
    low = np.stack([np.linspace(3, 0.5, wake), np.full(wake, -3.0)], axis=1)
    high = np.stack([np.linspace(0.5, 3, wake), np.full(wake, 3.0)], axis=1)
    north = np.concatenate([low[:-1], arc, high[1:]])
    t = np.linspace(0, 1, nj)[:, None, None]
    nodes = np.moveaxis((1 - t) * south + t * north, 0, 1)
    parts = (  # otherwise called than those that a C grid has by default
        Patch("wake", "south", 0, wake - 1),
        Patch("plate", "south", wake - 1, ni - wake),
        Patch("wake", "south", ni - wake, ni - 1),
        Patch("far side", "north", 0, ni - 1),
        Patch("far side", "east", 0, nj - 1),
        Patch("far side", "west", 0, nj - 1),
    )
    return Grid.from_nodes(nodes, "c", parts, name)


def memory(data: bytes, name: str = "made") -> Source:
    """Return `data` as a source."""
    return Source(name, data=data)


class Pipe:
    """A standard stream over bytes: set `sys.stdin` or `sys.stdout` to it."""

    def __init__(self, data: bytes = b"") -> None:
        self.buffer = io.BytesIO(data)


def file_names(folder: Path) -> list[str]:
    """Return the names of everything in `folder`, hidden files included."""
    return sorted(entry.name for entry in folder.iterdir())


VARIANTS = ("vtk:ascii", "plot3d:binary", "plot3d:fortran", "gmsh:ascii", "gmsh:4.1", "gmsh:4.1,ascii")
"""Formats with options whose bytes have nothing in common with those without."""

PYTHON = sys.executable
