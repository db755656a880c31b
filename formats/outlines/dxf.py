"""Outlines from DXF drawings, ``.dxf``, read by ezdxf (extra ``dxf``); names are those of layers.

Curves of the model space are joined at equal ends, and approximated by chords. https://ezdxf.mozman.at
"""

import io
from collections.abc import Iterator
from itertools import islice
from typing import Any

import numpy as np

from meshonet.formats.mesh.surface import MOST_EDGES
from meshonet.formats.outlines.joined import MOST_BYTES, SAG, extent_checked, shapes_of_drawing
from meshonet.formats.source import Source, printable, reason_of
from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.shape import Shape

_KINDS = {"LINE", "LWPOLYLINE", "POLYLINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE"}  # entities that are curves


def read_shapes(source: Source) -> Iterator[Shape]:
    """Yield the shapes that the curves of a DXF drawing enclose; other entities are left out, with a note.

    Raises InputError if ezdxf is not installed, if the file is too large, binary or no drawing, if
    coordinates are not finite, or if curves are missing, not closed, crossing or inside a hole.
    """
    try:
        from ezdxf import path
        from ezdxf.disassemble import recursive_decompose
        from ezdxf.filemanagement import read
    except ImportError:
        raise InputError("needs the package ezdxf", "install it: pip install 'meshonet[dxf]'") from None
    data = source.bytes_below(MOST_BYTES, "a drawing")
    if data.startswith(b"AutoCAD Binary DXF"):
        raise InputError("is a binary DXF", "save it as text (ASCII) DXF")
    if b"\0" in data:  # no text has one, and a reader of drawings takes seconds to find out
        raise InputError("is no DXF drawing that can be read (zero bytes)", "save it again as ASCII DXF")
    try:
        drawing = read(io.StringIO(data.decode("utf-8", "replace").replace("\r\n", "\n")))
        entities = list(islice(recursive_decompose(drawing.modelspace()), MOST_EDGES + 1))
        curves = [
            (printable(str(entity.dxf.layer)), path.make_path(entity))
            for entity in entities[:MOST_EDGES]
            if entity.dxftype() in _KINDS
        ]
        lines = _lines(curves)
    except InputError:
        raise
    except Exception as error:  # whatever a damaged drawing makes of it
        problem = f"is no DXF drawing that can be read ({reason_of(error)})"
        raise InputError(problem, "save it again as ASCII DXF") from error
    if len(entities) > MOST_EDGES:
        raise InputError(f"has more than {MOST_EDGES} entities", "simplify the drawing")
    if not lines:
        raise InputError("has no curves in its model space", "draw lines, polylines, arcs or splines")
    skipped = (kind for kind in (entity.dxftype() for entity in entities) if kind not in _KINDS)
    yield from shapes_of_drawing(lines, skipped, source.stem)


def _lines(curves: list[tuple[str, Any]]) -> list[tuple[str, Floats]]:
    """Return layer and points (n, 2) of each curve, which is approximated by chords."""
    curves = [(layer, curve) for layer, curve in curves if len(curve)]
    if not curves:
        return []
    extent = extent_checked(np.array([(v.x, v.y) for _, curve in curves for v in curve.control_vertices()]))
    lines = []
    for layer, curve in curves:
        chords = curve.flattening(SAG * extent, segments=16) if curve.has_curves else curve.control_vertices()
        lines.append(("" if layer == "0" else layer, np.array([(v.x, v.y) for v in chords])))
    return lines
