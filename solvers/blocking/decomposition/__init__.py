"""Decomposition of a planar domain into four-sided blocks."""
