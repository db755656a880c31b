"""Domains and outlines from WKT and GeoJSON (docs/reference/shapes.md).

https://www.ogc.org/standards/sfa , https://www.rfc-editor.org/rfc/rfc7946
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from meshonet.formats.mesh.surface import shapes_of
from meshonet.formats.outlines.joined import joined
from meshonet.formats.source import LARGEST, Source, printable, reason_of
from meshonet.geometry.arrays import Floats, ends_meet
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.edges import DrawnEdge, channel, four_edges
from meshonet.geometry.shapes.outline import Outline
from meshonet.geometry.shapes.polygon_shape import PolygonRing, domain_or_body, polygon_shape
from meshonet.geometry.shapes.shape import Shape

if TYPE_CHECKING:
    from shapely.geometry.base import BaseGeometry

_ASK = "give a POLYGON or a closed LINESTRING"  # remedy for a geometry that is not an outline


@dataclass(frozen=True)
class _Geometry:
    """A geometry with its name, its place in the file, and the properties of its rings."""

    name: str
    place: str
    geometry: BaseGeometry
    properties: Mapping[str, Any]


def read_wkt(source: Source) -> Iterator[Shape]:
    """Yield the shapes of a WKT file: one geometry per line, after an optional line ``# name``.

    Raises InputError, with the line, if it is not WKT, or if a geometry is no outline.
    """
    geometries = _geometries(_text(source))
    drawn = [_Geometry(source.stem, place, each, {"name": called}) for place, each, called in geometries]
    yield from _named(drawn, source.stem)


def read_geojson(source: Source) -> Iterator[Shape]:
    """Yield the shapes of a GeoJSON file; the property ``name`` of a feature is the name of its shape.

    Raises InputError: not GeoJSON; no outline; unsuitable properties (``corners``, ``names``, ``periodic``).
    """
    from shapely.errors import ShapelyError
    from shapely.geometry import shape

    try:
        features = _features(json.loads(_text(source)))
    except (ValueError, RecursionError) as error:
        raise InputError(f"is not JSON ({reason_of(error)})", "give a GeoJSON file") from None
    drawn: list[_Geometry] = []
    for number, (properties, geometry) in enumerate(features, start=1):
        place = f"feature {number}" if len(features) > 1 else ""
        name = printable(str(properties.get("name") or "")) or source.stem
        if not isinstance(geometry, dict) or not isinstance(geometry.get("type"), str):
            raise InputError("is not a GeoJSON geometry (it names no type)", _ASK, place=place)
        try:
            with np.errstate(all="ignore"):  # of NaN and infinity, which are refused later
                drawn.append(_Geometry(name, place, shape(geometry), properties))
        except (
            ShapelyError,
            ArithmeticError,
            AttributeError,
            LookupError,
            RecursionError,
            TypeError,
            ValueError,
        ) as error:
            raise InputError(f"is not a GeoJSON geometry ({reason_of(error)})", _ASK, place=place) from None
    yield from _named(drawn, source.stem)


def _geometries(text: str) -> list[tuple[str, BaseGeometry, str]]:
    """Return place, geometry and name: of the text, or of each of its lines."""
    from shapely import from_wkt
    from shapely.errors import ShapelyError

    geometries: list[tuple[str, BaseGeometry, str]] = []
    with np.errstate(all="ignore"):  # shapely lets numpy warn of NaN and infinity; they are refused later
        try:
            return [("", from_wkt(text), "")]
        except ShapelyError:
            pass
        name = ""
        for number, line in enumerate(map(str.strip, text.splitlines()), start=1):
            if not line or line.startswith("#"):
                name = printable(line.strip("# "))
                continue
            try:
                geometries.append((f"line {number}", from_wkt(line), name))
                name = ""
            except ShapelyError as error:
                remedy = _ASK if "(" in line else f"{_ASK}; a name is a line '# {printable(line)[:40]}'"
                raise InputError(f"is not WKT ({reason_of(error)})", remedy, place=f"line {number}") from None
    return geometries


def _named(drawn: list[_Geometry], stem: str) -> Iterator[Shape]:
    """Yield the shapes of geometries, numbered if several share a name; open lines form one."""
    lines = [(each, line) for each in drawn for line in getattr(each.geometry, "geoms", [each.geometry])]
    if all(line.geom_type == "LineString" and not line.is_empty for _, line in lines):
        closed = [_is_closed(line) for _, line in lines]
        edges = [] if all(closed) else [_edge(each, line) for each, line in lines]
        if not any(closed) and (len(edges) == 4 or (len(edges) == 2 and all(edge.is_wall for edge in edges))):
            yield (four_edges if len(edges) == 4 else channel)(edges, stem)
            return
        if len(edges) > 1:
            yield from shapes_of(joined([(edge.name, edge.points) for edge in edges]), stem)
            return
    parts = [(each, rings) for each in drawn for rings in _rings(each.geometry, each.place)]
    if not parts:
        raise InputError("holds no geometry", _ASK)
    names = [each.name for each, _ in parts]
    for number, (each, rings) in enumerate(parts, start=1):
        try:
            yield _shape(each, rings, each.name if names.count(each.name) == 1 else f"{each.name}-{number}")
        except InputError as error:
            error.place = ", ".join(dict.fromkeys(place for place in (each.place, error.place) if place))
            raise


def _edge(drawn: _Geometry, line: Any) -> DrawnEdge:
    points = _points(line)
    places = [", ".join(filter(None, (drawn.place, f"point {k}"))) for k in range(len(points))]
    return DrawnEdge(points, places, printable(str(drawn.properties.get("name") or "")))


def _shape(drawn: _Geometry, rings: list[Any], name: str) -> Shape:
    """Return the domain of a polygon, or the body or outline of a closed line."""
    points = [_points(ring)[:-1] for ring in rings]
    if rings[0].geom_type == "LineString":
        return domain_or_body(Outline(points[0], name))
    corners = _of_rings(drawn.properties, "corners", len(rings))
    names = _of_rings(drawn.properties, "names", len(rings))
    return polygon_shape(
        [
            PolygonRing(ring, _corners(own, k), _names(label, k))
            for k, (ring, own, label) in enumerate(zip(points, corners, names, strict=True), start=1)
        ],
        name,
        periodic=_periodic(drawn.properties.get("periodic")),
    )


def _periodic(values: Any) -> list[tuple[str, str]]:
    """Return the pairs of names that the property ``periodic`` holds."""
    pairs = [] if values is None else values
    if not isinstance(pairs, list) or not all(
        isinstance(pair, list) and len(pair) == 2 and all(isinstance(name, str) for name in pair)
        for pair in pairs
    ):
        remedy = 'give e.g. [["left", "right"], ["bottom", "top"]]'
        raise InputError("property 'periodic' holds no pairs of names", remedy)
    return [(printable(a.strip()), printable(b.strip())) for a, b in pairs]


def _of_rings(properties: Mapping[str, Any], key: str, count: int) -> list[Any]:
    """Return the values of a property for each ring, None if it is missing."""
    values = properties.get(key)
    if values is None:
        return [None] * count
    if not isinstance(values, list) or len(values) != count:
        entries = f"{len(values)} entries" if isinstance(values, list) else "no list"
        problem = f"property {key!r} has {entries} and the polygon {count} ring{'' if count == 1 else 's'}"
        raise InputError(problem, "give one entry for each ring, or leave it out")
    return values


def _corners(values: Any, ring: int) -> list[int] | None:
    if values is None:
        return None
    if not isinstance(values, list) or not all(type(k) is int and abs(k) < LARGEST for k in values):
        problem = "property 'corners' holds no list of point numbers"
        raise InputError(problem, "give e.g. [[0, 4, 8, 12]], counted from 0", place=f"ring {ring}")
    return values


def _names(values: Any, ring: int) -> list[str]:
    names = [values] if isinstance(values, str) else [] if values is None else values
    if not isinstance(names, list) or not all(isinstance(name, str) and name.strip() for name in names):
        remedy = "give a name, or a list of them, one for each stretch between corners"
        raise InputError("property 'names' holds no names", remedy, place=f"ring {ring}")
    return [printable(name.strip()) for name in names]


def _points(ring: Any) -> Floats:
    """Return the points (n, 2) of a line."""
    points = np.array([point[:2] for point in ring.coords], dtype=np.float64)
    if not (np.abs(points) < LARGEST).all():
        raise InputError("a coordinate is not finite or far too large", "check its numbers")
    return points


def _is_closed(line: Any) -> bool:
    with np.errstate(all="ignore"):  # of NaN and infinity, which are refused later
        return bool(line.is_closed) or ends_meet(np.array(line.coords)[:, :2])


def _rings(geometry: BaseGeometry, place: str) -> Iterator[list[Any]]:
    """Yield the rings of each polygon, the outer one first, and each closed line of a geometry."""
    from shapely.geometry import LineString

    if hasattr(geometry, "geoms"):
        for member in geometry.geoms:
            yield from _rings(member, place)
        return
    kind = geometry.geom_type
    if geometry.is_empty or kind not in ("Polygon", "LineString", "LinearRing"):
        raise InputError(f"has an empty {kind} or a {kind}, which is no outline", _ASK, place=place)
    holes = list(geometry.interiors) if kind == "Polygon" else []
    ring = geometry.exterior if kind == "Polygon" else LineString(geometry.coords)
    if any(hole.is_empty for hole in holes):
        raise InputError("has a hole without points", "give its points, or leave it out", place=place)
    if not _is_closed(ring):
        raise InputError("line is not closed", "repeat its first point at its end", place=place)
    yield [ring, *holes]


def _features(data: Any) -> list[tuple[Mapping[str, Any], Any]]:
    """Return (properties, geometry) of every feature of a GeoJSON object."""
    if not isinstance(data, dict):
        raise ValueError("not an object")
    members = data.get("features")
    if data.get("type") == "FeatureCollection" and isinstance(members, list):
        return [feature for member in members for feature in _features(member)]
    if data.get("type") == "Feature":
        properties = data.get("properties")
        return [(properties if isinstance(properties, dict) else {}, data.get("geometry"))]
    return [({}, data)]


def _text(source: Source) -> str:
    try:
        return source.text_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError("is not UTF-8 text", "save it as UTF-8", place=f"byte {error.start}") from None
