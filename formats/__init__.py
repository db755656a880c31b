"""Bytes to boundaries and grids and back, one module a format."""
