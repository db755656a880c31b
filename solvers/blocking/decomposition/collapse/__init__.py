"""Blocks of a quad mesh, and reduction of their number."""
