"""Quadrilaterals that share nodes, and layouts: the blocks that they form."""
