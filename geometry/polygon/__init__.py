"""Closed polygons: where they turn, cross themselves, and whether they are their own mirror image."""
