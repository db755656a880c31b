"""Outlines from SVG drawings, ``.svg``; names are ids of elements or of their groups.

y points upwards in the result. Path data are parsed by fontTools. https://www.w3.org/TR/SVG2/paths.html
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from meshonet.formats.mesh.surface import MOST_EDGES
from meshonet.formats.outlines.joined import MOST_BYTES, SAG, extent_checked, shapes_of_drawing
from meshonet.formats.source import Source, printable, reason_of
from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import cos, product, sin
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.shape import Shape

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

Point: TypeAlias = tuple[float, float]
Affine: TypeAlias = tuple[Floats, Floats]
"""An affine map of points (n, 2): matrix (2, 2), applied from the left, and translation (2,)."""

_STEP = re.compile(r"\s*,?\s*(matrix|translate|scale|rotate|skewX|skewY)\s*\(([^()]*)\)\s*")
"""One of the transformations in an attribute ``transform``."""
_GROUPS = ("svg", "g", "a", "switch")  # elements whose children are drawn in place
_NO_CURVES = ("foreignObject", "image", "text", "use")  # elements that are drawn and have no path
_MOST_NESTED = 100  # largest depth of nested groups


@dataclass(frozen=True)
class _Curve:
    """A piece of a path, t from 0 to 1: points `hull` (k, 2), and a bound of the second derivative."""

    hull: Floats
    at: Callable[[Floats], Floats]
    bend: float = 0.0

    def chords(self, sag: float) -> Floats:
        """Return points (n, 2), including both ends, whose chords deviate from the curve by at most `sag`."""
        count = max(1, math.ceil(math.sqrt(min(self.bend / (8.0 * sag), float(MOST_EDGES) ** 2))))
        return self.at(np.linspace(0.0, 1.0, count + 1))


class _Pen:
    """Collects the pieces of a path from fontTools."""

    def __init__(self) -> None:
        self.stretches: list[list[_Curve]] = []
        self._here = (0.0, 0.0)

    def moveTo(self, to: Point) -> None:
        self.stretches.append([])
        self._here = to

    def lineTo(self, to: Point) -> None:
        self.curveTo(to)

    def qCurveTo(self, *points: Point) -> None:
        self.curveTo(*points)

    def curveTo(self, *points: Point) -> None:
        hull = np.array([self._here, *points])
        second = np.diff(hull, 2, axis=0)
        degree = len(points)
        bend = degree * (degree - 1) * float(np.hypot(*second.T).max(initial=0.0))
        self._add(_Curve(hull, lambda t: _bezier(hull, t), bend), points[-1])

    def arcTo(self, rx: float, ry: float, degrees: float, large: bool, sweep: bool, to: Point) -> None:
        if not rx or not ry:
            self.lineTo(to)
        elif to != self._here:
            self._add(_arc(np.array(self._here), np.array(to), rx, ry, degrees, large, sweep), to)

    def _add(self, curve: _Curve, to: Point) -> None:
        self.stretches[-1].append(curve)
        self._here = to

    def closePath(self) -> None:
        """Do nothing, because fontTools draws the line to the start."""

    def endPath(self) -> None:
        """Do nothing, so that an open path stays open."""


def _bezier(points: Floats, t: Floats) -> Floats:
    """Return points (n, 2) of a Bezier curve by de Casteljau's algorithm."""
    rows, u = list(points[:, None]), t[:, None]
    while len(rows) > 1:
        rows = [(1.0 - u) * a + u * b for a, b in pairwise(rows)]
    return rows[0]


