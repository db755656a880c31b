"""Outlines from DXF drawings, ``.dxf``, through ezdxf (extra ``dxf``): names are those of the layers.

Lines, polylines, arcs, circles, ellipses and splines of the model space are joined where their ends meet;
curved ones become chords. https://ezdxf.mozman.at
"""

import io
from collections.abc import Iterator
from typing import Any

import numpy as np

from meshonet.formats.mesh.surface import MOST_EDGES, MeshBoundary, shapes_of
from meshonet.formats.mesh.unstructured import Indices
from meshonet.formats.source import LARGEST, Source, printable
from meshonet.geometry.arrays import Floats, extent_of
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.shape import Shape

_KINDS = {"LINE", "LWPOLYLINE", "POLYLINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE"}
"""Entities that are curves."""
_MOST_BYTES = 64 << 20
"""Larger drawings take too long to read: no outline needs so many curves."""
_MEET = 1e-6
"""How far apart, in extents, two ends may lie and still meet."""
_SAG = 1e-5
"""Largest distance of a chord from its curve, in extents."""


def read_shapes(source: Source) -> Iterator[Shape]:
    """Yield the shapes that the curves of a drawing enclose.

    Raises InputError: ezdxf is not installed; no such drawing; curves that do not close.
    """
    try:
        from ezdxf import path
        from ezdxf.filemanagement import read
    except ImportError:
        raise InputError("needs the package ezdxf", "install it: pip install 'meshonet[dxf]'") from None
    if source.size > _MOST_BYTES:
        raise InputError(f"{source.size >> 20} MB are too much for a drawing", "give a file below 64 MB")
    data = source.read_bytes()
    if data.startswith(b"AutoCAD Binary DXF"):
        raise InputError("is a binary DXF", "save it as text (ASCII) DXF")
    if b"\0" in data:  # no text has one, and a reader of drawings takes seconds to find out
        raise InputError("is no DXF drawing that can be read (zero bytes)", "save it again as ASCII DXF")
    try:
        drawing = read(io.StringIO(data.decode("utf-8", "replace").replace("\r\n", "\n")))
        curves = [
            (printable(str(entity.dxf.layer)), path.make_path(entity))
            for entity in drawing.modelspace()
            if entity.dxftype() in _KINDS
        ]
        lines = _lines(curves)
    except InputError:
        raise
    except Exception as error:  # whatever a damaged drawing makes of it
        reason = printable(str(error).split("\n")[0])[:100] or type(error).__name__
        problem = f"is no DXF drawing that can be read ({reason})"
        raise InputError(problem, "save it again as ASCII DXF") from error
    if not lines:
        raise InputError("has no curves in its model space", "draw lines, polylines, arcs or splines")
    yield from shapes_of(_joined(lines), source.stem)


def _lines(curves: list[tuple[str, Any]]) -> list[tuple[str, Floats]]:
    """Return layer and points (n, 2) of each curve, chords in place of what is curved."""
    curves = [(layer, curve) for layer, curve in curves if len(curve)]
    if not curves:
        return []
    every = np.array([(v.x, v.y) for _, curve in curves for v in curve.control_vertices()])
    extent = extent_of(every)
    if not (np.abs(every) < LARGEST).all() or extent == 0:
        raise InputError("its curves have no size, or one that is not finite", "check the drawing")
    lines, count = [], 0
    for layer, curve in curves:
        chords = curve.control_vertices()
        if curve.has_curves:
            chords = curve.flattening(_SAG * extent, segments=16)
        points = np.array([(v.x, v.y) for v in chords])
        keep = np.append(True, (np.diff(points, axis=0) != 0).any(axis=1))
        count += len(points)
        if count > MOST_EDGES:
            raise InputError(f"has more than {MOST_EDGES} points", "simplify the drawing")
        if keep.sum() > 1:
            lines.append(("" if layer == "0" else layer, points[keep]))
    return lines


def _joined(lines: list[tuple[str, Floats]]) -> MeshBoundary:
    """Return the curves as edges between points, ends that meet being one point."""
    points = np.concatenate([line for _, line in lines])
    reach = _MEET * extent_of(points)
    counts = [len(line) for _, line in lines]
    stops = np.cumsum(counts)
    starts = stops - counts
    same = np.arange(len(points))
    ends = np.concatenate([starts, stops - 1])
    order = ends[np.argsort(points[ends, 0], kind="stable")].tolist()
    for k, end in enumerate(order):
        if same[end] != end:
            continue
        for later in order[k + 1 :]:
            if points[later, 0] - points[end, 0] > reach:
                break
            if same[later] == later and abs(points[later, 1] - points[end, 1]) <= reach:
                same[later] = end
    edges: dict[str, list[Indices]] = {}
    for (layer, _), start, stop in zip(lines, starts, stops, strict=True):
        nodes = same[start:stop]
        edges.setdefault(layer, []).append(np.stack([nodes[:-1], nodes[1:]], axis=1))
    return MeshBoundary(points, {layer: np.concatenate(pieces) for layer, pieces in edges.items()})
