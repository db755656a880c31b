"""Prescribed first-cell heights at walls, limited growth along lines, and sliding wall nodes."""