def _arc(a: Floats, b: Floats, rx: float, ry: float, degrees: float, large: bool, sweep: bool) -> _Curve:
    """Return the elliptical arc from `a` to `b`; radii that are too small grow (SVG 2, B.2.4)."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    axes = np.array([[rx * c, rx * s], [-ry * s, ry * c]])
    half = 0.5 * (a - b)
    x, y = (half[0] * c + half[1] * s) / rx, (half[1] * c - half[0] * s) / ry  # on the unit circle
    square = x * x + y * y
    if square > 1.0:
        axes, x, y = axes * math.sqrt(square), x / math.sqrt(square), y / math.sqrt(square)
    off = math.sqrt(max(1.0 / min(square, 1.0) - 1.0, 0.0)) * (1.0 if large == sweep else -1.0)
    u, v = -off * y, off * x
    begin, turn = math.atan2(y - v, x - u), math.atan2(-y - v, -x - u)
    turn = (turn - begin) % (2.0 * math.pi) - (0.0 if sweep else 2.0 * math.pi)
    centre = 0.5 * (a + b) + product(np.array([u, v]), axes)

    def at(t: Floats) -> Floats:
        angle = begin + turn * t
        points = centre + product(np.stack([cos(angle), sin(angle)], axis=1), axes)
        points[0], points[-1] = a, b
        return np.asarray(points)

    reach = np.abs(axes).sum(axis=0)
    return _Curve(
        np.stack([a, b, centre - reach, centre + reach]), at, float(np.hypot(*axes.T).max()) * turn**2
    )


def read_shapes(source: Source) -> Iterator[Shape]:
    """Yield the shapes that the curves of an SVG drawing enclose; curves are approximated by chords.

    Text, images and ``use`` elements are left out, with a note. Clipping and visibility are ignored. Raises
    InputError if it is no SVG drawing, or if curves are not closed.
    """
    from xml.etree.ElementTree import ParseError, fromstring

    data = source.bytes_below(MOST_BYTES, "a drawing")
    if b"<!ENTITY" in data:  # entities can expand without bound, and no drawing needs one
        raise InputError("its XML defines entities", "save it again as plain SVG")
    try:
        root = fromstring(data)  # noqa: S314  (no entities)
        drawn = list(_drawn(root, (np.diag([1.0, -1.0]), np.zeros(2)), "", 0))
    except (ParseError, ValueError, LookupError, ArithmeticError) as error:
        problem = f"is no SVG drawing that can be read ({reason_of(error)})"
        raise InputError(problem, "save it again as plain SVG") from None
    if not drawn:
        raise InputError("has no curves", "draw lines, paths or shapes, not pictures and text")
    extent = extent_checked(
        np.concatenate([product(curve.hull, a) + shift for _, (a, shift), line in drawn for curve in line])
    )
    lines = []
    for name, (a, shift), line in drawn:
        sag = SAG * extent / max(float(np.hypot(*a.ravel()[:2])) + float(np.hypot(*a.ravel()[2:])), 1e-300)
        pieces = [curve.chords(sag) for curve in line]
        lines.append((name, product(np.concatenate(pieces), a) + shift))
    tags = (str(element.tag).rpartition("}")[2] for element in root.iter())
    yield from shapes_of_drawing(lines, (tag for tag in tags if tag in _NO_CURVES), source.stem)


def _drawn(
    element: Element, outer: Affine, name: str, depth: int
) -> Iterator[tuple[str, Affine, list[_Curve]]]:
    """Yield name, transformation and pieces of each path of an element and its children."""
    from fontTools.svgLib.path.parser import parse_path

    if depth > _MOST_NESTED:
        raise ValueError("groups in groups without end")
    tag = str(element.tag).rpartition("}")[2]
    name, inner = printable(element.get("id", name)), _mapped(element.get("transform", ""), outer)
    if tag in _GROUPS:
        for member in element:
            yield from _drawn(member, inner, "" if tag == "svg" else name, depth + 1)
        return
    pen = _Pen()
    parse_path(_data(tag, element), pen)
    yield from ((name, inner, line) for line in pen.stretches if line)


def _data(tag: str, element: Element) -> str:
    """Return the path data of an element; empty for elements without a path."""
    if tag == "path":
        return element.get("d", "")
    if tag in ("polyline", "polygon"):
        return f"M{element.get('points', '')}{'z' * (tag == 'polygon')}"

    def number(*keys: str) -> float:
        return next((float(text.removesuffix("px")) for key in keys if (text := element.get(key))), 0.0)

    if tag == "line":
        return f"M{number('x1')} {number('y1')}L{number('x2')} {number('y2')}"
    if tag in ("circle", "ellipse"):
        x, y, rx, ry = number("cx"), number("cy"), number("rx", "r"), number("ry", "r")
        return f"M{x - rx} {y}a{rx} {ry} 0 1 1 {2 * rx} 0a{rx} {ry} 0 1 1 {-2 * rx} 0z"
    if tag != "rect":
        return ""
    w, h = number("width"), number("height")
    rx, ry = min(number("rx", "ry"), 0.5 * w), min(number("ry", "rx"), 0.5 * h)
    sides = (
        (w - 2 * rx, "h", rx, ry),
        (h - 2 * ry, "v", -rx, ry),
        (2 * rx - w, "h", -rx, -ry),
        (2 * ry - h, "v", rx, -ry),
    )
    rounds = "".join(f"{way}{length}a{rx} {ry} 0 0 1 {x} {y}" for length, way, x, y in sides)
    return f"M{number('x') + rx} {number('y')}{rounds}z"


def _mapped(steps: str, outer: Affine) -> Affine:
    """Return the transformation `outer` combined with the `steps` of an attribute ``transform``."""
    end = 0
    for step in _STEP.finditer(steps):
        if step.start() != end:
            break
        end = step.end()
        outer = _step(step[1], [float(word) for word in step[2].replace(",", " ").split()], outer)
    if end != len(steps):
        raise ValueError(f"transform {steps[:40]!r}")
    return outer


def _step(kind: str, values: list[float], outer: Affine) -> Affine:
    a, shift = np.eye(2), np.zeros(2)
    if kind == "matrix":
        a, shift = np.reshape(values[:4], (2, 2)), np.reshape(values[4:], 2)
    elif kind == "translate":
        shift[: len(values)] = values
    elif kind == "scale":
        a = np.diag([values[0], values[-1]])
    elif kind == "rotate":
        c, s, about = (
            math.cos(math.radians(values[0])),
            math.sin(math.radians(values[0])),
            [*values[1:], 0.0, 0.0],
        )
        a = np.array([[c, s], [-s, c]])
        shift = np.array(about[:2]) - product(np.array(about[:2]), a)
    else:
        a[(1, 0) if kind == "skewX" else (0, 1)] = math.tan(math.radians(values[0]))
    return product(a, outer[0]), product(shift, outer[0]) + outer[1]
