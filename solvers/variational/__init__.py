"""Grids that minimise a functional of angles and edge lengths."""
