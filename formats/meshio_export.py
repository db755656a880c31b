"""Unstructured meshes that meshio writes and nothing here reads: surfaces for viewers, decks for solids.

Seams are merged and cells counter-clockwise; formats of triangles get every quadrilateral cut along its
shorter diagonal. https://github.com/nschloe/meshio
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from meshonet.formats.format import Format, only_one
from meshonet.formats.mesh.unstructured import Indices, Unstructured, unstructured
from meshonet.geometry.blocks.grid import Grid


class _Kind(NamedTuple):
    """meshio's name, file ending, whether it holds triangles only, what it is."""

    name: str
    suffix: str
    triangles: bool
    told: str


_KINDS = (
    _Kind("stl", ".stl", True, "STL surface of triangles, binary"),
    _Kind("ply", ".ply", False, "PLY surface, binary"),
    _Kind("obj", ".obj", False, "Wavefront OBJ surface, text"),
    _Kind("off", ".off", True, "OFF surface of triangles, text"),
    _Kind("abaqus", ".inp", False, "Abaqus deck, text"),
    _Kind("medit", ".mesh", False, "Medit mesh, text"),
)
_OPTIONS: dict[str, dict[str, object]] = {
    "stl": {"binary": True}, "ply": {"binary": True}, "abaqus": {"float_fmt": ".16e"},
    "medit": {"float_fmt": ".16e"},
}  # fmt: skip


def _write(path: Path, grids: Iterable[Grid], kind: _Kind) -> None:
    """Write the one grid of `grids`."""
    import meshio

    mesh = unstructured(only_one(grids, f"a {kind.suffix} file"))
    points = np.column_stack([mesh.points, np.zeros(len(mesh.points))])
    cells = (
        [("triangle", _triangles(mesh).astype(np.int32))]
        if kind.triangles
        else [("quad", mesh.quads.astype(np.int32))]
    )
    writer: Callable[..., None] = getattr(meshio, kind.name).write
    writer(str(path), meshio.Mesh(points, cells), **_OPTIONS.get(kind.name, {}))


def _triangles(mesh: Unstructured) -> Indices:
    """Return two triangles (2m, 3) for each quadrilateral."""
    quads = mesh.quads
    corner = mesh.points[quads]
    one, other = (np.hypot(*(corner[:, k] - corner[:, k + 2]).T) for k in (0, 1))
    turned = np.where((one <= other)[:, None], quads, np.roll(quads, -1, axis=1))
    return np.stack([turned[:, [0, 1, 2]], turned[:, [0, 2, 3]]], axis=1).reshape(-1, 3)


FORMATS = tuple(
    Format(
        name=kind.name,
        suffixes=(kind.suffix,),
        description=kind.told,
        write_grids=partial(_write, kind=kind),
    )
    for kind in _KINDS
)
