"""Closed curves out of drawings and vector geometry."""

import re

from meshonet.formats.format import Format, later

_WKT = re.compile(rb"\s*(?:POLYGON|LINESTRING|LINEARRING|MULTI\w+|GEOMETRYCOLLECTION)\b", re.IGNORECASE)


def is_dxf(head: bytes) -> bool:
    """Say whether `head` is of a DXF drawing."""
    return head.split()[:2] == [b"0", b"SECTION"] or head.startswith(b"AutoCAD Binary DXF")


def is_wkt(head: bytes) -> bool:
    """Say whether `head` starts with the name of a WKT geometry."""
    return bool(_WKT.match(head))


def is_geojson(head: bytes) -> bool:
    """Say whether `head` starts as a JSON object that names a GeoJSON type."""
    return head.lstrip()[:1] == b"{" and b'"type"' in head


FORMATS = (
    Format(
        name="dxf",
        suffixes=(".dxf",),
        description="DXF drawing, layers as names (needs the extra dxf)",
        read_shapes=later(f"{__name__}.dxf:read_shapes"),
        sniff=is_dxf,
        many=True,
    ),
    Format(
        name="wkt",
        suffixes=(".wkt",),
        description="outlines as well-known text",
        read_shapes=later(f"{__name__}.vector:read_wkt"),
        sniff=is_wkt,
        many=True,
    ),
    Format(
        name="geojson",
        suffixes=(".geojson", ".json"),
        description="outlines as GeoJSON",
        read_shapes=later(f"{__name__}.vector:read_geojson"),
        sniff=is_geojson,
        many=True,
    ),
)
