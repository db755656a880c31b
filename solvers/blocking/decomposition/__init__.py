"""A planar domain cut into four-sided blocks."""
