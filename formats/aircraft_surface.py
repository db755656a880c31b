"""Bodies and wings of aircraft that are patches of a surface file, such as Plot3D or CGNS."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from meshonet.formats.registry import read_grids
from meshonet.formats.source import printable
from meshonet.formats.toml_table import Table
from meshonet.geometry.aircraft.axes import FLAT, AircraftAxes, axes_of
from meshonet.geometry.aircraft.body import Body
from meshonet.geometry.aircraft.body_cuts import BodyCuts, body_cuts
from meshonet.geometry.aircraft.body_section import BodySection
from meshonet.geometry.aircraft.lofted_body import LoftedBody
from meshonet.geometry.aircraft.surface_wing import SurfaceWing
from meshonet.geometry.aircraft.wing_strips import wing_strips
from meshonet.geometry.arrays import Floats, extent_of
from meshonet.geometry.errors import InputError, in_place
from meshonet.geometry.notes import Change

KEYS = "surface", "patches"  # keys in the table of a body or wing that is a surface


@dataclass(frozen=True, eq=False)
class _Patches:
    """Patches (ni, nj, 3) of a file, with their names where it has any."""

    nodes: tuple[Floats, ...]
    names: tuple[str, ...]

    def numbers(self, row: Table) -> list[int]:
        """Return the indices of the patches that `row` selects; default: all."""
        chosen = row.data.get("patches")
        if chosen is None:
            return list(range(len(self.nodes)))
        if not isinstance(chosen, list) or not chosen:
            raise row.error("patches", "is no list of numbers or names", 'write [0, 1] or ["body"]')
        out = []
        for each in chosen:
            known = isinstance(each, int) and not isinstance(each, bool) and 0 <= each < len(self.nodes)
            if known or (isinstance(each, str) and each in self.names):
                out.append(each if known else self.names.index(each))
                continue
            names = f" or {', '.join(self.names[:8])}" if self.names else ""
            problem = f"{printable(str(each))} is no patch of the file"
            raise row.error("patches", problem, f"use 0 to {len(self.nodes) - 1}{names}")
        return out


def surface_body(row: Table, folder: Path) -> tuple[Body, AircraftAxes, tuple[str, ...]]:
    """Return the body that the table `row` describes, the axes of its file, and notes for the user.

    The key ``patches`` may select patches of the file; the default is all with a side in the plane of
    symmetry. Paths are relative to `folder`. Raises InputError if the file has no surface, or if the body has
    holes or is not half a body.
    """
    row.only("name", *KEYS)
    file = _read(row, folder)
    numbers, name = file.numbers(row), row.text("name", "fuselage")
    axes = axes_of(np.concatenate([file.nodes[k].reshape(-1, 3) for k in numbers]))
    if axes is None:
        problem, remedy = "lies on both sides of y=0 and of z=0", "give the half on one side of one of them"
        raise row.error("surface", problem, remedy)
    patches = {k: axes.to_aircraft(file.nodes[k]) for k in numbers}
    if "patches" not in row.data:
        patches = {k: nodes for k, nodes in patches.items() if _in_plane(nodes)}
    with row.in_file_of("surface"):
        if not patches:
            raise InputError("no patch has a side in the plane of symmetry", "give the half of a body")
        cuts = body_cuts(list(patches.values()), name)
        meridian = cuts.meridian
        body = _lofted(cuts, name) if meridian is None else Body(meridian, cuts.nose[1], name)
    used = ", ".join(map(str, patches))
    notes = [f"the {name} is patch {used} of {printable(row.text('surface'))}; {axes.description}"]
    return body, axes, (*notes, *cuts.notes)


def _lofted(cuts: BodyCuts, name: str) -> LoftedBody:
    """Return the body through cuts; errors have the place x of a cut."""
    inner = []
    for x, points in zip(cuts.x.tolist(), cuts.points, strict=True):
        with in_place(f"x={x:.6g}"):
            inner.append(BodySection(x, points=points))
    (nose, low), (tail, high) = cuts.nose, cuts.tail
    sections = (BodySection(nose, low), *inner, BodySection(tail, high))
    return LoftedBody(name=name, sections=sections)


def surface_wing(row: Table, folder: Path, axes: AircraftAxes) -> SurfaceWing:
    """Return the wing that the table `row` describes, in the `axes` of the aircraft.

    The key ``patches`` may select patches of the file; the default is those without a side in the plane of
    symmetry. Paths are relative to `folder`. Raises InputError if the file has no surface, or if its patches
    do not enclose a wing.
    """
    row.only("on", "name", *KEYS)
    file = _read(row, folder)
    name = row.text("name", "wing")
    patches = {k: axes.to_aircraft(file.nodes[k]) for k in file.numbers(row)}
    if "patches" not in row.data:
        patches = {k: nodes for k, nodes in patches.items() if not _in_plane(nodes)}
    with row.in_file_of("surface"):
        if not patches:
            raise InputError("all patches have a side in the plane of symmetry", "give {patches} of the wing")
        strips, closing = wing_strips(list(patches.values()), name)
        wing = SurfaceWing.ending(strips, name)
    used = ", ".join(map(str, patches))
    notes = [f"the {name} is patch {used} of {printable(row.text('surface'))}"]
    if closing:
        left_out = ", ".join(str(list(patches)[k]) for k in closing)
        notes.append(Change(f"the tip of the {name} is flat: patch {left_out} is left out"))
    return replace(wing, notes=(*notes, *wing.notes))


def _in_plane(nodes: Floats) -> bool:
    """Return whether a side of a patch (ni, nj, 3) lies in z = 0."""
    sides: Sequence[Floats] = (nodes[0], nodes[-1], nodes[:, 0], nodes[:, -1])
    flat = FLAT * extent_of(nodes.reshape(-1, 3))
    return any(
        bool((np.abs(side[:, 2]) <= flat).all()) and np.ptp(side, axis=0).max() > flat for side in sides
    )


def _read(row: Table, folder: Path) -> _Patches:
    file = str(folder / row.text("surface"))
    with row.in_file_of("surface"):
        grids = list(read_grids(file))
        blocks = [block.nodes for grid in grids for block in grid.blocks]
        if not blocks or any(nodes.ndim != 3 or nodes.shape[-1] != 3 for nodes in blocks):
            raise InputError("holds no surface", "give patches of nodes in space", source=file)
    zones = tuple(str(each) for grid in grids for each in grid.provenance.get("zones") or ())
    return _Patches(tuple(blocks), zones if len(zones) == len(blocks) else ())
