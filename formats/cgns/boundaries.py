"""What a CGNS zone of others says of its sides: boundary conditions by family, one-to-one interfaces.

Ranges may run either way and count nodes or, where the location says so, faces; a condition may list its
points instead. What a transform says follows from the ranges: right-handed zones run along an interface in
opposite ways.
"""

from collections.abc import Iterator
from typing import Any

from numpy.typing import NDArray

from meshonet.formats.cgns.nodes import Node, array, children, text
from meshonet.formats.mesh.spans import Span, span_of
from meshonet.formats.source import printable
from meshonet.geometry.blocks.patches import Kind, Patch, kind_of
from meshonet.geometry.errors import InputError

_KINDS: tuple[tuple[str, Kind], ...] = (
    ("BCWall", "wall"), ("BCFarfield", "farfield"), ("BCInflow", "inlet"), ("BCTunnelInflow", "inlet"),
    ("BCOutflow", "outlet"), ("BCTunnelOutflow", "outlet"), ("BCSymmetry", "symmetry"),
)  # fmt: skip
_OTHER: Kind = "other"
_NOTHING = ("Null", "BCTypeNull")
_FACES = ("FaceCenter", "IFaceCenter", "JFaceCenter", "KFaceCenter", "EdgeCenter", "CellCenter")


def conditions(base: Node, zone: Node, counts: tuple[int, ...], dropped: int) -> Iterator[Patch]:
    """Yield the boundary conditions that cover a stretch of one side, called by their family.

    `counts` are the zone's nodes along its two indices, `dropped` is the third one.
    """
    for _, group in children(zone, "ZoneBC_t"):
        for title, condition in children(group, "BC_t"):
            kind = _text(condition)
            family = next((text(node) for _, node in children(condition, "FamilyName_t")), "")
            span = _covered(condition, counts, dropped)
            if span is None or (kind in _NOTHING and not family):
                continue
            if kind == "FamilySpecified":
                kind = _family_kind(base, family)
            name = printable(family.rpartition("/")[2] or title).strip() or "part"
            known = next((k for sign, k in _KINDS if kind.startswith(sign)), _OTHER)
            told = kind_of(name)
            yield Patch(name, *span, kind=known if told == _OTHER else told)


def interfaces(
    base: Node, zone: Node, counts: tuple[int, ...], dropped: int
) -> Iterator[tuple[str, Span, str, NDArray[Any]]]:
    """Yield of each one-to-one interface its name, stretch of the zone, the donor's path and range."""
    for _, group in children(zone, "ZoneGridConnectivity_t"):
        for name, joint in children(group, "GridConnectivity1to1_t"):
            ranges = dict(children(joint, "IndexRange_t"))
            if not {"PointRange", "PointRangeDonor"} <= set(ranges):
                continue
            own = span_of(array(ranges["PointRange"], 2), counts, dropped)
            donor = text(joint)
            path = f"/{donor.lstrip('/')}" if "/" in donor else f"{base.name}/{donor}"
            if own is not None:
                yield printable(name), own, path, array(ranges["PointRangeDonor"], 2)


def _covered(condition: Node, counts: tuple[int, ...], dropped: int) -> Span | None:
    location = next((text(node) for _, node in children(condition, "GridLocation_t")), "")
    found = [*children(condition, "IndexRange_t"), *children(condition, "IndexArray_t")]
    for name, node in found:
        if name in ("PointRange", "PointList", "ElementRange"):
            return span_of(array(node, 2), counts, dropped, faces=location in _FACES)
    return None


def _family_kind(base: Node, family: str) -> str:
    for name, node in children(base, "Family_t"):
        if name == family.rpartition("/")[2]:
            return next((_text(below) for _, below in children(node, "FamilyBC_t")), "")
    return ""


def _text(node: Node) -> str:
    try:
        return text(node)
    except InputError:  # a condition of no kind
        return ""
