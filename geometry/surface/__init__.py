"""Surfaces in space made of patches: one table of nodes, which sides are shared, which way is out."""
