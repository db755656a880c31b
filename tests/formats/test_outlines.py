import json

import numpy as np
import pytest
from format_shapes import memory

from meshonet.formats.outlines.vector import read_geojson, read_wkt
from meshonet.formats.table import TABLE
from meshonet.formats.text.points import read_shapes as read_points
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.sampling import Sampling

SQUARE = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0], [0.0, 0.0]]
HEXAGON = "POLYGON ((2 0, 1 1.7, -1 1.7, -2 0, -1 -1.7, 1 -1.7, 2 0))"


def wkt(points: list[list[float]]) -> str:
    return ", ".join(f"{x} {y}" for x, y in points)


def geojson(geometry: object, **more: object) -> bytes:
    return json.dumps({"type": "Feature", "geometry": geometry, "properties": more}).encode()


@pytest.mark.parametrize(
    "text",
    [
        f"POLYGON (({wkt(SQUARE)}))",
        f"linestring ({wkt(SQUARE)})",
        "POLYGON Z ((0 0 5, 2 0 5, 2 1 5, 0 1 5, 0 0 5))",
        f"# a comment\n\nPOLYGON (({wkt(SQUARE)}))\n",
    ],
)
def test_a_polygon_or_a_closed_line_is_an_outline(text: str) -> None:
    (outline,) = read_wkt(memory(text.encode(), "duct.wkt"))
    boundary = outline.boundary(Sampling(ni=9, nj=5))
    assert boundary.topology == "quad"
    assert outline.name == "duct"
    assert boundary.south[[0, -1]].tolist() == [[0, 0], [2, 0]]
    assert boundary.north[[0, -1]].tolist() == [[0, 1], [2, 1]]


@pytest.mark.parametrize(
    "text",
    [
        f"POLYGON (({wkt(SQUARE)}))\n{HEXAGON}\n",
        f"GEOMETRYCOLLECTION (POLYGON (({wkt(SQUARE)})), {HEXAGON})",
        f"MULTIPOLYGON ((({wkt(SQUARE)})), {HEXAGON.removeprefix('POLYGON ')})",
    ],
)
def test_several_outlines_are_numbered(text: str) -> None:
    outlines = list(read_wkt(memory(text.encode(), "both.wkt")))
    assert [outline.name for outline in outlines] == ["both-1", "both-2"]
    assert np.allclose(outlines[1].domain.loops[0].curve.points[0], [2, 0])


@pytest.mark.parametrize("way", [1, -1])
def test_a_polygon_with_a_hole_is_a_body_in_its_far_field(way: int) -> None:
    hole = [[0.5, 0.3], [1.0, 0.3], [1.0, 0.6], [0.5, 0.6], [0.5, 0.3]]
    text = f"POLYGON (({wkt(SQUARE[::way])}), ({wkt(hole)}))"
    (body,) = read_wkt(memory(text.encode(), "body.wkt"))
    result = body.boundary(Sampling(ni=33, nj=9))
    assert (result.topology, result.name) == ("o", "body")
    for corner, side in [(p, result.south) for p in hole] + [(p, result.north) for p in SQUARE]:
        assert np.hypot(*(side - corner).T).min() < 1e-12


def circle(x: float, y: float) -> list[list[float]]:
    """Return a circle whose last point differs from the first by the rounding of cos and sin."""
    turn = np.linspace(0.0, 2 * np.pi, 37)
    points = np.stack([x + 0.2 * np.cos(turn), y + 0.2 * np.sin(turn)], axis=1).tolist()
    return [*points[:-1], [x + 0.2, float(np.nextafter(y, 0.0))]]


