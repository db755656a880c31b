"""Boundary conditions and one-to-one interfaces of CGNS zones that other programs wrote.

Ranges may ascend or descend, and count nodes or faces. A condition may list points instead of a range.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.cgns.nodes import Node, array, children, text
from meshonet.formats.mesh.names import kind_said
from meshonet.formats.mesh.windows import Face, FaceWindow, Triple
from meshonet.formats.source import printable
from meshonet.geometry.blocks.outer_patches import JOINED, UNNAMED, rectangles
from meshonet.geometry.blocks.patches import Kind
from meshonet.geometry.errors import InputError

Points = NDArray[np.int64]
_KINDS: tuple[tuple[str, Kind], ...] = (
    ("BCWall", "wall"), ("BCFarfield", "farfield"), ("BCInflow", "inlet"), ("BCTunnelInflow", "inlet"),
    ("BCOutflow", "outlet"), ("BCTunnelOutflow", "outlet"), ("BCSymmetry", "symmetry"),
    ("BCAxisymmetricWedge", "wedge"),
)  # fmt: skip
"""Kinds of boundary by the start of CGNS's name of the condition (SIDS, BCType_t)."""
_NOTHING = ("Null", "BCTypeNull")  # conditions without meaning, which are ignored
_FACES = ("FaceCenter", "IFaceCenter", "JFaceCenter", "KFaceCenter", "EdgeCenter", "CellCenter")
"""Locations at which a range counts faces, not nodes (SIDS, GridLocation_t)."""


def conditions(base: Node, zone: Node, counts: Triple, block: int) -> Iterator[Face]:
    """Yield each face of a zone that has a boundary condition, named after the family of the condition.

    `block` is the number of the zone. `counts` are the zone's node counts; the third is 1 in the plane.
    """
    for _, group in children(zone, "ZoneBC_t"):
        for title, condition in children(group, "BC_t"):
            kind = _text(condition)
            family = next((text(node) for _, node in children(condition, "FamilyName_t")), "")
            if kind in _NOTHING and not family:
                continue
            own = family.rpartition("/")[2]
            if kind == "FamilySpecified":
                kinds = [node for name, node in children(base, "Family_t") if name == own]
                kind = next(
                    (_text(node) for each in kinds[:1] for _, node in children(each, "FamilyBC_t")), ""
                )
            name = printable(own or title).strip() or "part"
            for first, last in _covered(condition, counts):
                yield Face(FaceWindow(block, first, last), name, kind_said(name, kind, _KINDS))


def interfaces(
    base: Node, zone: Node, counts: Triple, block: int
) -> Iterator[tuple[str, FaceWindow, str, Points, Triple]]:
    """Yield each interface of a zone: name and nodes, then path, corners and index order of the donor."""
    for _, group in children(zone, "ZoneGridConnectivity_t"):
        for name, joint in children(group, "GridConnectivity1to1_t"):
            ranges = dict(children(joint, "IndexRange_t"))
            if not {"PointRange", "PointRangeDonor"} <= set(ranges):
                continue
            own = _points(array(ranges["PointRange"], 2))
            donor_range = _points(array(ranges["PointRangeDonor"], 2))
            if own is None or donor_range is None or not _inside(own, counts):
                raise InputError(f"interface {printable(name)!r} leaves its zone", "correct its PointRange")
            donor = text(joint)
            path = f"/{donor.lstrip('/')}" if "/" in donor else f"{base.name}/{donor}"
            yield printable(name), _window(block, own), path, donor_range, _partners(joint, printable(name))


def window_of(block: int, points: Points, counts: Triple) -> FaceWindow | None:
    """Return the window (rectangle of nodes) from the first to the last of the node indices `points` (2, 3).

    Returns None if an index is outside the block, which has `counts` nodes along its three directions.
    """
    return _window(block, points) if _inside(points, counts) else None


