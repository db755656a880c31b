"""Surfaces in space that consist of patches: a common table of nodes, shared sides, and outward direction."""
