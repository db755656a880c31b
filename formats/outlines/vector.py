"""Outlines from vector geometry: WKT (one geometry a file or a line) and GeoJSON.

Polygons and closed lines are outlines, a polygon with one hole is a body in its far field; collections hold
several. A third coordinate is dropped.
https://www.ogc.org/standards/sfa , https://www.rfc-editor.org/rfc/rfc7946
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from meshonet.formats.mesh.closed_curve import closed_curve
from meshonet.formats.source import LARGEST, Source, printable
from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import polygon_area
from meshonet.geometry.shapes.annulus import Annulus
from meshonet.geometry.shapes.outline import Outline
from meshonet.geometry.shapes.shape import Shape

if TYPE_CHECKING:
    from shapely.geometry.base import BaseGeometry

_ASK = "give a POLYGON or a closed LINESTRING"


def read_wkt(source: Source) -> Iterator[Shape]:
    """Yield the outlines of a WKT file.

    Raises InputError: text that is no WKT, a geometry that is no outline; with its line.
    """
    yield from _named([(source.stem, place, geometry) for place, geometry in _geometries(_text(source))])


def read_geojson(source: Source) -> Iterator[Shape]:
    """Yield the outlines of a GeoJSON file, called by the property ``name`` of their features.

    Raises InputError: text that is no GeoJSON, a geometry that is no outline; with the number of its feature.
    """
    from shapely.errors import ShapelyError
    from shapely.geometry import shape

    try:
        features = _features(json.loads(_text(source)))
    except (ValueError, RecursionError) as error:
        raise InputError(f"is not JSON ({_short(error)})", "give a GeoJSON file") from None
    found: list[tuple[str, str, BaseGeometry]] = []
    for number, (name, geometry) in enumerate(features, start=1):
        place = f"feature {number}" if len(features) > 1 else ""
        if not isinstance(geometry, dict) or not isinstance(geometry.get("type"), str):
            raise InputError("is not a GeoJSON geometry (it names no type)", _ASK, place=place)
        try:
            with np.errstate(all="ignore"):  # of NaN and infinity, which are refused later
                found.append((name or source.stem, place, shape(geometry)))
        except (
            ShapelyError,
            ValueError,
            TypeError,
            KeyError,
            AttributeError,
            IndexError,
            RecursionError,
        ) as error:
            raise InputError(f"is not a GeoJSON geometry ({_short(error)})", _ASK, place=place) from None
    yield from _named(found)


def _geometries(text: str) -> list[tuple[str, BaseGeometry]]:
    """Return (place, geometry) of a text that is one geometry, or else of each of its lines."""
    from shapely import from_wkt
    from shapely.errors import ShapelyError

    found: list[tuple[str, BaseGeometry]] = []
    with np.errstate(all="ignore"):  # shapely lets numpy warn of NaN and infinity; they are refused later
        try:
            return [("", from_wkt(text))]
        except ShapelyError:
            pass
        for number, line in enumerate(text.splitlines(), start=1):
            if not line.strip() or line.lstrip().startswith("#"):
                continue
            try:
                found.append((f"line {number}", from_wkt(line)))
            except ShapelyError as error:
                raise InputError(f"is not WKT ({_short(error)})", _ASK, place=f"line {number}") from None
    return found


def _named(found: list[tuple[str, str, BaseGeometry]]) -> Iterator[Shape]:
    """Yield the outlines of (name, place, geometry), numbered where several share a name."""
    shapes = [(name, place, rings) for name, place, geometry in found for rings in _rings(geometry, place)]
    if not shapes:
        raise InputError("holds no geometry", _ASK)
    names = [name for name, _, _ in shapes]
    for number, (name, place, rings) in enumerate(shapes, start=1):
        try:
            yield _shape(*map(_points, rings), name=name if names.count(name) == 1 else f"{name}-{number}")
        except InputError as error:
            error.place = error.place or place
            raise


def _shape(outer: Floats, hole: Floats | None = None, *, name: str) -> Shape:
    """Return the outline of a ring (n, 2), or the body that is the hole (m, 2) in it."""
    if hole is None:
        return Outline(outer, name)
    clockwise = outer[::-1] if polygon_area(outer) > 0 else outer
    return Annulus(closed_curve(hole, name), Outline(clockwise, name).curve, name)


def _points(ring: Any) -> Floats:
    """Return the points (n, 2) of a closed line, the first not repeated."""
    points = np.array([point[:2] for point in ring.coords], dtype=np.float64)
    if not (np.abs(points) < LARGEST).all():
        raise InputError("a coordinate is not finite or far too large", "check its numbers")
    return points[:-1]


def _rings(geometry: BaseGeometry, place: str) -> Iterator[list[Any]]:
    """Yield the closed line, and that of the hole in it, of a geometry and of its members."""
    if hasattr(geometry, "geoms"):
        for member in geometry.geoms:
            yield from _rings(member, place)
        return
    kind = geometry.geom_type
    if geometry.is_empty or kind not in ("Polygon", "LineString", "LinearRing"):
        raise InputError(f"has an empty {kind} or a {kind}, which is no outline", _ASK, place=place)
    holes = list(geometry.interiors) if kind == "Polygon" else []
    if len(holes) > 1:
        raise InputError(
            f"polygon has {len(holes)} holes",
            "give one hole, which is a body in its far field, or each ring by itself",
            place=place,
        )
    ring = geometry.exterior if kind == "Polygon" else geometry
    if ring.coords[0] != ring.coords[-1]:
        raise InputError("line is not closed", "repeat its first point at its end", place=place)
    yield [ring, *holes]


def _features(data: Any) -> list[tuple[str, Any]]:
    """Return (name, geometry) of every feature of a GeoJSON object."""
    if not isinstance(data, dict):
        raise ValueError("not an object")
    members = data.get("features")
    if data.get("type") == "FeatureCollection" and isinstance(members, list):
        return [feature for member in members for feature in _features(member)]
    if data.get("type") == "Feature":
        properties = data.get("properties")
        name = properties.get("name") if isinstance(properties, dict) else None
        return [(printable(str(name)) if name else "", data.get("geometry"))]
    return [("", data)]


def _text(source: Source) -> str:
    try:
        return source.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError("is not UTF-8 text", "save it as UTF-8", place=f"byte {error.start}") from None


def _short(error: Exception) -> str:
    return printable(str(error).split("\n")[0])[:100] or type(error).__name__
