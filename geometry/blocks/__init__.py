"""Blocks of nodes, their boundaries, named patches and connections."""
