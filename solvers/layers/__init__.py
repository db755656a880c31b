"""Prescribed first-cell heights at walls, and sliding wall nodes."""
