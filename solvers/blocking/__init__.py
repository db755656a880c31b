"""Decomposition of planar domains into blocks."""
