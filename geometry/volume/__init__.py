"""Hexahedra that share nodes: grids of blocks in space as one mesh."""
