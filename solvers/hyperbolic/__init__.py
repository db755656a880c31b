"""Grids marched from the wall, for boundary layers."""