@pytest.mark.parametrize("kind", ["geojson", "lines", "csv"])
def test_rings_are_closed_by_a_point_that_differs_by_rounding(kind: str) -> None:
    rings = [SQUARE, circle(0.5, 0.6), circle(1.4, 0.6)]
    blocks = ["\n".join(f"{x!r}, {y!r}" for x, y in ring) for ring in rings]
    data = {
        "geojson": geojson({"type": "Polygon", "coordinates": rings}),
        "lines": "\n".join(f"LINESTRING ({wkt(ring)})" for ring in rings[1:]).encode(),
        "csv": "\n\n".join(blocks).encode(),
    }[kind]
    shapes = list({"geojson": read_geojson, "lines": read_wkt, "csv": read_points}[kind](memory(data)))
    curves = shapes if kind == "lines" else shapes[0].domain.loops[1:]
    assert [len(each.curve.points) for each in curves] == [36, 36]


def test_geojson_features_are_called_by_their_name() -> None:
    polygon = {"type": "Polygon", "coordinates": [SQUARE]}
    (outline,) = read_geojson(memory(geojson(polygon, name="duct\x1b")))
    assert outline.name == "duct\\x1b"
    (plain,) = read_geojson(memory(json.dumps(polygon).encode(), "here.geojson"))
    assert plain.name == "here"
    both = {
        "type": "FeatureCollection",
        "features": [json.loads(geojson(polygon)), json.loads(geojson(polygon, name="b"))],
    }
    assert [o.name for o in read_geojson(memory(json.dumps(both).encode(), "all.json"))] == ["all", "b"]


def test_files_are_known_by_their_start() -> None:
    is_wkt, is_geojson = TABLE["wkt"].sniff, TABLE["geojson"].sniff
    assert is_wkt is not None
    assert is_geojson is not None
    assert is_wkt(b"\n  Polygon ((0 0")
    assert not is_wkt(b"POLYGONAL AIRFOIL\n1 0")
    assert is_geojson(b' {"type": "Feature"')
    assert not is_geojson(b"{}")


ASK = "give a POLYGON or a closed LINESTRING"
OUTER = [[0, 0], [4, 0], [4, 2], [0, 0]]
WKT = {
    "prose": ("hello", f"line 1: is not WKT .*; {ASK}"),
    "name without #": (
        "axis\nLINESTRING (0 0, 1 0)",
        f"line 1: is not WKT .*; {ASK}; a name is a line '# axis'$",
    ),
    "second line": (f"{HEXAGON}\nPOLYGON ((0 0, 1", "line 2: is not WKT"),
    "point": ("POINT (1 2)", f"has an empty Point or a Point, which is no outline; {ASK}"),
    "empty": ("POLYGON EMPTY", "has an empty Polygon"),
    "nothing": ("# only a comment", f"holds no geometry; {ASK}"),
    "open": ("LINESTRING (0 0, 1 0, 1 1)", "line is not closed; repeat its first point at its end"),
    "crossing": ("POLYGON ((0 0, 1 1, 1 0, 0 1, 0 0))", "crosses itself at"),
    "nan": ("POLYGON ((0 0, nan 1, 1 0, 0 0))", "is not finite or far too large; check its numbers"),
    "huge": ("POLYGON ((0 0, 1e300 0, 1e300 1e300, 0 1e300, 0 0))", "is not finite or far too large"),
    "empty hole": ("POLYGON ((0 0, 1 0, 1 1, 0 0), EMPTY)", "has a hole without points; give its points"),
    "crossing walls": ("LINESTRING (0 0, 2 1)\nLINESTRING (0 1, 2 0)", "crosses itself"),
}
GEOJSON = {
    "prose": (b"hello", "is not JSON .*; give a GeoJSON file"),
    "list": (b"[]", r"is not JSON \(not an object\)"),
    "deep": (b'{"type":' * 100_000, "is not JSON"),
    "null": (geojson(None), rf"is not a GeoJSON geometry \(it names no type\); {ASK}"),
    "empty": (b"{}", rf"is not a GeoJSON geometry \(it names no type\); {ASK}"),
    "type": (geojson({"type": "Sphere"}), "is not a GeoJSON geometry"),
    "words": (geojson({"type": "Polygon", "coordinates": [["a", "b"]]}), "is not a GeoJSON geometry"),
    "number": (geojson({"type": "Polygon", "coordinates": 7}), "is not a GeoJSON geometry"),
    "point": (geojson({"type": "Point", "coordinates": [1, 2]}), "which is no outline"),
    "none": (b'{"type": "FeatureCollection", "features": []}', "holds no geometry"),
    "empty hole": (geojson({"type": "Polygon", "coordinates": [OUTER, []]}), "has a hole without points"),
    "null hole": (geojson({"type": "Polygon", "coordinates": [OUTER, None]}), "has a hole without points"),
    "400 digits": (
        geojson({"type": "Polygon", "coordinates": [[[10**400, 0], *OUTER]]}),
        "is not a GeoJSON geometry",
    ),
    "a corner of 400 digits": (
        geojson({"type": "Polygon", "coordinates": [OUTER]}, corners=[[10**400]]),
        "property 'corners' holds no list of point numbers",
    ),
    "bytes": (b'{"type": "\xff\xfe"}', "byte 10: is not UTF-8 text; save it as UTF-8"),
}


