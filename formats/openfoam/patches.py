"""The patches of an OpenFOAM case: names, types, and the transformations of cyclic patches."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from meshonet.formats.mesh.names import kinds, words
from meshonet.formats.mesh.periodic import NamedFaces, PeriodicPair
from meshonet.formats.openfoam.files import head
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.blocks.patches import Kind
from meshonet.geometry.blocks.screw import screw_of

PLANES = ""  # key, different from all names, of the two planes of a grid one cell thick
EMPTY = "frontAndBack"  # name of the patch of these planes, whose type is ``empty``
_TYPES: dict[Kind, str] = {"wall": "wall", "symmetry": "symmetry", "wedge": "wedge"}
"""OpenFOAM's types of patches; other kinds are ``patch``."""

_FLAT = 1e-15  # largest squared difference of unit normals in a symmetry plane (symmetryPlanePolyPatch.C)


class CasePatch(NamedTuple):
    """A patch with `size` faces and the type `kind`; `more` are further entries of its dictionary."""

    name: str
    kind: str
    size: int
    more: tuple[str, ...] = ()


def with_empty_planes(grid: Grid, parts: Mapping[str, NamedFaces]) -> dict[str, NamedFaces]:
    """Return the boundary `parts`; bottom and top of a planar grid become one part, `PLANES`, at the end.

    A volume counts as planar if all its blocks are one cell thick between symmetry planes.
    """
    outer = grid.outer_patches()
    ends = {patch.name for patch in outer if patch.side in ("bottom", "top")}
    flat = (
        all(block.counts[2] == 2 for block in grid.blocks)
        and all((patch.side in ("bottom", "top")) == (patch.name in ends) for patch in outer)
        and all(patch.kind == "symmetry" for patch in outer if patch.name in ends)
        and not any(each.side in ("bottom", "top") for each in grid.connections)
    )
    if not flat:
        return dict(parts)
    planes = [parts[name] for name in parts if name in ends]
    rest = {name: part for name, part in parts.items() if name not in ends}
    return {**rest, PLANES: NamedFaces(*map(np.concatenate, zip(*planes, strict=True)))}


def patches_of(
    grid: Grid, parts: Mapping[str, NamedFaces], pairs: Sequence[PeriodicPair], points: Floats,
    periodic: str = "cyclic",
) -> list[CasePatch]:  # fmt: skip
    """Return the patch of each boundary part, with its type and additional entries.

    `periodic` is the type of periodic patches: ``cyclic``, or ``cyclicAMI``, which interpolates.
    """
    kind = kinds(grid, grid.outer_patches())
    word = words((name for name in parts if name != PLANES), taken=[EMPTY], letter=True)
    patches = {PLANES: CasePatch(EMPTY, "empty", 0)}
    for name, title in word.items():
        type_ = _TYPES.get(kind.get(name, "other"), "patch")
        if type_ == "symmetry" and _is_flat(points[parts[name].faces]):
            type_ = "symmetryPlane"
        patches[name] = CasePatch(title, type_, 0)
    for pair in pairs:
        ends = (pair.name, pair.partner, pair.motion), (pair.partner, pair.name, pair.motion.inverse())
        for name, partner, motion in ends:
            more = f"neighbourPatch  {word[partner]};", *_transform(motion)
            patches[name] = CasePatch(word[name], periodic, 0, more)
    return [patches[name]._replace(size=len(part.cells)) for name, part in parts.items()]


def write_boundary(path: Path, patches: Sequence[CasePatch], start: int) -> None:
    """Write the file ``boundary`` with all patches; the faces of the first one start at number `start`."""
    text = f"{head('polyBoundaryMesh', 'boundary')}{len(patches)}\n(\n"
    for patch in patches:
        entries = "".join(f"        {entry}\n" for entry in patch.more)
        text += f"    {patch.name}\n    {{\n        type            {patch.kind};\n{entries}"
        text += f"        nFaces          {patch.size};\n        startFace       {start};\n    }}\n"
        start += patch.size
    path.write_text(f"{text})\n", encoding="ascii")


def _is_flat(corners: Floats) -> bool:
    """Return whether all faces (k, 4, 3) have the same normal."""
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    length = np.sqrt((normal**2).sum(axis=1))
    unit = normal / np.where(length > 0, length, 1.0)[:, None]
    return bool(((unit - unit[0]) ** 2).sum(axis=1).max() <= _FLAT)


def _transform(motion: Motion) -> tuple[str, ...]:
    """Return the entries that transform the faces of a cyclic patch to those of its neighbour."""
    screw = screw_of(motion)
    if screw.angle:
        axis = "transform       rotational;", f"rotationAxis    {_vector(screw.axis)};"
        return *axis, f"rotationCentre  {_vector(screw.centre)};"
    return "transform       translational;", f"separationVector {_vector(screw.shift)};"


def _vector(values: Floats) -> str:
    return "(" + " ".join(f"{value + 0.0:.17g}" for value in values) + ")"