def _window(block: int, points: Points) -> FaceWindow:
    first, last = (tuple(row) for row in points[[0, -1]].tolist())
    return FaceWindow(block, first, last)


def _inside(points: Points, counts: Triple) -> bool:
    return bool((points >= 0).all() and (points < np.array(counts)).all())


def _points(indices: NDArray[Any]) -> Points | None:
    """Return the indices (n, 2 or 3) as (n, 3), counted from 0; None if they have another shape."""
    if indices.ndim != 2 or indices.shape[1] not in (2, 3) or not len(indices):
        return None
    points = np.zeros((len(indices), 3), np.int64)
    points[:, : indices.shape[1]] = indices.astype(np.int64) - 1
    return points


def _partners(joint: Node, name: str) -> Triple:
    """Return the donor's index direction along each of the zone's; by default the same one."""
    values = next((array(node, 1) for _, node in children(joint, '"int[IndexDimension]"')), None)
    if values is None:
        return 0, 1, 2
    partners = [abs(int(value)) - 1 for value in values]
    partners += range(len(partners), 3)
    if sorted(partners) != [0, 1, 2]:
        shown = values.tolist()
        raise InputError(f"interface {name!r} has transform {shown}", "give each index once, from 1 on")
    return partners[0], partners[1], partners[2]


def _covered(condition: Node, counts: Triple) -> Iterator[tuple[Triple, Triple]]:
    """Yield the first and last nodes of the parts of faces that a condition covers."""
    location = next((text(node) for _, node in children(condition, "GridLocation_t")), "")
    faces = location in _FACES
    nodes = [*children(condition, "IndexRange_t"), *children(condition, "IndexArray_t")]
    for name, node in nodes:
        points = _points(array(node, 2)) if name in ("PointRange", "PointList", "ElementRange") else None
        if points is None:
            continue
        if name == "PointList" and not faces:
            yield from _listed(points, counts)
            return
        low, high = points.min(axis=0), points.max(axis=0)
        across = _across(low, high, counts, location)
        if across is not None:
            if faces:
                high[[k for k in range(3) if k != across and counts[k] > 1]] += 1
                low[across] = high[across] = 0 if low[across] == 0 else counts[across] - 1
            yield _window(0, np.stack([low, high]))[1:]
        return


def _across(low: Points, high: Points, counts: Triple, location: str) -> int | None:
    """Return the index direction in which a range is constant, at an end of the block; None if on no face."""
    hinted = {"I": 0, "J": 1, "K": 2}.get(location[:1]) if location in _FACES else None
    last = [count - 2 if location == "CellCenter" else count - 1 for count in counts]
    able = [k for k in range(3) if counts[k] > 1 and low[k] == high[k] and low[k] in (0, last[k])]
    return next((k for k in able if hinted in (None, k)), None)


def _listed(points: Points, counts: Triple) -> Iterator[tuple[Triple, Triple]]:
    """Yield the rectangles of cells at faces all of whose nodes are among `points`."""
    points = points[((points >= 0) & (points < np.array(counts))).all(axis=1)]
    for across in (k for k in range(3) if counts[k] > 1):
        along = [k for k in range(3) if k != across]
        for place in (0, counts[across] - 1):
            on = points[points[:, across] == place][:, along]
            marked = np.zeros([counts[k] for k in along], dtype=bool)
            marked[tuple(on.T)] = True
            marked = marked.squeeze()
            for axis in range(marked.ndim):
                ends = (slice(None),) * axis
                marked = marked[(*ends, slice(None, -1))] & marked[(*ends, slice(1, None))]
            for _, span in rectangles(np.where(marked, UNNAMED, JOINED)):
                spans = iter(span)
                ranges = [
                    (place, place) if k == across else next(spans) if counts[k] > 1 else (0, 0)
                    for k in range(3)
                ]
                first, last = zip(*ranges, strict=True)
                yield first, last


def _text(node: Node) -> str:
    try:
        return text(node)
    except InputError:  # a condition of no kind
        return ""