@pytest.mark.parametrize("case", WKT)
def test_wkt_that_is_no_outline_is_refused(case: str) -> None:
    text, message = WKT[case]
    with pytest.raises(InputError, match=message):
        list(read_wkt(memory(text.encode())))


@pytest.mark.parametrize("case", GEOJSON)
def test_geojson_that_is_no_outline_is_refused(case: str) -> None:
    data, message = GEOJSON[case]
    with pytest.raises(InputError, match=message):
        list(read_geojson(memory(data)))


FLOOR, ROOF = "LINESTRING (0 0, 1 0.1, 3 0)", "LINESTRING (3 1, 0 1)"
SIDES = {
    "two walls": (f"{FLOOR}\n{ROOF}", ["wall", "outlet", "wall", "inlet"]),
    "two walls with names": (f"# floor\n{FLOOR}\n# roof\n{ROOF}", ["floor", "outlet", "roof", "inlet"]),
    "one geometry": ("MULTILINESTRING ((0 0, 1 0.1, 3 0), (0 1, 3 1))", ["wall", "outlet", "wall", "inlet"]),
    "four sides": (
        f"# floor\n{FLOOR}\n# roof\n{ROOF}\n# west\nLINESTRING (0 0, 0 1)\n# east\nLINESTRING (3 0, 3 1)",
        ["floor", "east", "roof", "west"],
    ),
}


@pytest.mark.parametrize("case", SIDES)
def test_open_lines_are_the_sides_of_a_channel(case: str) -> None:
    text, names = SIDES[case]
    (shape,) = read_wkt(memory(text.encode(), "duct.wkt"))
    edges = shape.boundary(Sampling(ni=13, nj=7))
    assert shape.name == "duct"
    assert [patch.name for patch in edges.patches] == names
    if case != "four sides":
        assert [patch.kind for patch in edges.patches] == ["wall", "outlet", "wall", "inlet"]


@pytest.mark.parametrize("name", ["axis", "symmetry"])
def test_the_axis_of_a_channel_is_no_wall(name: str) -> None:
    (shape,) = read_wkt(memory(f"# {name}\n{FLOOR}\n# roof\n{ROOF}".encode(), "nozzle.wkt"))
    walls = [patch.name for patch in shape.boundary(Sampling(ni=13, nj=7)).patches if patch.may_be_wall]
    assert walls == ["roof"]


def test_features_that_are_open_lines_are_sides_by_their_names() -> None:
    lines = {"floor": [[0, 0], [1, 0.1], [3, 0]], "roof": [[0, 1], [3, 1]]}
    members = [
        {"type": "Feature", "properties": {"name": n}, "geometry": {"type": "LineString", "coordinates": c}}
        for n, c in lines.items()
    ]
    data = json.dumps({"type": "FeatureCollection", "features": members}).encode()
    (shape,) = read_geojson(memory(data, "duct.geojson"))
    names = [patch.name for patch in shape.boundary(Sampling(ni=13, nj=7)).patches]
    assert names == ["floor", "outlet", "roof", "inlet"]
