"""Outlines as geometry: WKT, GeoJSON, DXF."""
