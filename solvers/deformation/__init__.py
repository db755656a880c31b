"""Deformation of a given grid to a changed boundary."""
