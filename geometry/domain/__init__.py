"""Planar domains: an outer loop, any number of holes, corners and names."""
